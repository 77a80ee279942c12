/* The tree: one Embree geometry an instance over flattened vertices. Flattening costs 12 bytes a drawn vertex and a tree over every drawn
 * triangle. It spares each ray the transform and the second descent of Embree's instances, and the fp32 rounding of their transforms.
 * Indices are shared with the scene. */
#include <stdlib.h>
#include <stdio.h>

#include "base/error.h"
#include "trace/hole.h"
#include "trace/surface.h"
#include "trace/tree.h"

static bool count_memory(void *tracer, ssize_t bytes, bool post)
{
    (void)post;
    atomic_fetch_add(&((struct tracer *)tracer)->embree_bytes, (size_t)bytes);
    return true;
}

/* For geometries whose material has holes, camera and shadow rays alike. */
static void refuse_holes(const struct RTCFilterFunctionNArguments *args)
{
    const struct scene *scene = args->geometryUserPtr;
    unsigned n = args->N;
    for (unsigned i = 0; i < n; i++)
        if (args->valid[i] && !hole_is_solid(scene, hit_id(args->hit, HIT_GEOM_ID, n, i), hit_id(args->hit, HIT_PRIM_ID, n, i),
                                             hit_float(args->hit, HIT_U, n, i), hit_float(args->hit, HIT_V, n, i)))
            args->valid[i] = 0;
}

/* Vertices that are not finite stay so in fp32: Embree leaves out every triangle that has one. */
static void flatten(const struct tracer *t, size_t index)
{
    const struct instance *instance = &t->scene->instances[index];
    const struct mesh *mesh = &t->scene->meshes[instance->mesh];
    float(*out)[3] = t->vertices + t->first_vertex[index];
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        struct dvec3 p = affine_point(&instance->to_scene, dvec3_from_float(t->scene->positions[mesh->first_vertex + i]));
        out[i][0] = (float)p.x;
        out[i][1] = (float)p.y;
        out[i][2] = (float)p.z;
    }
}

static bool attach(struct tracer *t, size_t index)
{
    const struct instance *instance = &t->scene->instances[index];
    const struct mesh *mesh = &t->scene->meshes[instance->mesh];
    const struct material *material = &t->scene->materials[mesh->material];
    t->front[index] = material->double_sided ? FRONT_BOTH : instance->mirrored ? FRONT_CW : FRONT_CCW;
    if (mesh->index_count < 3 || mesh->vertex_count == 0)
        return true;
    flatten(t, index);
    RTCGeometry geometry = rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry)
        return false;
    t->geometries[index] = geometry;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, t->vertices,
                               t->first_vertex[index] * sizeof t->vertices[0], sizeof t->vertices[0], mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, t->scene->indices,
                               (size_t)mesh->first_index * sizeof t->scene->indices[0], 3 * sizeof t->scene->indices[0],
                               mesh->index_count / 3);
    if (material_has_holes(material)) {
        rtcSetGeometryUserData(geometry, (void *)t->scene);
        rtcSetGeometryIntersectFilterFunction(geometry, refuse_holes);
        rtcSetGeometryOccludedFilterFunction(geometry, refuse_holes);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(t->all, geometry, (unsigned)index);
    return true;
}

static bool allocate(struct tracer *t)
{
    size_t instances = t->scene->instance_count;
    t->first_vertex = calloc(instances + 1, sizeof *t->first_vertex);
    t->geometries = calloc(instances + 1, sizeof(RTCGeometry));
    t->front = calloc(instances + 1, 1);
    t->surfaces = surfaces_create(t->scene);
    t->casters = caster_cache_create();
    if (!t->first_vertex || !t->geometries || !t->front || !t->surfaces || !t->casters)
        return false;
    for (size_t i = 0; i < instances; i++) {
        t->first_vertex[i] = t->vertex_count;
        t->vertex_count += t->scene->meshes[t->scene->instances[i].mesh].vertex_count;
    }
    /* Embree reads vertices sixteen bytes at a time: one more. */
    t->vertices = calloc(t->vertex_count + 2, sizeof *t->vertices);
    return t->vertices != NULL;
}

static bool build(struct tracer *t, unsigned threads)
{
    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0", threads);
    t->device = rtcNewDevice(config);
    if (!t->device)
        return false;
    rtcSetDeviceMemoryMonitorFunction(t->device, count_memory, t);
    t->all = rtcNewScene(t->device);
    if (!t->all)
        return false;
    rtcSetSceneFlags(t->all, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    for (size_t i = 0; i < t->scene->instance_count; i++)
        if (!attach(t, i))
            return false;
    rtcCommitScene(t->all);
    return rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

struct tracer *tracer_create(const struct scene *scene, unsigned threads, struct error *err)
{
    struct tracer *t = calloc(1, sizeof *t);
    if (t) {
        t->scene = scene;
        if (allocate(t) && build(t, threads))
            return t;
    }
    tracer_destroy(t);
    error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the ray tracer's tree of %zu triangles",
              scene->drawn_triangle_count);
    return NULL;
}

void tracer_destroy(struct tracer *t)
{
    if (!t)
        return;
    caster_cache_destroy(t->casters);
    for (size_t i = 0; t->geometries && i < t->scene->instance_count; i++)
        if (t->geometries[i])
            rtcReleaseGeometry(t->geometries[i]);
    if (t->all)
        rtcReleaseScene(t->all);
    if (t->device)
        rtcReleaseDevice(t->device);
    free(t->vertices);
    free(t->front);
    free(t->surfaces);
    free(t->geometries);
    free(t->first_vertex);
    free(t);
}

size_t tracer_bytes(const struct tracer *t)
{
    return atomic_load(&t->embree_bytes) + sizeof *t + t->vertex_count * sizeof t->vertices[0] +
           t->scene->instance_count * (sizeof(RTCGeometry) + sizeof(size_t) + sizeof(struct surface) + 1);
}
