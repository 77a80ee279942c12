/* Camera rays in packets, and what comes back of them. */
#include "trace/rays.h"

#include <math.h>

size_t tile_count(const struct view *view)
{
    return (size_t)((view->width + TILE - 1) / TILE) * ((view->height + TILE - 1) / TILE);
}

struct tile tile_at(const struct view *view, size_t index)
{
    size_t columns = (view->width + TILE - 1) / TILE;
    struct tile tile = {.x = (uint32_t)(index % columns) * TILE, .y = (uint32_t)(index / columns) * TILE};
    tile.width = view->width - tile.x < TILE ? view->width - tile.x : TILE;
    tile.height = view->height - tile.y < TILE ? view->height - tile.y : TILE;
    return tile;
}

struct ray_frame ray_frame_make(const struct view *view)
{
    struct ray_frame f = {.tnear = (float)view->near, .tfar = isfinite(view->far) ? (float)view->far : INFINITY};
    double x_step = (view->right_edge - view->left) / view->width, y_step = (view->bottom - view->top) / view->height;
    struct dvec3 corner = dvec3_mad(dvec3_scale(view->right, view->left), view->up, view->top);
    struct dvec3 across = dvec3_scale(view->right, x_step), down = dvec3_scale(view->up, y_step);
    if (view->orthographic) {
        /* Embree wants tnear >= 0: start at the near plane. */
        f.start = view->near;
        f.tnear = 0;
        f.tfar = (float)(view->far - view->near);
        f.origin = dvec3_add(dvec3_mad(view->eye, view->forward, view->near), corner);
        f.origin_x = across;
        f.origin_y = down;
        f.direction = view->forward;
    } else {
        f.origin = view->eye;
        f.direction = dvec3_add(view->forward, corner);
        f.direction_x = across;
        f.direction_y = down;
    }
    return f;
}

/* out = base + x * dx + y * dy over the packet's lanes, rounded once per lane. */
static void fill(float *restrict out, double base, double dx, double dy)
{
    for (int y = 0; y < PACKET; y++)
        for (int x = 0; x < PACKET; x++)
            out[y * PACKET + x] = (float)(base + x * dx + y * dy);
}

static void fill_vector(float *x, float *y, float *z, struct dvec3 base, struct dvec3 dx, struct dvec3 dy, double px, double py)
{
    struct dvec3 at = dvec3_mad(dvec3_mad(base, dx, px), dy, py);
    fill(x, at.x, dx.x, dy.x);
    fill(y, at.y, dx.y, dy.y);
    fill(z, at.z, dx.z, dy.z);
}

