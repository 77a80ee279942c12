#include "reference/oracle.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/job_pool.h"
#include "trace/hole.h"
#include "trace/tracer.h"

enum { RAYS = ORACLE_SIDE * ORACLE_SIDE, CHUNK = 64 };

/* A receiver and the texel it lies in, over all maps. */
struct placed {
    uint64_t texel;
    uint32_t pixel;
};

struct oracle_job {
    const struct scene *scene;
    const struct tracer *tracer;
    const struct oracle_input *in;
    const struct reference_progress *progress;
    struct placed *placed;
    size_t count;
    float *visibility;
    size_t chunks;
    atomic_size_t done;
    atomic_bool stop;
};

static bool receiver_point(const struct scene *scene, const struct oracle_input *in, uint32_t pixel, struct dvec3 *point)
{
    const struct instance *instance = &scene->instances[scene_instance_of(scene, in->ids[pixel])];
    uint32_t triangle = in->ids[pixel] - instance->first_triangle;
    struct dvec3 a = instance_vertex(scene, instance, triangle, 0), origin, direction;
    struct dvec3 normal = dvec3_cross(dvec3_sub(instance_vertex(scene, instance, triangle, 1), a),
                                      dvec3_sub(instance_vertex(scene, instance, triangle, 2), a));
    view_ray(in->view, pixel % in->view->width + 0.5, pixel / in->view->width + 0.5, &origin, &direction);
    double t = dvec3_dot(normal, dvec3_sub(a, origin)) / dvec3_dot(normal, direction);
    *point = dvec3_mad(origin, direction, t);
    return isfinite(t);
}

/* False where no map sees the point. */
static bool texel_of(const struct oracle_input *in, struct dvec3 point, uint64_t *texel)
{
    for (unsigned m = 0; m < in->map_count; m++) {
        const struct view *map = &in->maps[m];
        double x, y, depth;
        if (!view_project(map, point, &x, &y, &depth) || !(x >= 0 && y >= 0 && x < map->width && y < map->height))
            continue;
        *texel = ((uint64_t)m * map->height + (uint64_t)y) * map->width + (uint64_t)x;
        return true;
    }
    return false;
}

static int by_texel(const void *a, const void *b)
{
    const struct placed *x = a, *y = b;
    if (x->texel != y->texel)
        return x->texel < y->texel ? -1 : 1;
    return (x->pixel > y->pixel) - (x->pixel < y->pixel);
}

static struct view texel_view(const struct oracle_input *in, uint64_t texel)
{
    const struct view *map = &in->maps[texel / ((uint64_t)in->maps[0].width * in->maps[0].height)];
    struct view view = *map;
    double column = (double)(texel % map->width), row = (double)(texel / map->width % map->height);
    double width = (map->right_edge - map->left) / map->width, height = (map->bottom - map->top) / map->height;
    view.width = view.height = ORACLE_SIDE;
    view.left = map->left + column * width;
    view.right_edge = view.left + width;
    view.top = map->top + row * height;
    view.bottom = view.top + height;
    return view;
}

struct listed {
    uint32_t id;
    unsigned rays;
};

static int by_visibility(const void *a, const void *b)
{
    const struct listed *x = a, *y = b;
    if (x->rays != y->rays)
        return x->rays > y->rays ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

static int by_id(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* The most visible first; returns how many there are, at most `length`. */
static unsigned make_list(uint32_t ids[RAYS], unsigned length, struct listed list[RAYS])
{
    unsigned count = 0;
    qsort(ids, RAYS, sizeof *ids, by_id);
    for (unsigned i = 0; i < RAYS && ids[i] != SCENE_NONE; i++) {
        if (count == 0 || list[count - 1].id != ids[i])
            list[count++] = (struct listed){ids[i], 0};
        list[count - 1].rays++;
    }
    qsort(list, count, sizeof *list, by_visibility);
    return count < length ? count : length;
}

/* The segment from the point to the light (or along `to`, without end) through the triangle, in double: Moeller and Trumbore 1997. */
static bool blocks(const struct scene *scene, uint32_t id, struct dvec3 point, struct dvec3 to, bool directional)
{
    uint32_t index = scene_instance_of(scene, id);
    const struct instance *instance = &scene->instances[index];
    uint32_t triangle = id - instance->first_triangle;
    struct dvec3 a = instance_vertex(scene, instance, triangle, 0);
    struct dvec3 e1 = dvec3_sub(instance_vertex(scene, instance, triangle, 1), a);
    struct dvec3 e2 = dvec3_sub(instance_vertex(scene, instance, triangle, 2), a);
    struct dvec3 q = dvec3_cross(to, e2), w = dvec3_sub(point, a), x = dvec3_cross(w, e1);
    double k = dvec3_dot(e1, q), u = dvec3_dot(w, q) / k, v = dvec3_dot(to, x) / k, t = dvec3_dot(e2, x) / k;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0 && (directional || t < 1)))
        return false;
    const struct material *material = &scene->materials[scene->meshes[instance->mesh].material];
    return !material_has_holes(material) || hole_is_solid(scene, index, triangle, u, v);
}

