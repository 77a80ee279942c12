/* Camera rays in packets, and what comes back of them. */
#include "trace/rays.h"

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
    double x_step = (view->right_edge - view->left) / view->width, y_step = (view->bottom - view->top) / view->height;
    struct dvec3 corner = dvec3_mad(dvec3_scale(view->right, view->left), view->up, view->top);
    struct ray_frame f = {
        .orthographic = view->orthographic,
        .shared = view->eye,
        .varying = dvec3_add(view->forward, corner),
        .dx = dvec3_scale(view->right, x_step),
        .dy = dvec3_scale(view->up, y_step),
        .tnear = (float)view->near,
        .tfar = (float)view->far,
    };
    if (view->orthographic) {
        /* Embree wants tnear >= 0: start at the near plane. */
        f.start = view->near;
        f.tnear = 0;
        f.tfar = (float)(view->far - view->near);
        f.shared = view->forward;
        f.varying = dvec3_add(dvec3_mad(view->eye, view->forward, view->near), corner);
    }
    return f;
}

struct ray_offsets ray_offsets_make(const struct ray_frame *f, const float (*positions)[2])
{
    struct ray_offsets o;
    for (int i = 0; i < LANES; i++) {
        double x = (double)positions[i][0], y = (double)positions[i][1];
        o.x[i] = f->dx.x * x + f->dy.x * y;
        o.y[i] = f->dx.y * x + f->dy.y * y;
        o.z[i] = f->dx.z * x + f->dy.z * y;
    }
    return o;
}

struct ray_offsets ray_offsets_pixels(const struct ray_frame *f)
{
    float positions[LANES][2];
    for (int i = 0; i < LANES; i++) {
        positions[i][0] = (float)(i % PACKET) + 0.5f;
        positions[i][1] = (float)(i / PACKET) + 0.5f;
    }
    return ray_offsets_make(f, (const float(*)[2])positions);
}

static void fill(float *restrict out, double base, const double *restrict offsets)
{
    for (int i = 0; i < LANES; i++)
        out[i] = (float)(base + offsets[i]);
}

void ray_frame_start(const struct ray_frame *f, struct RTCRayHit16 *packet)
{
    static const double none[LANES];
    struct RTCRay16 *r = &packet->ray;
    for (int i = 0; i < LANES; i++) {
        r->tnear[i] = f->tnear;
        r->time[i] = 0;
        r->mask[i] = ~0u;
        r->id[i] = 0;
        r->flags[i] = 0;
        packet->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    fill(f->orthographic ? r->dir_x : r->org_x, f->shared.x, none);
    fill(f->orthographic ? r->dir_y : r->org_y, f->shared.y, none);
    fill(f->orthographic ? r->dir_z : r->org_z, f->shared.z, none);
}

void ray_frame_packet(const struct ray_frame *f, const struct ray_offsets *offsets, double x, double y,
                      struct RTCRayHit16 *packet)
{
    struct RTCRay16 *r = &packet->ray;
    const struct dvec3 at = dvec3_mad(dvec3_mad(f->varying, f->dx, x), f->dy, y);
    fill(f->orthographic ? r->org_x : r->dir_x, at.x, offsets->x);
    fill(f->orthographic ? r->org_y : r->dir_y, at.y, offsets->y);
    fill(f->orthographic ? r->org_z : r->dir_z, at.z, offsets->z);
    for (int i = 0; i < LANES; i++) {
        r->tfar[i] = f->tfar;
        packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
}

bool tile_lanes(const struct tile *tile, uint32_t x, uint32_t y, int valid[LANES])
{
    uint32_t columns = tile->x + tile->width - x, rows = tile->y + tile->height - y;
    for (unsigned i = 0; i < LANES; i++)
        valid[i] = i % PACKET < columns && i / PACKET < rows ? -1 : 0;
    return columns >= PACKET && rows >= PACKET;
}

void hit_ids(const struct tracer *t, const struct RTCHit16 *hit, uint32_t ids[LANES])
{
    const struct instance *instances = t->scene->instances;
    for (int i = 0; i < LANES; i++)
        ids[i] =
            hit->geomID[i] == RTC_INVALID_GEOMETRY_ID ? SCENE_NONE : instances[hit->geomID[i]].first_triangle + hit->primID[i];
}

/* True for a back face of a one-sided material. */
static bool is_hidden(const struct tracer *t, unsigned instance, float facing)
{
    switch (t->front[instance]) {
    case FRONT_CCW: return facing > 0;
    case FRONT_CW: return facing < 0;
    default: return false;
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
