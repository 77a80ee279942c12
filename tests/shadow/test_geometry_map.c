/* Conservative geometry maps (shadow/geometry/geometry_map.h) and the lists made from them (shadow/geometry/coverage_lists.h), against brute force. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "made_scene.h"
#include "shadow/geometry/coverage_asks.h"
#include "shadow/geometry/coverage_lists.h"
#include "shadow/geometry/coverage_packed.h"
#include "shadow/geometry/coverage_recovery.h"
#include "shadow/fit.h"
#include "shadow/geometry/geometry_kernel.h"
#include "shadow/geometry/geometry_maps.h"

#define SIZE 96

struct setting {
    struct scene *scene;
    struct fit_geometry geometry;
    struct shadow_fit fit;
    uint32_t *casters;
    struct job_pool *pool;
};

static struct setting setting_open(struct scene *scene, const struct light *light, unsigned threads, bool cube)
{
    struct error err = {0};
    struct setting s = {.scene = scene, .casters = calloc(scene->instance_count + 1, sizeof *s.casters)};
    s.pool = job_pool_create(threads, &err);
    assert_non_null(s.pool);
    assert_true(fit_geometry_init(&s.geometry, scene, &err));
    shadow_fit_compute(&s.geometry, light, SIZE, cube, s.casters, &s.fit);
    assert_true(s.fit.map_count > 0);
    return s;
}

static void setting_close(struct setting *s)
{
    fit_geometry_finish(&s->geometry);
    free(s->casters);
    job_pool_destroy(s->pool);
}

static void build(struct geometry_map *m, const struct setting *s, unsigned map)
{
    struct error err = {0};
    if (!geometry_map_build(m, s->scene, &s->fit.maps[map], s->fit.casters, s->fit.caster_count, s->pool, &err))
        fail_msg("%s", err.message);
}

static struct scene *load(const char *name)
{
    struct error err = {0};
    struct scene *scene = scene_load(name, &err);
    if (!scene)
        fail_msg("%s: %s", name, err.message);
    return scene;
}

static struct light light_at(enum light_kind kind, double x, double y, double z)
{
    struct light light = made_light(kind, dvec3(x, y, z), dvec3(0, 0.4, 0));
    light.inner = 0.5;
    light.outer = 0.6;
    return light;
}

struct found {
    size_t covered, texels,
        hidden; /* hidden: points nearer than the texel's bound though nothing is: the bound is not tight, which may be */
};

/* Every triangle at a point: the texel's bound is no farther than any; over its centre, the front-most is the one that is kept. */
static void check_point(const struct geometry_map *m, float x, float y, bool center, struct found *found)
{
    size_t at = geometry_map_at(m, (uint32_t)x, (uint32_t)y);
    float nearest = -INFINITY;
    uint32_t front = MAP_NONE;
    for (size_t p = 0; p < m->mesh.part_count; p++)
        for (uint32_t i = 0; i < m->mesh.parts[p].triangle_count; i++) {
            uint32_t id = m->mesh.parts[p].first_triangle + i;
            struct light_hit hit;
            if (light_part_degenerate(m->mesh.scene, &m->mesh.parts[p], id) ||
                !light_triangle_hit(&m->mesh, &m->mesh.parts[p], id, x, y, &hit))
                continue;
            front = hit.n > nearest ? id : front;
            nearest = fmaxf(nearest, hit.n);
        }
    found->texels++;
    if (front == MAP_NONE)
        return;
    found->covered++;
    assert_true(at != SIZE_MAX);
    assert_true(m->cells[at].nearest >= nearest);
    if (!center || m->cells[at].triangle == front)
        return;
    /* As near, to rounding. */
    struct light_hit kept;
    uint32_t hint = 0, id = m->cells[at].triangle & MAP_ID;
    assert_true(light_triangle_hit(&m->mesh, light_mesh_part(&m->mesh, id, &hint), id, x, y, &kept) ||
                m->cells[at].triangle & MAP_OFF_EDGE);
}

static void check_map(const struct geometry_map *m, struct found *found)
{
    srand(7);
    for (int i = 0; i < 1500; i++) {
        float x = (float)(rand() % SIZE), y = (float)(rand() % SIZE);
        bool center = i % 2;
        check_point(m, x + (center ? 0.5f : (float)rand() / 2.2e9f), y + (center ? 0.5f : (float)rand() / 2.2e9f), center, found);
    }
}

