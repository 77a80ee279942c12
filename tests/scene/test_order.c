/* The order of dense meshes' triangles (scene/order.c): the same triangles, neighbours near each other. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "made_scene.h"

enum { SIDE = 140, TRIANGLES = 2 * SIDE * SIDE, POINTS = (SIDE + 1) * (SIDE + 1) };

struct sheet {
    float points[POINTS][3], uv[POINTS][2];
    uint32_t indices[3 * TRIANGLES];
};

/* A wavy sheet whose points and triangles come in a random order. */
static struct sheet *shuffled_sheet(void)
{
    struct sheet *s = malloc(sizeof *s);
    uint32_t *place = malloc(POINTS * sizeof *place);
    assert_true(s && place);
    srand(5);
    for (uint32_t i = 0; i < POINTS; i++) {
        uint32_t j = (uint32_t)rand() % (i + 1);
        place[i] = place[j];
        place[j] = i;
    }
    for (uint32_t i = 0; i < POINTS; i++) {
        float x = (float)(i % (SIDE + 1)), y = (float)(i / (SIDE + 1));
        memcpy(s->points[place[i]], (float[3]){x, y, sinf(x)}, sizeof *s->points);
        memcpy(s->uv[place[i]], (float[2]){x / 7, y / 5}, sizeof *s->uv);
    }
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        uint32_t j = (uint32_t)rand() % (i + 1), corner = i / 2 % SIDE + i / 2 / SIDE * (SIDE + 1);
        uint32_t next[3] = {corner + i % 2, corner + 1 + (i % 2) * (SIDE + 1), corner + SIDE + 1};
        memcpy(s->indices + 3 * i, s->indices + 3 * j, 3 * sizeof *s->indices);
        for (int k = 0; k < 3; k++)
            s->indices[3 * j + k] = place[next[k]];
    }
    free(place);
    return s;
}

/* What a triangle is, whatever the order it comes in: its corners, the way round and the first one included. */
static uint64_t print_of(const float (*points)[3], const float (*uv)[2], const uint32_t *index)
{
    uint64_t hash = 1469598103934665603u;
    for (int k = 0; k < 3; k++) {
        uint32_t words[5];
        memcpy(words, points[index[k]], 12);
        memcpy(words + 3, uv[index[k]], 8);
        for (int i = 0; i < 5; i++)
            hash = (hash ^ words[i]) * 1099511628211u;
    }
    return hash;
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

static uint64_t *prints(const float (*points)[3], const float (*uv)[2], const uint32_t *indices)
{
    uint64_t *all = malloc(TRIANGLES * sizeof *all);
    assert_non_null(all);
    for (size_t i = 0; i < TRIANGLES; i++)
        all[i] = print_of(points, uv, indices + 3 * i);
    qsort(all, TRIANGLES, sizeof *all, compare);
    return all;
}

/* Mean distance of one triangle's first corner from the next one's. */
static double mean_step(const float (*points)[3], const uint32_t *indices)
{
    double sum = 0;
    for (size_t i = 3; i < 3 * (size_t)TRIANGLES; i += 3)
        sum += hypot((double)points[indices[i]][0] - points[indices[i - 3]][0],
                     (double)points[indices[i]][1] - points[indices[i - 3]][1]);
    return sum / (TRIANGLES - 1);
}

/* Mean distance of one corner's vertex from the next one's, in the array. */
static double mean_jump(const uint32_t *indices)
{
    double sum = 0;
    for (size_t i = 1; i < 3 * (size_t)TRIANGLES; i++)
        sum += fabs((double)indices[i] - indices[i - 1]);
    return sum / (3 * TRIANGLES - 1);
}

static void test_same_triangles_near_each_other(void **state)
{
    (void)state;
    struct sheet *s = shuffled_sheet();
    struct scene *scene = made_scene();
    made_instance(scene,
                  made_mesh(scene, (const float(*)[3])s->points, (const float(*)[2])s->uv, POINTS, s->indices, 3 * TRIANGLES,
                            made_material(scene, true)),
                  affine_identity());
    made_finish(scene);
    const struct mesh *m = &scene->meshes[0];
    const float(*points)[3] = (const float(*)[3])scene->positions + m->first_vertex;
    const float(*uv)[2] = (const float(*)[2])scene->texcoords + m->first_texcoord[0];
    const uint32_t *indices = scene->indices + m->first_index;
    uint64_t *before = prints((const float(*)[3])s->points, (const float(*)[2])s->uv, s->indices),
             *after = prints(points, uv, indices);
    assert_memory_equal(before, after, TRIANGLES * sizeof *before);
    assert_true(mean_step((const float(*)[3])s->points, s->indices) > 40);
    assert_true(mean_step(points, indices) < 4);
    assert_true(mean_jump(indices) < mean_jump(s->indices) / 10);
    free(after);
    free(before);
    free(s);
    scene_destroy(scene);
}

/* Two meshes that draw from the same vertices: those stay where they are. */
static void test_shared_vertices_stay(void **state)
{
    (void)state;
    struct sheet *s = shuffled_sheet();
    struct scene *scene = made_scene();
    uint32_t material = made_material(scene, true);
    uint32_t mesh =
        made_mesh(scene, (const float(*)[3])s->points, (const float(*)[2])s->uv, POINTS, s->indices, 3 * TRIANGLES, material);
    made_instance(scene, mesh, affine_identity());
    uint32_t other = made_mesh(scene, (const float(*)[3])s->points, NULL, 3, s->indices, 3, material);
    scene->meshes[other].first_vertex = scene->meshes[mesh].first_vertex;
    scene->meshes[other].vertex_count = POINTS;
    made_finish(scene);
    assert_memory_equal(scene->positions + scene->meshes[mesh].first_vertex, s->points, sizeof s->points);
    free(s);
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_triangles_near_each_other),
        cmocka_unit_test(test_shared_vertices_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
