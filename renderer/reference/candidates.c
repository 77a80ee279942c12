#include "reference/candidates.h"

#include <stdio.h>
#include <stdlib.h>

#include "reference/filter.h"
#include "reference/lines.h"

bool candidate_corners(const struct candidate_part *part, uint32_t triangle, struct dvec3 corners[3])
{
    const struct scene *scene = part->reference->scene;
    bool ok = true;
    for (unsigned i = 0; i < 3; i++) {
        struct dvec3 *c = &corners[i];
        *c = instance_vertex(scene, &scene->instances[part->instance], triangle, i);
        ok &= fabs(c->x) <= FILTER_COORDINATE_MAX && fabs(c->y) <= FILTER_COORDINATE_MAX && fabs(c->z) <= FILTER_COORDINATE_MAX;
    }
    return ok;
}

const struct candidate_part *candidate_part_of(const struct reference *r, uint32_t id)
{
    return &r->parts[scene_instance_of(r->scene, id)];
}

static float below(double x) { return nextafterf((float)x, -INFINITY); }
static float above(double x) { return nextafterf((float)x, INFINITY); }

/* An inverted box: Embree leaves the primitive out. */
static const struct RTCBounds no_bounds = {INFINITY, INFINITY, INFINITY, 0, -INFINITY, -INFINITY, -INFINITY, 0};

static void widened_box(const struct RTCBoundsFunctionArguments *args)
{
    const struct candidate_part *part = args->geometryUserPtr;
    struct dvec3 corners[3];
    *args->bounds_o = no_bounds;
    if (!candidate_corners(part, args->primID, corners))
        return;
    struct dbox box = dbox_empty();
    for (int i = 0; i < 3; i++)
        dbox_add(&box, corners[i]);
    double m = part->reference->margin;
    *args->bounds_o = (struct RTCBounds){
        .lower_x = below(box.min.x - m),
        .lower_y = below(box.min.y - m),
        .lower_z = below(box.min.z - m),
        .upper_x = above(box.max.x + m),
        .upper_y = above(box.max.y + m),
        .upper_z = above(box.max.z + m),
    };
}

/* Over what counts: scene.bounds may hold vertices beyond the limit. */
static void measure(struct reference *r)
{
    struct dbox box = dbox_empty();
    for (size_t i = 0; i < r->scene->instance_count; i++) {
        uint32_t triangles = r->scene->meshes[r->scene->instances[i].mesh].index_count / 3;
        struct dvec3 corners[3];
        for (uint32_t t = 0; t < triangles; t++)
            if (candidate_corners(&r->parts[i], t, corners))
                for (int c = 0; c < 3; c++)
                    dbox_add(&box, corners[c]);
    }
    r->box = box;
    if (dbox_is_empty(&box))
        return;
    double diagonal = 2 * dbox_radius(&box);
    double most = fmax(fmax(fmax(fabs(box.min.x), fabs(box.max.x)), fmax(fabs(box.min.y), fabs(box.max.y))),
                       fmax(fabs(box.min.z), fabs(box.max.z)));
    r->scale = most + diagonal;
    r->margin = r->scale * 0x1p-19;
    struct dvec3 m = dvec3(2 * r->margin, 2 * r->margin, 2 * r->margin);
    r->box.min = dvec3_sub(box.min, m);
    r->box.max = dvec3_add(box.max, m);
}

static bool attach(struct reference *r, size_t index)
{
    uint32_t triangles = r->scene->meshes[r->scene->instances[index].mesh].index_count / 3;
    if (triangles == 0)
        return true;
    RTCGeometry geometry = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry)
        return false;
    rtcSetGeometryUserPrimitiveCount(geometry, triangles);
    rtcSetGeometryUserData(geometry, &r->parts[index]);
    rtcSetGeometryBoundsFunction(geometry, widened_box, NULL);
    rtcSetGeometryIntersectFunction(geometry, lines_meet_triangle);
    rtcSetGeometryOccludedFunction(geometry, lines_blocked_by_triangle);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(r->tree, geometry, (unsigned)index);
    rtcReleaseGeometry(geometry);
    return true;
}

static bool count_memory(void *reference, ssize_t bytes, bool post)
{
    (void)post;
    atomic_fetch_add(&((struct reference *)reference)->embree_bytes, (size_t)bytes);
    return true;
}

bool candidates_build(struct reference *r, unsigned threads)
{
    const struct scene *scene = r->scene;
    r->parts = calloc(scene->instance_count + 1, sizeof *r->parts);
    if (!r->parts)
        return false;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct material *material = &scene->materials[scene->meshes[instance->mesh].material];
        r->parts[i] = (struct candidate_part){
            .reference = r,
            .instance = (uint32_t)i,
            .first_triangle = instance->first_triangle,
            .holes = material_has_holes(material),
            .hidden = material->double_sided ? 0
                      : instance->mirrored   ? -1
                                             : 1,
        };
    }
    measure(r);

    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0", threads);
    r->device = rtcNewDevice(config);
    if (!r->device)
        return false;
    rtcSetDeviceMemoryMonitorFunction(r->device, count_memory, r);
    r->tree = rtcNewScene(r->device);
    if (!r->tree)
        return false;
    rtcSetSceneFlags(r->tree, RTC_SCENE_FLAG_ROBUST);
    for (size_t i = 0; i < scene->instance_count; i++)
        if (!attach(r, i))
            return false;
    rtcCommitScene(r->tree);
    return rtcGetDeviceError(r->device) == RTC_ERROR_NONE;
}

void candidates_finish(struct reference *r)
{
    if (r->tree)
        rtcReleaseScene(r->tree);
    if (r->device)
        rtcReleaseDevice(r->device);
    free(r->parts);
}