static void test_nothing_is_nearer_than_a_texel_says(void **state)
{
    (void)state;
    static const char *const scenes[] = {"builtin:dragon:triangles=2000", "builtin:hard-11-degenerate",
                                         "builtin:hard-04-contact"};
    static const enum light_kind kinds[] = {LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT};
    for (size_t k = 0; k < 3; k++)
        for (size_t l = 0; l < 3; l++) {
            struct scene *scene = load(scenes[k]);
            struct light light = light_at(kinds[l], 2, 4, 1.5);
            struct setting s = setting_open(scene, &light, 2, l == 1);
            struct found found = {0};
            for (unsigned i = 0; i < s.fit.map_count; i++) {
                struct geometry_map m = {0};
                build(&m, &s, i);
                check_map(&m, &found);
                geometry_map_finish(&m);
            }
            assert_true(found.covered > 20 && found.covered < found.texels);
            setting_close(&s);
            scene_destroy(scene);
        }
}

/* A light amid a mesh: triangles behind it, around it, across its plane go the slow way. */
static void test_corners_behind_the_light(void **state)
{
    (void)state;
    struct scene *scene = made_scene();
    const float points[9][3] = {{-3, 1, -2}, {3, 1, -2}, {0, 1, 4},    {-2, -1, -3}, {-2, 3, 0.5f},
                                {-2, -1, 3}, {1, 0, 1},  {1.2f, 0, 1}, {1, 0.3f, 1}};
    made_triangles(scene, points, 9, made_material(scene, true));
    made_finish(scene);
    struct light light = light_at(LIGHT_POINT, 0.1, 0.2, 0.3);
    light.position = dvec3_sub(light.position, scene->origin);
    struct setting s = setting_open(scene, &light, 2, true);
    struct found found = {0};
    size_t wild = 0;
    for (unsigned i = 0; i < s.fit.map_count; i++) {
        struct geometry_map m = {0};
        build(&m, &s, i);
        wild += m.wild_count;
        check_map(&m, &found);
        geometry_map_finish(&m);
    }
    assert_true(wild > 3 && found.covered > 100);
    setting_close(&s);
    scene_destroy(scene);
}

static bool same_map(const struct geometry_map *a, const struct geometry_map *b)
{
    size_t texels = a->slot_count * MAP_TILE * MAP_TILE;
    return a->slot_count == b->slot_count && memcmp(a->slot, b->slot, (size_t)a->tiles * a->tiles * sizeof *a->slot) == 0 &&
           memcmp(a->cells, b->cells, texels * sizeof *a->cells) == 0;
}

static void test_the_same_whatever_the_threads(void **state)
{
    (void)state;
    struct scene *scene = load("builtin:dragon:triangles=20000");
    struct light light = light_at(LIGHT_POINT, 2, 4, 1.5), other = light_at(LIGHT_POINT, -2, 3, 1.5);
    struct setting one = setting_open(scene, &light, 1, false), many = setting_open(scene, &light, 4, false);
    struct setting elsewhere = setting_open(scene, &other, 1, false);
    struct geometry_map a = {0}, b = {0};
    build(&a, &one, 0);
    build(&b, &elsewhere, 0);
    assert_false(same_map(&a, &b));
    build(&b, &many, 0);
    assert_true(same_map(&a, &b));
    geometry_map_finish(&a);
    geometry_map_finish(&b);
    setting_close(&elsewhere);
    setting_close(&many);
    setting_close(&one);
    scene_destroy(scene);
}

static bool keeps(const struct geometry_map *m, uint32_t x, uint32_t y)
{
    size_t at = geometry_map_at(m, x, y);
    return at != SIZE_MAX && m->cells[at].triangle != MAP_NONE;
}

/* Texels [x, end) of row y, of one tile. */
static void make_row(const struct geometry_map *m, uint32_t x, uint32_t end, uint32_t y, unsigned nodes)
{
    struct coverage_window w;
    uint32_t wanted[MAP_TILE] = {0};
    for (; x < end; x++)
        wanted[y % MAP_TILE] |= keeps(m, x, y) ? 1u << x % MAP_TILE : 0;
    if (!wanted[y % MAP_TILE])
        return;
    coverage_window_open(&w, m, end - 1, y);
    coverage_lists_make(&w, wanted, nodes, COVERAGE_POOL);
}

