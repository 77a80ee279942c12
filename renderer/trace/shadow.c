/* Shadows as plain Embree has them: what speed costs and what error it brings when nothing more is done. Rays start a little off their own
 * triangle (OFFSET of the distances involved), as ray tracers do; everything is fp32. */
#include <math.h>

#include "base/job_pool.h"
#include "trace/rays.h"

/* Of 1e-6, 1e-5 and 1e-4, the one with the fewest wrong bits on dragon and ball-lattice at 640 x 360 (15 and 80 of 4.5 million). */
#define OFFSET 1e-4f

struct light_frame {
    bool directional, spot;
    float position[3], direction[3]; /* direction: the way light travels */
    float cos_outer, range, reach;   /* reach: length of a directional light's rays */
};

static struct light_frame light_frame_make(const struct scene *scene, const struct light *light)
{
    return (struct light_frame){
        .directional = light->kind == LIGHT_DIRECTIONAL,
        .spot = light->kind == LIGHT_SPOT,
        .position = {(float)light->position.x, (float)light->position.y, (float)light->position.z},
        .direction = {(float)light->direction.x, (float)light->direction.y, (float)light->direction.z},
        .cos_outer = (float)cos(light->outer),
        .range = light->range > 0 ? (float)light->range : INFINITY,
        .reach = (float)(4 * dbox_radius(&scene->bounds) + 1e-30),
    };
}

/* What the camera's packet saw, and the rays to the light from there. */
struct shadow_packet {
    struct RTCRay16 ray;
    int valid[LANES] __attribute__((aligned(64)));
};

static float largest(float x, float y, float z) { return fmaxf(fmaxf(fabsf(x), fabsf(y)), fabsf(z)); }

/* Aims one lane from point `p` with normal `n` (turned towards the eye, any length) at the light; false if it is no receiver. */
static bool aim(struct shadow_packet *s, int lane, const struct light_frame *light, const float p[3], const float n[3],
                float depth)
{
    struct RTCRay16 *r = &s->ray;
    float to[3], length = light->reach;
    for (int i = 0; i < 3; i++)
        to[i] = light->directional ? -light->direction[i] : light->position[i] - p[i];
    if (!(n[0] * to[0] + n[1] * to[1] + n[2] * to[2] > 0))
        return false;
    if (!light->directional) {
        length = sqrtf(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
        for (int i = 0; i < 3; i++)
            to[i] /= length;
        float cosine = -(to[0] * light->direction[0] + to[1] * light->direction[1] + to[2] * light->direction[2]);
        if (length > light->range || (light->spot && cosine < light->cos_outer))
            return false;
    }
    float offset = OFFSET * (largest(p[0], p[1], p[2]) + depth);
    r->org_x[lane] = p[0], r->org_y[lane] = p[1], r->org_z[lane] = p[2];
    r->dir_x[lane] = to[0], r->dir_y[lane] = to[1], r->dir_z[lane] = to[2];
    r->tnear[lane] = offset;
    r->tfar[lane] = length;
    r->time[lane] = 0;
    r->mask[lane] = ~0u;
    r->id[lane] = 0;
    r->flags[lane] = 0;
    return true;
}

/* Bits of the lanes whose ray to the light is free, of those valid. */
static uint32_t trace_lit(const struct tracer *t, struct shadow_packet *s)
{
    struct RTCIntersectContext query;
    uint32_t lit = 0;
    rtcInitIntersectContext(&query);
    query.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded16(s->valid, t->all, &query, &s->ray);
    for (unsigned i = 0; i < LANES; i++)
        lit |= (uint32_t)(s->valid[i] && s->ray.tfar[i] >= 0) << i;
    return lit;
}

struct shadow_job {
    const struct tracer *tracer;
    const struct view *view;
    struct ray_frame frame;
    struct ray_offsets offsets[2]; /* pixels; or both halves of the samples */
    struct light_frame light;
    const uint32_t *ids;
    float *visibility;
    uint32_t *receivers, *lit;
};

/* Where the ray of a lane meets the plane of triangle `id`, and its normal turned towards the eye; false when parallel. */
static bool plane_point(const struct tracer *t, uint32_t id, const struct RTCRay16 *ray, int lane, float p[3], float n[3],
                        float *depth)
{
    uint32_t instance = scene_instance_of(t->scene, id);
    const struct mesh *mesh = &t->scene->meshes[t->scene->instances[instance].mesh];
    const uint32_t *corner =
        t->scene->indices + mesh->first_index + 3 * (size_t)(id - t->scene->instances[instance].first_triangle);
    const float o[3] = {ray->org_x[lane], ray->org_y[lane], ray->org_z[lane]};
    const float d[3] = {ray->dir_x[lane], ray->dir_y[lane], ray->dir_z[lane]};
    float v[3][3];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            v[k][i] = t->vertices[t->first_vertex[instance] + corner[k]][i] - o[i];
    float e[3] = {v[1][0] - v[0][0], v[1][1] - v[0][1], v[1][2] - v[0][2]};
    float f[3] = {v[2][0] - v[0][0], v[2][1] - v[0][1], v[2][2] - v[0][2]};
    for (int i = 0; i < 3; i++)
        n[i] = e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
    float slope = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
    *depth = (n[0] * v[0][0] + n[1] * v[0][1] + n[2] * v[0][2]) / slope;
    for (int i = 0; i < 3; i++) {
        p[i] = o[i] + *depth * d[i];
        n[i] = slope > 0 ? -n[i] : n[i];
    }
    return slope != 0 && isfinite(*depth);
}

static void point_packet(const struct shadow_job *job, const struct tile *tile, const struct RTCRay16 *ray, uint32_t x,
                         uint32_t y)
{
    struct shadow_packet s;
    int inside[LANES];
    bool any = false;
    tile_lanes(tile, x, y, inside);
    for (int i = 0; i < LANES; i++) {
        s.valid[i] = 0;
        if (!inside[i])
            continue;
        uint32_t id = job->ids[(size_t)(y + (unsigned)i / PACKET) * job->view->width + x + (unsigned)i % PACKET];
        float p[3], n[3], depth;
        if (id != SCENE_NONE && plane_point(job->tracer, id, ray, i, p, n, &depth) && aim(&s, i, &job->light, p, n, depth))
            any = true, s.valid[i] = -1;
    }
    uint32_t lit = any ? trace_lit(job->tracer, &s) : 0;
    for (uint32_t i = 0; i < LANES; i++)
        if (inside[i])
            job->visibility[(size_t)(y + i / PACKET) * job->view->width + x + i % PACKET] = lit >> i & 1 ? 1.0f : 0.0f;
}

static void point_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct shadow_job *job = context;
    const struct tile tile = tile_at(job->view, index);
    struct RTCRayHit16 packet;
    ray_frame_start(&job->frame, &packet);
    for (uint32_t y = tile.y; y < tile.y + tile.height; y += PACKET)
        for (uint32_t x = tile.x; x < tile.x + tile.width; x += PACKET) {
            ray_frame_packet(&job->frame, &job->offsets[0], x, y, &packet);
            point_packet(job, &tile, &packet.ray, x, y);
        }
}