void ray_frame_start(const struct ray_frame *f, bool orthographic, struct RTCRayHit16 *packet)
{
    for (int i = 0; i < LANES; i++) {
        packet->ray.tnear[i] = f->tnear;
        packet->ray.time[i] = 0;
        packet->ray.mask[i] = ~0u;
        packet->ray.id[i] = 0;
        packet->ray.flags[i] = 0;
        packet->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    struct RTCRay16 *r = &packet->ray;
    struct dvec3 zero = {0, 0, 0};
    fill_vector(r->org_x, r->org_y, r->org_z, f->origin, zero, zero, 0, 0);
    if (orthographic)
        fill_vector(r->dir_x, r->dir_y, r->dir_z, f->direction, zero, zero, 0, 0);
}

void ray_frame_packet(const struct ray_frame *f, bool orthographic, double x, double y, struct RTCRayHit16 *packet)
{
    struct RTCRay16 *r = &packet->ray;
    if (orthographic)
        fill_vector(r->org_x, r->org_y, r->org_z, f->origin, f->origin_x, f->origin_y, x, y);
    else
        fill_vector(r->dir_x, r->dir_y, r->dir_z, f->direction, f->direction_x, f->direction_y, x, y);
    for (int i = 0; i < LANES; i++) {
        r->tfar[i] = f->tfar;
        packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
}

void ray_frame_samples(const struct ray_frame *f, bool orthographic, double x, double y, const float (*samples)[2],
                       struct RTCRayHit16 *packet)
{
    struct RTCRay16 *r = &packet->ray;
    struct dvec3 base = orthographic ? f->origin : f->direction, dx = orthographic ? f->origin_x : f->direction_x,
                 dy = orthographic ? f->origin_y : f->direction_y;
    struct dvec3 corner = dvec3_mad(dvec3_mad(base, dx, x), dy, y);
    float *out[3] = {orthographic ? r->org_x : r->dir_x, orthographic ? r->org_y : r->dir_y, orthographic ? r->org_z : r->dir_z};
    const double c[3] = {corner.x, corner.y, corner.z}, h[3] = {dx.x, dx.y, dx.z}, v[3] = {dy.x, dy.y, dy.z};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LANES; i++)
            out[k][i] = (float)(c[k] + h[k] * (double)samples[i][0] + v[k] * (double)samples[i][1]);
    for (int i = 0; i < LANES; i++) {
        r->tfar[i] = f->tfar;
        packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
}

void tile_lanes(const struct tile *tile, uint32_t x, uint32_t y, int valid[LANES])
{
    for (unsigned i = 0; i < LANES; i++)
        valid[i] = x + i % PACKET < tile->x + tile->width && y + i / PACKET < tile->y + tile->height ? -1 : 0;
}

void hit_ids(const struct tracer *t, const struct RTCHit16 *hit, uint32_t ids[LANES])
{
    const struct instance *instances = t->scene->instances;
    for (int i = 0; i < LANES; i++)
        ids[i] = hit->geomID[i] == RTC_INVALID_GEOMETRY_ID ? SCENE_NONE
                                                           : instances[hit->geomID[i]].first_triangle + hit->primID[i];
}

/* True for a back face of a one-sided material. */
static bool is_hidden(const struct tracer *t, unsigned instance, float facing)
{
    switch (t->front[instance]) {
    case FRONT_CCW:
        return facing > 0;
    case FRONT_CW:
        return facing < 0;
    default:
        return false;
    }
}

/* Query context of a packet that passes through hidden faces. */
struct visible_context {
    struct RTCIntersectContext base;
    const struct tracer *tracer;
};

static void refuse_hidden(const struct RTCFilterFunctionNArguments *args)
{
    const struct tracer *t = ((const struct visible_context *)args->context)->tracer;
    unsigned n = args->N;
    for (unsigned i = 0; i < n; i++) {
        if (!args->valid[i])
            continue;
        float facing = hit_float(args->hit, HIT_NG_X, n, i) * ray_float(args->ray, RAY_DIR_X, n, i) +
                       hit_float(args->hit, HIT_NG_Y, n, i) * ray_float(args->ray, RAY_DIR_Y, n, i) +
                       hit_float(args->hit, HIT_NG_Z, n, i) * ray_float(args->ray, RAY_DIR_Z, n, i);
        if (is_hidden(t, hit_id(args->hit, HIT_GEOM_ID, n, i), facing))
            args->valid[i] = 0;
    }
}

static void hit_facing(const struct RTCRayHit16 *p, float facing[restrict LANES])
{
    for (int i = 0; i < LANES; i++)
        facing[i] = p->hit.Ng_x[i] * p->ray.dir_x[i] + p->hit.Ng_y[i] * p->ray.dir_y[i] + p->hit.Ng_z[i] * p->ray.dir_z[i];
}

void trace_visible(const struct tracer *t, const int valid[LANES], float tfar, struct RTCRayHit16 *packet, float facing[LANES])
{
    struct visible_context context = {.tracer = t};
    rtcInitIntersectContext(&context.base);
    context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, t->all, &context.base, packet);
    hit_facing(packet, facing);

    int again[LANES] __attribute__((aligned(64)));
    bool any = false;
    for (int i = 0; i < LANES; i++) {
        again[i] = 0;
        if (!valid[i] || packet->hit.geomID[i] == RTC_INVALID_GEOMETRY_ID || !is_hidden(t, packet->hit.geomID[i], facing[i]))
            continue;
        again[i] = -1;
        any = true;
        packet->ray.tfar[i] = tfar;
        packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    if (!any)
        return;
    context.base.filter = refuse_hidden;
    rtcIntersect16(again, t->all, &context.base, packet);
    hit_facing(packet, facing);
}