/* Lists of all texels in turn. */
static size_t list_all(const struct geometry_map *m, unsigned nodes, uint32_t *out)
{
    size_t links = 0;
    for (uint32_t t = 0; t < SIZE * SIZE; t++) {
        if (t % MAP_TILE == 0)
            make_row(m, t % SIZE, t % SIZE + MAP_TILE, t / SIZE, nodes);
        bool any = keeps(m, t % SIZE, t / SIZE);
        out[t] = any ? coverage_list(m, geometry_map_at(m, t % SIZE, t / SIZE)) & COVERAGE_LINKS : 0;
        assert_true(!any || out[t] & 1);
        assert_true((unsigned)__builtin_popcount(out[t]) <= nodes);
        links += (size_t)__builtin_popcount(out[t]);
    }
    return links;
}

/* Those that pixels ask for first, here and there, are the full pass's. */
static void test_lists_are_the_same_in_any_order(void **state)
{
    (void)state;
    struct scene *scene = load("builtin:dragon:triangles=20000");
    struct light light = light_at(LIGHT_POINT, 2, 4, 1.5);
    struct setting s = setting_open(scene, &light, 2, false);
    struct geometry_map full = {0}, some = {0};
    uint32_t asked = 0;
    uint32_t *a = calloc(SIZE * SIZE, sizeof *a), *b = calloc(SIZE * SIZE, sizeof *b);
    assert_true(a && b);
    build(&full, &s, 0);
    build(&some, &s, 0);
    assert_true(list_all(&full, 4, a) > 4000);
    for (int i = 0; i < 3000; i++) {
        uint32_t x = (uint32_t)rand() % SIZE, y = (uint32_t)rand() % SIZE;
        if (!keeps(&some, x, y))
            continue;
        asked++;
        make_row(&some, x, x + 1, y, 4);
        assert_int_equal(coverage_list(&some, geometry_map_at(&some, x, y)) & COVERAGE_LINKS, a[y * SIZE + x]);
    }
    assert_true(asked > 500);
    list_all(&some, 4, b);
    assert_memory_equal(a, b, SIZE * SIZE * sizeof *a);
    build(&some, &s, 0); /* forgets them */
    assert_true(list_all(&some, 16, b) > list_all(&full, 4, a));
    free(b);
    free(a);
    geometry_map_finish(&some);
    geometry_map_finish(&full);
    setting_close(&s);
    scene_destroy(scene);
}

/* What is known after a way to the point from triangle `id`. */
static unsigned recover(const struct geometry_map *m, const struct adjacency *adjacency, uint32_t id, const struct map_point *p)
{
    uint32_t hint = 0;
    struct map_looks l;
    struct coverage_asks a;
    coverage_asks_open(&a, m, adjacency, p, 1);
    map_looks_put(&l, 0, p, id);
    map_look(m, &l, 1, &hint);
    a.ways[a.way_count++] = (struct coverage_way){0, id, SCENE_NONE, l.beyond[0], l.area[0]};
    coverage_recover(&a);
    return a.known[0];
}

/* From any triangle of a sheet, recovery walks to the one over the point. */
static void test_recovery_finds_what_no_texel_kept(void **state)
{
    (void)state;
    struct error err = {0};
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    float points[6 * 64][3];
    for (int i = 0; i < 64; i++) {
        float x = (float)(i % 8), z = (float)(i / 8);
        const float quad[6][3] = {{x, 1, z}, {x, 1, z + 1}, {x + 1, 1, z + 1}, {x, 1, z}, {x + 1, 1, z + 1}, {x + 1, 1, z}};
        memcpy(points[6 * i], quad, sizeof quad);
    }
    made_triangles(scene, (const float(*)[3])points, 6 * 64, material);
    const float far[3][3] = {{20, 1, 0}, {20, 1, 1}, {21, 1, 0}}, floor[3][3] = {{-30, 0, -30}, {-30, 0, 60}, {60, 0, -30}};
    made_triangles(scene, far, 3, material);
    made_triangles(scene, floor, 3, material);
    made_finish(scene);
    struct light light = made_light(LIGHT_DIRECTIONAL, dvec3(0, 0, 0), dvec3(0, -1, 0));
    struct setting s = setting_open(scene, &light, 1, false);
    struct geometry_map m = {0};
    struct adjacency adjacency;
    build(&m, &s, 0);
    assert_true(adjacency_init(&adjacency, scene, &err));
    struct light_triangle t = light_part_triangle(&m.mesh.parts[0], 20);
    struct map_point p = {.n = 0, .id = 129};
    for (int k = 0; k < 3; k++) {
        p.x += t.corner[k]->x / 3;
        p.y += t.corner[k]->y / 3;
    }
    assert_int_equal(recover(&m, &adjacency, 28, &p), POINT_DARK);
    assert_int_equal(recover(&m, &adjacency, 4, &p), POINT_DARK);
    assert_int_equal(recover(&m, &adjacency, 128, &p), 0);
    p.id = 20;
    assert_int_equal(recover(&m, &adjacency, 4, &p), POINT_HELD);
    adjacency_finish(&adjacency);
    geometry_map_finish(&m);
    setting_close(&s);
    scene_destroy(scene);
}

