/* Soft shadows by many rays a pixel: what part of a light's disc a receiver sees. Embree's single precision finds candidates; which side of a
 * candidate's plane receiver and light lie on is decided in double, so that no epsilon keeps a surface from shadowing itself: rays start a
 * little behind the receiver, and whatever does not lie strictly between it and the light is passed through. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/job_pool.h"
#include "trace/rays.h"

static const double GOLDEN_ANGLE = 2.399963229728653; /* (3 - sqrt 5) pi */
static const double BACK = 0x1p-20;                   /* of the scene's scale: sixteen roundings of fp32 */
static const double WIDEST_DEG = 85;                  /* of a directional light's disc */
static const double PLANE_NOISE = 0x1p-44;            /* of the scale: nearer to a plane than that is in it */

double tracer_area_radius(const struct scene *scene, const struct light *light)
{
    if (light->radius > 0)
        return light->radius;
    if (light->kind == LIGHT_DIRECTIONAL)
        return 0.5;
    struct dvec3 centre = dbox_is_empty(&scene->bounds) ? dvec3(0, 0, 0) : dbox_center(&scene->bounds);
    return 0.02 * dvec3_length(dvec3_sub(light->position, centre));
}

struct area_job {
    const struct tracer *tracer;
    const struct view *view;
    const struct light *light;
    double reach; /* scene units for a directional light's rays */
    double scale;
    double (*disc)[2]; /* `rays` points, scene units; directional: per unit of distance */
    unsigned rays;
    const uint32_t *ids;
    const uint8_t *receiver;
    float *visibility;
    bool (*report)(void *context, double done);
    void *context;
    size_t tile_total;
    atomic_size_t done;
    atomic_bool stop;
};

/* What the rays of one pixel share, and where each ends. */
struct area_query {
    struct RTCIntersectContext base; /* first: the filter gets at the rest through it */
    const struct tracer *tracer;
    unsigned instance, triangle; /* the receiver's own */
    struct dvec3 point, normal;  /* normal: towards the light's centre */
    double noise;
    bool directional;
    struct dvec3 end[LANES]; /* on the disc; directional: the way there */
};

static void plane_of(const struct tracer *t, unsigned instance, unsigned triangle, struct dvec3 *corner, struct dvec3 *normal)
{
    const struct instance *i = &t->scene->instances[instance];
    struct dvec3 a = instance_vertex(t->scene, i, triangle, 0), b = instance_vertex(t->scene, i, triangle, 1),
                 c = instance_vertex(t->scene, i, triangle, 2);
    *corner = a;
    *normal = dvec3_cross(dvec3_sub(b, a), dvec3_sub(c, a));
}

/* True if the candidate's plane lies strictly between the receiver and that end of its ray. */
static bool lies_between(const struct area_query *q, unsigned instance, unsigned triangle, unsigned lane)
{
    struct dvec3 corner, normal;
    if (instance == q->instance && triangle == q->triangle)
        return false;
    plane_of(q->tracer, instance, triangle, &corner, &normal);
    double here = dvec3_dot(normal, dvec3_sub(q->point, corner));
    double there = dvec3_dot(normal, q->directional ? q->end[lane] : dvec3_sub(q->end[lane], corner));
    double noise = q->noise * (fabs(normal.x) + fabs(normal.y) + fabs(normal.z));
    return (here > noise && there < 0) || (here < -noise && there > 0);
}

static void pass_through_others(const struct RTCFilterFunctionNArguments *args)
{
    const struct area_query *q = (const struct area_query *)args->context;
    unsigned n = args->N;
    for (unsigned i = 0; i < n; i++)
        if (args->valid[i] &&
            !lies_between(q, hit_id(args->hit, HIT_GEOM_ID, n, i), hit_id(args->hit, HIT_PRIM_ID, n, i), ray_id(args->ray, n, i)))
            args->valid[i] = 0;
}

static double largest(struct dvec3 v) { return fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z)); }

/* Two unit vectors that with `axis` make an orthogonal frame. */
static void disc_axes(struct dvec3 axis, struct dvec3 *u, struct dvec3 *v)
{
    double x = fabs(axis.x), y = fabs(axis.y), z = fabs(axis.z);
    struct dvec3 least = x <= y && x <= z ? dvec3(1, 0, 0) : y <= z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
    *u = dvec3_normalize(dvec3_cross(axis, least));
    *v = dvec3_cross(axis, *u);
}

/* False where the pixel's ray and its triangle are parallel. */
static bool query_start(const struct area_job *job, uint32_t id, uint32_t x, uint32_t y, struct area_query *q)
{
    const struct scene *scene = job->tracer->scene;
    struct dvec3 origin, direction, corner;
    q->instance = scene_instance_of(scene, id);
    q->triangle = id - scene->instances[q->instance].first_triangle;
    view_ray(job->view, x + 0.5, y + 0.5, &origin, &direction);
    plane_of(job->tracer, q->instance, q->triangle, &corner, &q->normal);
    double t = dvec3_dot(q->normal, dvec3_sub(corner, origin)) / dvec3_dot(q->normal, direction);
    if (!isfinite(t))
        return false;
    q->point = dvec3_mad(origin, direction, t);
    q->noise = PLANE_NOISE * (job->scale + largest(origin) + largest(q->point));
    struct dvec3 centre = q->directional ? dvec3_neg(job->light->direction) : dvec3_sub(job->light->position, q->point);
    if (dvec3_dot(q->normal, centre) < 0)
        q->normal = dvec3_neg(q->normal);
    return true;
}