void tracer_shadow_point(const struct tracer *t, const struct view *view, const struct light *light, const uint32_t *ids,
                         struct job_pool *pool, float *visibility)
{
    struct shadow_job job = {.tracer = t,
                             .view = view,
                             .frame = ray_frame_make(view),
                             .light = light_frame_make(t->scene, light),
                             .ids = ids,
                             .visibility = visibility};
    job.offsets[0] = ray_offsets_pixels(&job.frame);
    job_pool_for(pool, tile_count(view), point_tile, &job);
}

/* Sixteen samples of a pixel: bits of receivers, and of those the lit ones. */
static uint32_t sample_packet(const struct shadow_job *job, unsigned half, uint32_t x, uint32_t y, struct RTCRayHit16 *packet,
                              uint32_t *lit)
{
    static const int all[LANES] __attribute__((aligned(64))) = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
    struct shadow_packet s;
    float facing[LANES];
    uint32_t receivers = 0;
    ray_frame_packet(&job->frame, &job->offsets[half], x, y, packet);
    trace_visible(job->tracer, all, job->frame.tfar, packet, facing);
    for (int i = 0; i < LANES; i++) {
        const struct RTCRay16 *r = &packet->ray;
        const struct RTCHit16 *h = &packet->hit;
        s.valid[i] = 0;
        if (h->geomID[i] == RTC_INVALID_GEOMETRY_ID)
            continue;
        float t = r->tfar[i], flip = facing[i] > 0 ? -1 : 1;
        const float p[3] = {r->org_x[i] + t * r->dir_x[i], r->org_y[i] + t * r->dir_y[i], r->org_z[i] + t * r->dir_z[i]};
        const float n[3] = {flip * h->Ng_x[i], flip * h->Ng_y[i], flip * h->Ng_z[i]};
        if (aim(&s, i, &job->light, p, n, t))
            s.valid[i] = -1, receivers |= 1u << i;
    }
    *lit = receivers ? trace_lit(job->tracer, &s) : 0;
    return receivers;
}

static void sample_tile(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct shadow_job *job = context;
    const struct tile tile = tile_at(job->view, index);
    struct RTCRayHit16 packet;
    ray_frame_start(&job->frame, &packet);
    for (uint32_t y = tile.y; y < tile.y + tile.height; y++)
        for (uint32_t x = tile.x; x < tile.x + tile.width; x++) {
            uint32_t lit[2];
            uint32_t low = sample_packet(job, 0, x, y, &packet, &lit[0]), high = sample_packet(job, 1, x, y, &packet, &lit[1]);
            size_t at = (size_t)y * job->view->width + x;
            if (job->receivers)
                job->receivers[at] = low | high << LANES;
            if (job->lit)
                job->lit[at] = lit[0] | lit[1] << LANES;
        }
}

void tracer_shadow_samples32(const struct tracer *t, const struct view *view, const struct light *light, struct job_pool *pool,
                             uint32_t *receivers, uint32_t *lit)
{
    struct shadow_job job = {.tracer = t,
                             .view = view,
                             .frame = ray_frame_make(view),
                             .light = light_frame_make(t->scene, light),
                             .receivers = receivers,
                             .lit = lit};
    job.offsets[0] = ray_offsets_make(&job.frame, view_samples32);
    job.offsets[1] = ray_offsets_make(&job.frame, view_samples32 + LANES);
    job_pool_for(pool, tile_count(view), sample_tile, &job);
}