static enum geometry_verdict ask_one(const struct geometry_map *m, uint32_t id, const struct map_point *p, uint32_t *hint)
{
    id &= MAP_ID;
    if (id == p->id)
        return GEOMETRY_OWN;
    struct light_hit hit;
    if (!light_triangle_solid_hit(&m->mesh, light_mesh_part(&m->mesh, id, hint), id, p->x, p->y, &hit))
        return GEOMETRY_ELSEWHERE;
    return geometry_before(m, hit.n, p->n) ? GEOMETRY_BEFORE : GEOMETRY_BEHIND;
}

/* What the triangles say one by one: known, and how many ways begin. */
static unsigned ask_singly(const struct geometry_map *m, const uint32_t *ids, unsigned count, const struct map_point *p,
                           size_t *ways)
{
    unsigned known = 0;
    uint32_t hint = 0;
    *ways = 0;
    for (unsigned i = 0; i < count; i++) {
        enum geometry_verdict verdict = ask_one(m, ids[i], p, &hint);
        struct light_triangle t = light_part_triangle(light_mesh_part(&m->mesh, ids[i], &hint), ids[i]);
        struct light_sides s = light_triangle_sides(&m->mesh, light_mesh_part(&m->mesh, ids[i], &hint), ids[i], p->x, p->y);
        bool may = light_triangle_wild(&t);
        for (int k = 0; k < 3; k++)
            may |= geometry_before(m, t.corner[k]->n, p->n);
        known |= verdict == GEOMETRY_BEHIND || verdict == GEOMETRY_BEFORE ? POINT_COVERED : 0;
        if (verdict == GEOMETRY_OWN || (may && verdict == GEOMETRY_BEHIND))
            known |= POINT_HELD;
        else if (verdict == GEOMETRY_BEFORE)
            known |= POINT_DARK;
        else if (may && verdict == GEOMETRY_ELSEWHERE && (s.edge[0] < 0 || s.edge[1] < 0 || s.edge[2] < 0))
            ++*ways;
    }
    return known;
}

/* Triangles eight at a time say what each of them says: some behind the light, some with holes beside them, lists of any length. */
static void test_asked_together_as_one_by_one(void **state)
{
    (void)state;
    static const char *const scenes[] = {"builtin:dragon:triangles=2000", "builtin:tree", "builtin:hard-11-degenerate"};
    size_t dark = 0, beside = 0, held = 0, ways;
    srand(11);
    for (size_t k = 0; k < 3; k++) {
        struct scene *scene = load(scenes[k]);
        struct light light = light_at(LIGHT_POINT, 0.3, 0.7, 0.2);
        struct setting s = setting_open(scene, &light, 1, true);
        struct geometry_map m = {0};
        build(&m, &s, 0);
        for (int i = 0; i < 20000; i++) {
            uint32_t ids[COVERAGE_NODES_MAX];
            unsigned count = 1 + (unsigned)rand() % COVERAGE_NODES_MAX;
            const struct light_part *part = &m.mesh.parts[(size_t)rand() % m.mesh.part_count];
            for (unsigned n = 0; n < count; n++)
                ids[n] = part->first_triangle + (uint32_t)rand() % part->triangle_count;
            const struct light_vertex *at = light_part_triangle(part, ids[0]).corner[rand() % 3];
            struct map_point p = {.x = at->x + (float)(rand() % 64) / 64,
                                  .y = at->y,
                                  .n = at->n * (0.5f + (float)(rand() % 64) / 64),
                                  .id = rand() % 2 ? ids[count - 1] : MAP_NONE};
            struct coverage_asks a;
            coverage_asks_open(&a, &m, NULL, &p, 1);
            for (unsigned n = 0; n < count; n++)
                coverage_asks_put(&a, 0, ids[n]);
            coverage_asks_finish_pairs(&a);
            assert_int_equal(a.known[0], ask_singly(&m, ids, count, &p, &ways));
            assert_int_equal(a.way_count, ways);
            dark += a.known[0] & POINT_DARK;
            held += a.known[0] & POINT_HELD ? 1 : 0;
            beside += ways;
        }
        geometry_map_finish(&m);
        setting_close(&s);
        scene_destroy(scene);
    }
    assert_true(dark > 100 && beside > 100 && held > 100);
}