/* One ray; false where that point of the disc lies below the receiver's horizon. */
static bool aim(const struct area_job *job, struct area_query *q, struct RTCRay16 *ray, unsigned lane, struct dvec3 end)
{
    struct dvec3 to = q->directional ? end : dvec3_sub(end, q->point);
    double length = dvec3_length(to), back = BACK * (job->scale + largest(q->point));
    if (!(dvec3_dot(q->normal, to) > 0))
        return false;
    struct dvec3 unit = dvec3_scale(to, 1 / length), start = dvec3_mad(q->point, unit, -back);
    q->end[lane] = end;
    ray->org_x[lane] = (float)start.x, ray->org_y[lane] = (float)start.y, ray->org_z[lane] = (float)start.z;
    ray->dir_x[lane] = (float)unit.x, ray->dir_y[lane] = (float)unit.y, ray->dir_z[lane] = (float)unit.z;
    ray->tnear[lane] = 0;
    ray->tfar[lane] = (float)((q->directional ? job->reach : length) + 2 * back);
    ray->time[lane] = 0;
    ray->mask[lane] = ~0u;
    ray->id[lane] = lane;
    ray->flags[lane] = 0;
    return true;
}

static float trace_pixel(const struct area_job *job, struct area_query *q)
{
    struct dvec3 axis = q->directional ? dvec3_neg(job->light->direction) : dvec3_sub(job->light->position, q->point), u, v;
    struct dvec3 centre = q->directional ? axis : job->light->position;
    unsigned seen = 0, free = 0;
    disc_axes(dvec3_normalize(axis), &u, &v);
    for (unsigned first = 0; first < job->rays; first += LANES) {
        struct RTCRay16 ray;
        int valid[LANES] __attribute__((aligned(64)));
        unsigned aimed = 0;
        for (unsigned lane = 0; lane < LANES; lane++) {
            const double *at = job->disc[first + lane < job->rays ? first + lane : 0];
            struct dvec3 end = dvec3_mad(dvec3_mad(centre, u, at[0]), v, at[1]);
            valid[lane] = first + lane < job->rays && aim(job, q, &ray, lane, end) ? -1 : 0;
            aimed += valid[lane] != 0;
        }
        if (aimed == 0)
            continue;
        rtcOccluded16(valid, job->tracer->all, &q->base, &ray);
        seen += aimed;
        for (unsigned lane = 0; lane < LANES; lane++)
            free += valid[lane] && ray.tfar[lane] >= 0;
    }
    return seen ? (float)free / (float)seen : 1;
}

static void area_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    struct area_job *job = context;
    const struct tile tile = tile_at(job->view, index);
    struct area_query q = {.tracer = job->tracer, .directional = job->light->kind == LIGHT_DIRECTIONAL};
    if (atomic_load(&job->stop))
        return;
    rtcInitIntersectContext(&q.base);
    q.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    q.base.filter = pass_through_others;
    for (uint32_t y = tile.y; y < tile.y + tile.height; y++)
        for (uint32_t x = tile.x; x < tile.x + tile.width; x++) {
            size_t at = (size_t)y * job->view->width + x;
            bool counts = job->receiver[at] && query_start(job, job->ids[at], x, y, &q);
            job->visibility[at] = counts ? trace_pixel(job, &q) : 0;
        }
    size_t done = atomic_fetch_add(&job->done, 1) + 1;
    if (job->report && !job->report(job->context, (double)done / (double)job->tile_total))
        atomic_store(&job->stop, true);
}

/* A sunflower (H. Vogel, "A better way to construct the sunflower head", 1979): point k lies in the k-th of `rays` rings of equal area,
 * and no line through the disc has many on it. One ray goes to the centre. */
static void plant_disc(double (*disc)[2], unsigned rays, double radius)
{
    for (unsigned k = 0; k < rays; k++) {
        double r = rays == 1 ? 0 : radius * sqrt((k + 0.5) / rays);
        disc[k][0] = r * cos(k * GOLDEN_ANGLE);
        disc[k][1] = r * sin(k * GOLDEN_ANGLE);
    }
}

bool tracer_shadow_area(const struct tracer *t, const struct view *view, const struct light *light, double radius, unsigned rays,
                        const uint32_t *ids, const uint8_t *receiver, struct job_pool *pool,
                        bool (*report)(void *context, double done), void *context, float *visibility)
{
    double disc[TRACER_AREA_RAYS_MAX][2];
    struct area_job job = {.tracer = t,
                           .view = view,
                           .light = light,
                           .reach = 4 * dbox_radius(&t->scene->bounds) + 1e-30,
                           .scale = fmax(largest(t->scene->bounds.min), largest(t->scene->bounds.max)),
                           .disc = disc,
                           .rays = rays,
                           .ids = ids,
                           .receiver = receiver,
                           .visibility = visibility,
                           .report = report,
                           .context = context,
                           .tile_total = tile_count(view)};
    if (dbox_is_empty(&t->scene->bounds))
        job.scale = 0;
    plant_disc(disc, rays, light->kind == LIGHT_DIRECTIONAL ? tan(fmin(radius, WIDEST_DEG) * (M_PI / 180)) : radius);
    job_pool_for(pool, job.tile_total, area_tile, &job);
    return !atomic_load(&job.stop) || atomic_load(&job.done) == job.tile_total;
}
