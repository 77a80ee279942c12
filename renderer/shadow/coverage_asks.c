#include "shadow/coverage_asks.h"

#include "shadow/light_lanes.h"

#define INLINE static inline __attribute__((always_inline))

enum { FOUR = 4 };
typedef double four_doubles __attribute__((vector_size(32), may_alias));
typedef int32_t four_ints __attribute__((vector_size(16), may_alias));

/* Four triangles as seen from a point. */
struct four {
    uint32_t id[FOUR];
    const struct light_part *part[FOUR];
    struct light_triangle triangle[FOUR];
    int count; /* lanes beyond repeat the first */
    /* Edge k: from corner k on, as the area turns. */
    double edge[3][FOUR] __attribute__((aligned(32))), area[FOUR] __attribute__((aligned(32)));
    /* Nonzero: true. */
    int32_t may[FOUR] __attribute__((aligned(16))), inside[FOUR] __attribute__((aligned(16))),
        before[FOUR] __attribute__((aligned(16)));
};

/* Corners of four, transposed. */
INLINE void load_corners(const struct four *f, int k, lanes_quarter *x, lanes_quarter *y, lanes_quarter *n)
{
    lanes_quarter v[FOUR];
#pragma GCC unroll 4
    for (int i = 0; i < FOUR; i++)
        v[i] = *(const lanes_quarter *)(const void *)f->triangle[i].corner[k];
    lanes_quarter a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5), b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5);
    lanes_quarter c = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7), d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
    *x = __builtin_shufflevector(a, b, 0, 1, 4, 5);
    *y = __builtin_shufflevector(a, b, 2, 3, 6, 7);
    *n = __builtin_shufflevector(c, d, 0, 1, 4, 5);
}

/* geometry_before(). */
#define BEFORE(m, occluder, n_) \
    ((occluder) > (n_) + 0x1p-20f * (lanes_quarter)((four_ints)(occluder) & ((four_ints){} + INT32_MAX)) + (m)->mesh.rounding)

#define WIDE(v) __builtin_convertvector(v, four_doubles)

/* The arithmetic of light_triangle_hit(), light_triangle_sides() and geometry_may_shadow(). False: one of them is wild. */
INLINE bool look_at_four(const struct geometry_map *m, const struct map_point *p, struct four *f)
{
    lanes_quarter x[3], y[3], n[3];
    for (int k = 0; k < 3; k++)
        load_corners(f, k, &x[k], &y[k], &n[k]);
    lanes_quarter sum_x = x[0] + x[1] + x[2];
    four_ints tame = sum_x == sum_x;
    if (!(tame[0] & tame[1] & tame[2] & tame[3]))
        return false;
    four_ints may = BEFORE(m, n[0], p->n) | BEFORE(m, n[1], p->n) | BEFORE(m, n[2], p->n);
    four_doubles dx[3], dy[3], e[3];
    for (int k = 0; k < 3; k++) {
        dx[k] = WIDE(x[k]) - (double)p->x;
        dy[k] = WIDE(y[k]) - (double)p->y;
    }
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        e[k] = dx[k] * dy[j] - dy[k] * dx[j];
    }
    four_doubles sum = e[1] + e[2] + e[0];
    four_doubles area = (dx[1] - dx[0]) * (dy[2] - dy[0]) - (dx[2] - dx[0]) * (dy[1] - dy[0]);
    __typeof__(sum > 0) inside = ((e[0] >= 0) & (e[1] >= 0) & (e[2] >= 0)) | ((e[0] <= 0) & (e[1] <= 0) & (e[2] <= 0));
    inside &= sum != 0;
    four_doubles near = e[1] / sum * WIDE(n[0]) + e[2] / sum * WIDE(n[1]) + e[0] / sum * WIDE(n[2]);
    lanes_quarter nearness = __builtin_convertvector(near, lanes_quarter);
    *(four_ints *)f->before = BEFORE(m, nearness, p->n);
    *(four_ints *)f->inside = __builtin_convertvector(inside, four_ints);
    *(four_ints *)f->may = may;
    for (int k = 0; k < 3; k++)
        *(four_doubles *)f->edge[k] = e[k];
    *(four_doubles *)f->area = area;
    return true;
}

