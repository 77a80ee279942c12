#include "shadow/mask/mask_facet.h"

#include <math.h>
#include <string.h>

/* Past so many texels, a facet seen from the light is too long for its lists: the plain test decides. */
enum { FACET_TEXELS = 4096 };

/* Rounding of map coordinates, texels. */
static const float FACET_MARGIN = 1.0f / 64;

struct texel_box {
    int32_t x0, y0, x1, y1;         /* inclusive */
    float left, top, right, bottom; /* of the facet itself, and the margin */
    float farthest;                 /* depth of the facet along the map's axis */
};

static inline float dot3(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Samples where m . P + constant > 0 over the facet, if that is `here` at its centre. f (1 + kx X + ky Y) is linear in X and Y, and the
 * factor is positive wherever the facet is seen. */
static inline uint32_t half_plane(const struct mask_table *t, const struct mask_facet *f, const float m[3], float here)
{
    return mask_table_look(t, here, dot3(m, f->dx) + here * f->kx, dot3(m, f->dy) + here * f->ky);
}

/* False: part of the facet cannot be put on the map. */
static bool facet_box(const struct mask_map *map, const struct mask_facet *f, struct texel_box *box)
{
    float left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY, farthest = -INFINITY,
          side = (float)map->contour->size;
    for (int corner = 0; corner < 4; corner++) {
        float x = corner & 1 ? 0.5f : -0.5f, y = corner & 2 ? 0.5f : -0.5f, w = 1 + f->kx * x + f->ky * y;
        if (!(w > 0.1f))
            return false;
        float p[3];
        for (int k = 0; k < 3; k++)
            p[k] = f->point[k] + (x * f->dx[k] + y * f->dy[k]) / w;
        float scale = map->orthographic ? 1 : 1 / p[2];
        if (!(scale > 0))
            return false;
        float u = p[0] * scale * map->scale_x + map->offset_x, v = p[1] * scale * map->scale_y + map->offset_y;
        left = fminf(left, u);
        right = fmaxf(right, u);
        top = fminf(top, v);
        bottom = fmaxf(bottom, v);
        farthest = fmaxf(farthest, p[2]);
    }
    box->farthest = farthest;
    box->left = left - FACET_MARGIN;
    box->top = top - FACET_MARGIN;
    box->right = right + FACET_MARGIN;
    box->bottom = bottom + FACET_MARGIN;
    box->x0 = (int32_t)fmaxf(box->left, 0);
    box->y0 = (int32_t)fmaxf(box->top, 0);
    box->x1 = (int32_t)fminf(box->right, side - 1);
    box->y1 = (int32_t)fminf(box->bottom, side - 1);
    return box->x1 >= box->x0 && box->y1 >= box->y0 && (int64_t)(box->x1 - box->x0 + 1) * (box->y1 - box->y0 + 1) <= FACET_TEXELS;
}

/* Whether a contour texel lies in the box; `holes` tells if one with holes does. */
static bool on_contour(const struct mask_contour *m, const struct texel_box *box, bool *holes)
{
    bool crossed = false;
    *holes = false;
    for (uint32_t y = (uint32_t)box->y0; y <= (uint32_t)box->y1; y++)
        for (uint32_t word = (uint32_t)box->x0 / 64; word <= (uint32_t)box->x1 / 64; word++) {
            uint64_t in = UINT64_MAX;
            if (word == (uint32_t)box->x0 / 64)
                in &= UINT64_MAX << (box->x0 % 64);
            if (word == (uint32_t)box->x1 / 64)
                in &= UINT64_MAX >> (63 - box->x1 % 64);
            crossed |= (m->crossed[(size_t)y * m->words + word] & in) != 0;
            *holes |= (m->holes[(size_t)y * m->words + word] & in) != 0;
        }
    return crossed;
}

/* The plain test: whether what texel (x, y) holds is nearer than `depth`. */
static inline bool is_dark(const struct mask_map *map, int32_t x, int32_t y, float depth)
{
    float stored = map->depths[(size_t)y * map->contour->size + (size_t)x];
    return map->orthographic ? stored != 0 && depth > map->far - stored * (map->far - map->near) : stored * depth > map->near;
}

static uint32_t plain_shadow(const struct mask_map *map, const struct mask_facet *f)
{
    float scale = map->orthographic ? 1 : 1 / f->point[2], last = (float)(map->contour->size - 1);
    float x = f->point[0] * scale * map->scale_x + map->offset_x, y = f->point[1] * scale * map->scale_y + map->offset_y;
    return is_dark(map, (int32_t)fminf(fmaxf(x, 0), last), (int32_t)fminf(fmaxf(y, 0), last), f->point[2] - f->bias) ? UINT32_MAX
                                                                                                                     : 0;
}

typedef float lanes4 __attribute__((vector_size(16)));
typedef int32_t lanes4_int __attribute__((vector_size(16)));

static inline lanes4 load4(const float v[4])
{
    lanes4 out;
    memcpy(&out, v, sizeof out);
    return out;
}

static inline lanes4 next_corner(lanes4 v) { return __builtin_shufflevector(v, v, 1, 2, 0, 2); }

static inline lanes4 absolute4(lanes4 v) { return (lanes4)((lanes4_int)v & 0x7fffffff); }

/* The four half-planes side by side: lanes 0 to 2 the edges, lane 3 what lies behind the face's plane, as seen from the light, by more than
 * the bias. */
static uint32_t face_shadow(const struct mask_table *t, const struct mask_map *map, const struct mask_facet *f,
                            const struct mask_face *face)
{
    lanes4 ux = load4(face->x), uy = load4(face->y), uz = load4(face->z);
    lanes4 ex = next_corner(ux) - ux, ey = next_corner(uy) - uy, ez = next_corner(uz) - uz;
    lanes4 mx, my, mz;
    if (map->orthographic) {
        mx = ey;
        my = -ex;
        mz = ex - ex;
    } else {
        mx = ey * uz - ez * uy;
        my = ez * ux - ex * uz;
        mz = ex * uy - ey * ux;
    }
    /* Edge 0 is ab, lane 3 is ac: the normal away from the light. */
    float nx = ey[3] * ez[0] - ez[3] * ey[0], ny = ez[3] * ex[0] - ex[3] * ez[0], nz = ex[3] * ey[0] - ey[3] * ex[0];
    mx[3] = nx;
    my[3] = ny;
    mz[3] = nz;
    lanes4 here = mx * (f->point[0] - ux) + my * (f->point[1] - uy) + mz * (f->point[2] - uz);
    here[3] += f->face_bias * (nx * f->to_light[0] + ny * f->to_light[1] + nz * f->to_light[2]);
    lanes4 x = mx * f->dx[0] + my * f->dx[1] + mz * f->dx[2] + here * f->kx;
    lanes4 y = mx * f->dy[0] + my * f->dy[1] + mz * f->dy[2] + here * f->ky;
    lanes4_int outside = here <= -0.5f * (absolute4(x) + absolute4(y));
    if (outside[0] | outside[1] | outside[2] | outside[3])
        return 0;
    uint32_t mask = UINT32_MAX;
    for (int k = 0; k < 4 && mask; k++)
        mask &= mask_table_look(t, here[k], x[k], y[k]);
    return mask;
}

/* A texel off the contour is dark as a whole or not at all: the part of the facet that falls on it. */
static uint32_t texel_shadow(const struct mask_table *t, const struct mask_map *map, const struct mask_facet *f, int32_t x,
                             int32_t y)
{
    const float *n = f->normal;
    float ex = ((float)x + 0.5f - map->offset_x) / map->scale_x, ey = ((float)y + 0.5f - map->offset_y) / map->scale_y;
    float d = dot3(n, f->point);
    float depth = map->orthographic ? (d - n[0] * ex - n[1] * ey) / n[2] : d / (n[0] * ex + n[1] * ey + n[2]);
    if (!(fabsf(depth) < INFINITY) || (!map->orthographic && depth < 0))
        depth = f->point[2];
    if (!is_dark(map, x, y, depth - f->bias))
        return 0;
    uint32_t mask = UINT32_MAX;
    for (int k = 0; k < 4; k++) {
        /* Inside: sign (scale p + (offset - border) z) >= 0, z = 1 in an orthographic map. */
        int axis = k >> 1;
        float border = (float)(axis ? y : x) + (float)(k & 1), sign = k & 1 ? -1.0f : 1.0f, m[3] = {0, 0, 0};
        float shift = (axis ? map->offset_y : map->offset_x) - border;
        m[axis] = sign * (axis ? map->scale_y : map->scale_x);
        m[2] = map->orthographic ? 0 : sign * shift;
        mask &= half_plane(t, f, m, dot3(m, f->point) + (map->orthographic ? sign * shift : 0));
    }
    return mask;
}

/* Faces just looked at: neighbouring texels list many of the same. */
struct seen {
    uint32_t face[64];
};

/* The facet's box within texel `at`, as struct mask_entry has a face's. */
static void box_in_texel(float low, float high, int32_t at, int *from, int *to)
{
    *from = (int)fminf(fmaxf((low - (float)at) * 255, 0), 255);
    *to = (int)fminf(fmaxf(ceilf((high - (float)at) * 255), 0), 255);
}

static uint32_t list_shadow(const struct mask_table *t, const struct mask_map *map, const struct mask_facet *f,
                            const struct texel_box *box, int32_t x, int32_t y, uint32_t mask, struct seen *seen,
                            struct mask_counts *counts)
{
    const struct mask_contour *m = map->contour;
    uint32_t list = mask_contour_index(m, (uint32_t)x, (uint32_t)y);
    int left, right, top, bottom;
    box_in_texel(box->left, box->right, x, &left, &right);
    box_in_texel(box->top, box->bottom, y, &top, &bottom);
    const struct mask_entry *end = m->entries + m->first[list + 1];
    for (const struct mask_entry *e = m->entries + m->first[list]; e < end && mask != UINT32_MAX; e++) {
        if (e->right < left || e->left > right || e->bottom < top || e->top > bottom || e->nearest > box->farthest ||
            seen->face[e->face % 64] == e->face)
            continue;
        seen->face[e->face % 64] = e->face;
        const struct mask_face *face = &m->faces[e->face];
        counts->faces++;
        if (face->id != f->id)
            mask |= face_shadow(t, map, f, face);
    }
    return mask;
}

uint32_t mask_facet_shadow(const struct mask_table *table, const struct mask_map *map, const struct mask_facet *facet,
                           struct mask_counts *counts)
{
    struct texel_box box;
    struct seen seen;
    bool holes;
    counts->receivers++;
    if (!facet_box(map, facet, &box) || !on_contour(map->contour, &box, &holes))
        return plain_shadow(map, facet);
    counts->contour++;
    if (holes)
        return plain_shadow(map, facet);
    for (int i = 0; i < 64; i++)
        seen.face[i] = UINT32_MAX;
    uint32_t mask = 0;
    for (int32_t y = box.y0; y <= box.y1 && mask != UINT32_MAX; y++)
        for (int32_t x = box.x0; x <= box.x1 && mask != UINT32_MAX; x++) {
            if (mask_contour_at(map->contour, (uint32_t)x, (uint32_t)y))
                mask = list_shadow(table, map, facet, &box, x, y, mask, &seen, counts);
            else
                mask |= texel_shadow(table, map, facet, x, y);
        }
    return mask;
}