/* What is kept of a texel. */
struct texel_list {
    struct view view;
    struct listed list[RAYS];
    unsigned count;
    double deepest; /* of the rays' hits; INFINITY where some ray met nothing */
};

static void look(const struct oracle_job *job, uint64_t texel, struct texel_list *out)
{
    float depths[RAYS];
    uint32_t ids[RAYS];
    out->view = texel_view(job->in, texel);
    tracer_light_ids(job->tracer, &out->view, 1, job->in->casters, job->in->caster_count, depths, ids);
    out->deepest = -INFINITY;
    for (unsigned i = 0; i < RAYS; i++)
        out->deepest = fmax(out->deepest, (double)depths[i]);
    out->count = make_list(ids, job->in->length, out->list);
}

static const double DEEPER = 1e-5; /* of the depth: past fp32's noise */

static float decide(const struct oracle_job *job, uint32_t pixel, const struct texel_list *texel)
{
    const struct light *light = job->in->light;
    bool directional = light->kind == LIGHT_DIRECTIONAL;
    struct dvec3 point;
    if (!receiver_point(job->scene, job->in, pixel, &point))
        return 1;
    struct dvec3 to = directional ? dvec3_neg(light->direction) : dvec3_sub(light->position, point);
    for (unsigned i = 0; i < texel->count; i++)
        if (texel->list[i].id != job->in->ids[pixel] && blocks(job->scene, texel->list[i].id, point, to, directional))
            return 0;
    double depth = dvec3_dot(dvec3_sub(point, texel->view.eye), texel->view.forward);
    return depth > texel->deepest + DEEPER * fabs(texel->deepest) ? 0 : 1;
}

static void run_chunk(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct oracle_job *job = context;
    struct texel_list texel;
    uint64_t current = UINT64_MAX;
    if (atomic_load(&job->stop))
        return;
    for (size_t i = index * CHUNK; i < (index + 1) * CHUNK && i < job->count; i++) {
        const struct placed *p = &job->placed[i];
        if (p->texel != current)
            look(job, current = p->texel, &texel);
        job->visibility[p->pixel] = decide(job, p->pixel, &texel);
    }
    size_t done = atomic_fetch_add(&job->done, 1) + 1;
    if (job->progress && job->progress->report &&
        !job->progress->report(job->progress->context, (double)done / (double)job->chunks))
        atomic_store(&job->stop, true);
}

bool oracle_visibility(const struct scene *scene, const struct tracer *tracer, const struct oracle_input *in,
                       struct job_pool *pool, const struct reference_progress *progress, float *visibility)
{
    struct oracle_job job = {.scene = scene, .tracer = tracer, .in = in, .progress = progress, .visibility = visibility};
    uint32_t pixels = in->view->width * in->view->height;
    job.placed = malloc((size_t)pixels * sizeof *job.placed);
    if (!job.placed)
        return false;
    for (uint32_t p = 0; p < pixels; p++) {
        struct dvec3 point;
        uint64_t texel;
        visibility[p] = in->receiver[p] ? 1 : 0;
        if (in->receiver[p] && receiver_point(scene, in, p, &point) && texel_of(in, point, &texel))
            job.placed[job.count++] = (struct placed){texel, p};
    }
    qsort(job.placed, job.count, sizeof *job.placed, by_texel);
    job.chunks = (job.count + CHUNK - 1) / CHUNK;
    job_pool_for(pool, job.chunks, run_chunk, &job);
    free(job.placed);
    return !atomic_load(&job.stop) || atomic_load(&job.done) == job.chunks;
}