/* Triangle i of the four, which may shadow the point, by `verdict`; true: dark. */
static bool add_verdict(const struct four *f, int i, enum geometry_verdict verdict, const struct light_sides *sides,
                        struct coverage_answer *out)
{
    if (verdict == GEOMETRY_BEFORE)
        return true;
    if (verdict == GEOMETRY_ELSEWHERE)
        out->beside[out->besides++] = (struct coverage_way){f->part[i], f->id[i], *sides};
    else
        out->held = true;
    return false;
}

static struct light_sides sides_of(const struct four *f, int i)
{
    struct light_sides s = {.area = f->area[i]};
    for (int k = 0; k < 3; k++)
        s.edge[k] = f->area[i] < 0 ? -f->edge[k][i] : f->edge[k][i];
    return s;
}

/* One by one: some are wild. */
static bool ask_wild(const struct geometry_map *m, const struct four *f, const struct map_point *p, uint32_t *hint,
                     struct coverage_answer *out)
{
    for (int i = 0; i < f->count; i++) {
        if (f->id[i] == p->id) {
            out->held = true;
            continue;
        }
        if (!geometry_may_shadow(m, f->id[i], p, hint))
            continue;
        struct light_sides sides = light_triangle_sides(&m->mesh, f->part[i], f->id[i], p->x, p->y);
        if (add_verdict(f, i, geometry_ask(m, f->id[i], p, hint), &sides, out))
            return true;
    }
    return false;
}

INLINE bool ask_four(const struct geometry_map *m, struct four *f, const struct map_point *p, uint32_t *hint,
                     struct coverage_answer *out)
{
    if (!look_at_four(m, p, f))
        return ask_wild(m, f, p, hint, out);
    for (int i = 0; i < f->count; i++) {
        if (f->id[i] == p->id) {
            out->held = true;
            continue;
        }
        if (!f->may[i])
            continue;
        enum geometry_verdict verdict = !f->inside[i] ? GEOMETRY_ELSEWHERE : f->before[i] ? GEOMETRY_BEFORE : GEOMETRY_BEHIND;
        if (f->inside[i] && f->part[i]->holes)
            verdict = geometry_ask(m, f->id[i], p, hint);
        struct light_sides sides = sides_of(f, i);
        if (add_verdict(f, i, verdict, &sides, out))
            return true;
    }
    return false;
}

INLINE void ask_all(const struct geometry_map *m, const uint32_t *ids, unsigned count, const struct map_point *p, uint32_t *hint,
                    struct coverage_answer *out)
{
    out->dark = out->held = false;
    out->besides = 0;
    for (unsigned first = 0; first < count && !out->dark; first += FOUR) {
        struct four f;
        f.count = count - first < FOUR ? (int)(count - first) : FOUR;
        for (int i = 0; i < FOUR; i++) {
            f.id[i] = ids[first + (unsigned)(i < f.count ? i : 0)];
            f.part[i] = light_mesh_part(&m->mesh, f.id[i], hint);
            f.triangle[i] = light_part_triangle(f.part[i], f.id[i]);
        }
        out->dark = ask_four(m, &f, p, hint, out);
    }
}

#ifdef __x86_64__
/* The same arithmetic in wider vectors (no contraction), so the same bits. */
__attribute__((target("avx2"))) static void ask_all_avx2(const struct geometry_map *m, const uint32_t *ids, unsigned count,
                                                         const struct map_point *p, uint32_t *hint, struct coverage_answer *out)
{
    ask_all(m, ids, count, p, hint, out);
}
#endif

void coverage_ask(const struct geometry_map *m, const uint32_t *ids, unsigned count, const struct map_point *p, uint32_t *hint,
                  struct coverage_answer *out)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        ask_all_avx2(m, ids, count, p, hint, out);
        return;
    }
#endif
    ask_all(m, ids, count, p, hint, out);
}