/* Looks and lists of the machine's best instructions against the plain ones. */
static void test_every_kernel_gives_the_same_bits(void **state)
{
    (void)state;
    if (geometry_kernel_choose() == &geometry_plain)
        skip();
    struct scene *scene = load("builtin:dragon:triangles=20000");
    struct light light = light_at(LIGHT_POINT, 2, 4, 1.5);
    struct setting s = setting_open(scene, &light, 1, false);
    struct geometry_map m = {0};
    build(&m, &s, 0);
    uint32_t hint = 0, lists = 0;
    for (uint32_t t = 0; t < SIZE * SIZE; t++) {
        uint32_t x = t % SIZE, y = t / SIZE, texel = y % MAP_TILE * MAP_TILE + x % MAP_TILE;
        if (!keeps(&m, x, y))
            continue;
        struct coverage_window w;
        coverage_window_open(&w, &m, x, y);
        struct coverage_texels plain = {.window = &w, .nodes = 4, .pool = COVERAGE_POOL, .count = 1, .texel = {(uint16_t)texel}};
        struct coverage_texels best = plain;
        geometry_plain.make_lists(&plain);
        geometry_kernel_choose()->make_lists(&best);
        assert_int_equal(plain.lists[0], best.lists[0]);
        lists += plain.lists[0] != (COVERAGE_MADE | 1);
        struct map_looks a, b;
        memset(&a, 0, sizeof a);
        for (unsigned k = 0; k < LOOKS; k++) {
            struct map_point p = {
                .x = (float)x + (float)k / LOOKS, .y = (float)y + 0.3f, .n = m.cells[geometry_map_at(&m, x, y)].nearest};
            map_looks_put(&a, k, &p, m.cells[geometry_map_at(&m, x, y)].triangle & MAP_ID);
        }
        b = a;
        geometry_plain.look(&m, &a, &hint);
        geometry_kernel_choose()->look(&m, &b, &hint);
        assert_memory_equal(&a, &b, sizeof a);
    }
    assert_true(lists > 1000);
    geometry_map_finish(&m);
    setting_close(&s);
    scene_destroy(scene);
}

static void test_packed_numbers(void **state)
{
    (void)state;
    assert_true(coverage_packed_round(0, 5, 8, 15) == 0);
    assert_true(coverage_packed_round(1, 5, 8, 15) == 1);
    assert_true(coverage_packed_round(-3.25f, 5, 8, 15) == -3.25f);
    assert_true(coverage_packed_round(1 + 1.0f / 1024, 5, 8, 15) == 1);
    assert_true(fabsf(coverage_packed_round(1000.3f, 5, 8, 15) - 1000.3f) <= 1);
    assert_true(coverage_packed_round(1e9f, 5, 8, 15) > 6e4f && coverage_packed_round(1e9f, 5, 8, 15) < 7e4f);
    assert_true(coverage_packed_round(NAN, 5, 8, 15) == 0);
    for (float v = 0.01f; v < 1000; v *= 1.37f)
        assert_true(fabsf(coverage_packed_round(v, 5, 8, 15) - v) <= v / 512);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_is_nearer_than_a_texel_says), cmocka_unit_test(test_corners_behind_the_light),
        cmocka_unit_test(test_the_same_whatever_the_threads),       cmocka_unit_test(test_lists_are_the_same_in_any_order),
        cmocka_unit_test(test_recovery_finds_what_no_texel_kept),   cmocka_unit_test(test_asked_together_as_one_by_one),
        cmocka_unit_test(test_every_kernel_gives_the_same_bits),    cmocka_unit_test(test_packed_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
