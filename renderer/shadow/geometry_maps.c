#include "shadow/geometry_maps.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "passes/gbuffer.h"
#include "scene/pixel.h"
#include "shadow/light_lanes.h"
#include "shadow/pixel_pass.h"

#define INLINE static inline __attribute__((always_inline))

enum { ROWS = 16, COLUMNS = 64 }; /* picture rows a job; worked on together: what they read of a map stays near */

bool geometry_maps_prepare(struct geometry_maps *g, const struct shadow_input *in, struct error *err)
{
    for (unsigned i = in->fit->map_count; i < g->count; i++)
        geometry_map_finish(&g->maps[i]);
    g->count = 0;
    for (unsigned i = 0; i < in->fit->map_count; i++) {
        if (!geometry_map_build(&g->maps[i], in->scene, &in->fit->maps[i], in->fit->casters, in->fit->caster_count, in->pool,
                                err))
            return false;
        g->count = i + 1;
        if (in->memory && geometry_maps_bytes(g) > in->memory)
            return error_set(err, ERROR_TRY_AGAIN, "memory", "geometry maps of %u x %u take more than the %zu MiB allowed",
                             in->fit->maps[i].width, in->fit->maps[i].width, in->memory >> 20);
    }
    return true;
}

void geometry_maps_finish(struct geometry_maps *g)
{
    for (unsigned i = 0; i < SHADOW_MAPS_MAX; i++)
        geometry_map_finish(&g->maps[i]);
    memset(g, 0, sizeof *g);
}

size_t geometry_maps_bytes(const struct geometry_maps *g)
{
    size_t sum = 0;
    for (unsigned i = 0; i < SHADOW_MAPS_MAX; i++)
        sum += geometry_map_bytes(&g->maps[i]);
    return sum;
}

enum geometry_verdict geometry_ask(const struct geometry_map *m, uint32_t id, const struct map_point *p, uint32_t *hint)
{
    id &= MAP_ID;
    if (id == p->id)
        return GEOMETRY_OWN;
    struct light_hit hit;
    if (!light_triangle_solid_hit(&m->mesh, light_mesh_part(&m->mesh, id, hint), id, p->x, p->y, &hit))
        return GEOMETRY_ELSEWHERE;
    return geometry_before(m, hit.n, p->n) ? GEOMETRY_BEFORE : GEOMETRY_BEHIND;
}

/* A map as the pixel loop sees it: relative to the camera's eye, single precision. */
struct placed_map {
    const struct geometry_map *map;
    float row[3][4];
    float scale_x, scale_y, offset_x, offset_y, far;
    bool orthographic;
};

struct resolve_job {
    const struct shadow_input *in;
    geometry_decide *decide;
    void *state;
    const uint32_t *ids;
    const struct pixel *surfaces;
    float *visibility;
    struct placed_map maps[SHADOW_MAPS_MAX];
    unsigned map_count;
    uint32_t width, top, bottom; /* the rows that hold surfaces */
    struct pixel_rays rays;
    struct pixel_light light;
};

static struct placed_map place_map(const struct geometry_map *m, struct dvec3 camera_eye)
{
    const struct view *v = &m->mesh.view;
    const struct dvec3 axes[3] = {v->right, v->up, v->forward};
    struct placed_map p = {.map = m,
                           .scale_x = (float)m->mesh.scale_x,
                           .scale_y = (float)m->mesh.scale_y,
                           .offset_x = (float)m->mesh.offset_x,
                           .offset_y = (float)m->mesh.offset_y,
                           .far = (float)v->far,
                           .orthographic = v->orthographic};
    for (int i = 0; i < 3; i++) {
        pixel_put(p.row[i], axes[i]);
        p.row[i][3] = (float)dvec3_dot(axes[i], dvec3_sub(camera_eye, v->eye));
    }
    return p;
}

/* Eight pixels of a row, and the points that are seen in them. */
struct run {
    lanes_float x, y, z; /* relative */
    lanes_int receives;  /* all bits, or none */
};

/* Depths and packed normals of eight pixels; pixels past the picture have depth 0. */
INLINE void load_pixels(const struct pixel *pixels, uint32_t count, lanes_float *depth, lanes_int *normal)
{
    struct pixel some[CONSERVATIVE_LANES];
    if (count < CONSERVATIVE_LANES) {
        memset(some, 0, sizeof some);
        memcpy(some, pixels, count * sizeof *some);
        pixels = some;
    }
    const lanes_int_loose *pairs = (const lanes_int_loose *)(const void *)pixels;
    lanes_int even = __builtin_shufflevector(pairs[0], pairs[1], 0, 1, 8, 9, 4, 5, 12, 13);
    lanes_int odd = __builtin_shufflevector(pairs[2], pairs[3], 0, 1, 8, 9, 4, 5, 12, 13);
    lanes_int normals = __builtin_shufflevector(even, odd, 0, 2, 8, 10, 4, 6, 12, 14);
    lanes_int depths = __builtin_shufflevector(even, odd, 1, 3, 9, 11, 5, 7, 13, 15);
    *normal = __builtin_shufflevector(normals, normals, 0, 4, 1, 5, 2, 6, 3, 7);
    *depth = (lanes_float)__builtin_shufflevector(depths, depths, 0, 4, 1, 5, 2, 6, 3, 7);
}

/* The same arithmetic as receiver_at() of shaders/receiver.glsl. False: nothing receives. */
INLINE bool find_receivers(const struct resolve_job *job, uint32_t x0, uint32_t y0, uint32_t count, struct run *run)
{
    lanes_float depth, p[3], v[3], x = LANES_COUNT + (float)x0, y = LANES_ALL((float)y0);
    lanes_int normal;
    load_pixels(job->surfaces + (size_t)y0 * job->width + x0, count, &depth, &normal);
    run->receives = depth > 0;
    if (!LANES_ANY(run->receives))
        return false;
    const struct pixel_rays *r = &job->rays;
    for (int k = 0; k < 3; k++) {
        p[k] = r->origin[k] + x * r->origin_dx[k] + y * r->origin_dy[k] +
               depth * (r->direction[k] + x * r->direction_dx[k] + y * r->direction_dy[k]);
        v[k] = job->light.kind == LIGHT_DIRECTIONAL ? LANES_ALL(job->light.light[k]) : job->light.light[k] - p[k];
    }
    lanes_float a = __builtin_convertvector((normal << 16) >> 16, lanes_float) / 32767;
    lanes_float b = __builtin_convertvector(normal >> 16, lanes_float) / 32767, none = {};
    lanes_float c = 1 - LANES_ABS(a) - LANES_ABS(b), t = LANES_IF(c < 0, -c, none);
    a += LANES_IF(a >= 0, -t, t);
    b += LANES_IF(b >= 0, -t, t);
    lanes_float facing = a * v[0] + b * v[1] + c * v[2], d2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    run->receives &= (facing > 0) & (d2 <= job->light.range2);
    if (job->light.kind == LIGHT_SPOT) {
        lanes_float along = -(v[0] * job->light.axis[0] + v[1] * job->light.axis[1] + v[2] * job->light.axis[2]);
        LANES_ROOT(d2);
        run->receives &= along >= job->light.cosine * d2;
    }
    run->x = p[0];
    run->y = p[1];
    run->z = p[2];
    return LANES_ANY(run->receives);
}

/* Where a run's receivers lie on a map. */
struct placed_run {
    float x[CONSERVATIVE_LANES], y[CONSERVATIVE_LANES], n[CONSERVATIVE_LANES];
} __attribute__((aligned(32)));

/* on: which lie on it. */
INLINE void put_on_map(const struct placed_map *m, const struct run *run, struct placed_run *out, lanes_int *on)
{
    lanes_float q[3], side = LANES_ALL((float)m->map->size);
    for (int k = 0; k < 3; k++)
        q[k] = m->row[k][0] * run->x + m->row[k][1] * run->y + m->row[k][2] * run->z + m->row[k][3];
    lanes_float w = m->orthographic ? LANES_ALL(1.0f) : 1 / q[2];
    lanes_float x = q[0] * w * m->scale_x + m->offset_x, y = q[1] * w * m->scale_y + m->offset_y;
    *(lanes_float *)out->n = m->orthographic ? m->far - q[2] : w;
    *(lanes_float *)out->x = x;
    *(lanes_float *)out->y = y;
    *on = (w > 0) & (x >= 0) & (y >= 0) & (x < side) & (y < side);
}

/* Those of `open` that the nearest depth of their texel does not tell to be lit. What deciding reads first is asked for while the others are
 * looked up. */
static unsigned find_doubtful(const struct geometry_map *m, const struct placed_run *placed, unsigned open,
                              size_t at[CONSERVATIVE_LANES])
{
    unsigned doubtful = 0;
    for (; open; open &= open - 1) {
        unsigned i = (unsigned)__builtin_ctz(open);
        at[i] = geometry_map_at(m, (uint32_t)placed->x[i], (uint32_t)placed->y[i]);
        if (at[i] == SIZE_MAX)
            continue;
        doubtful |= (unsigned)(placed->n[i] < m->cells[at[i]].nearest) << i;
    }
    for (unsigned left = doubtful; left; left &= left - 1)
        __builtin_prefetch(&m->notes[at[__builtin_ctz(left)]]);
    return doubtful;
}

/* The first map that holds a point answers for it; points on none are lit. */
static void resolve_on_map(const struct resolve_job *job, const struct geometry_map *m, const struct placed_run *placed,
                           size_t first, unsigned open, uint32_t *hint)
{
    size_t at[CONSERVATIVE_LANES];
    for (unsigned left = find_doubtful(m, placed, open, at); left; left &= left - 1) {
        unsigned i = (unsigned)__builtin_ctz(left);
        struct map_point p = {placed->x[i], placed->y[i], placed->n[i], job->ids[first + i], at[i]};
        if (!job->decide(job->state, m, &p, job->in->params, hint))
            job->visibility[first + i] = 0;
    }
}

INLINE void resolve_run(const struct resolve_job *job, uint32_t x, uint32_t y, uint32_t *hint)
{
    size_t first = (size_t)y * job->width + x;
    uint32_t count = job->width - x < CONSERVATIVE_LANES ? job->width - x : CONSERVATIVE_LANES;
    struct run run;
    struct placed_run placed;
    if (!find_receivers(job, x, y, count, &run)) {
        memset(job->visibility + first, 0, count * sizeof *job->visibility);
        return;
    }
    lanes_float values = (lanes_float)(run.receives & (lanes_int)LANES_ALL(1.0f));
    memcpy(job->visibility + first, &values, count * sizeof *job->visibility);
    for (unsigned i = 0; i < job->map_count; i++) {
        lanes_int on;
        put_on_map(&job->maps[i], &run, &placed, &on);
        on &= run.receives;
        unsigned open = LANES_BITS(on);
        run.receives &= ~on;
        resolve_on_map(job, job->maps[i].map, &placed, first, open, hint);
    }
}

INLINE void resolve_rows_inline(const struct resolve_job *job, size_t index)
{
    uint32_t top = job->top + (uint32_t)index * ROWS, bottom = top + ROWS < job->bottom ? top + ROWS : job->bottom, hint = 0;
    for (uint32_t left = 0; left < job->width; left += COLUMNS)
        for (uint32_t y = top; y < bottom; y++)
            for (uint32_t x = left; x < left + COLUMNS && x < job->width; x += CONSERVATIVE_LANES)
                resolve_run(job, x, y, &hint);
}

#ifdef __x86_64__
/* The same arithmetic in wider vectors (no contraction), so the same bits. */
__attribute__((target("avx2"))) static void resolve_rows_avx2(const struct resolve_job *job, size_t index)
{
    resolve_rows_inline(job, index);
}
#endif

static void resolve_rows(void *context, size_t index, unsigned worker)
{
    (void)worker;
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        resolve_rows_avx2(context, index);
        return;
    }
#endif
    resolve_rows_inline(context, index);
}

bool geometry_maps_resolve(struct geometry_maps *g, const struct shadow_input *in, geometry_decide *decide, void *state,
                           struct error *err)
{
    struct resolve_job job = {.in = in,
                              .decide = decide,
                              .state = state,
                              .visibility = pixel_values(in, err),
                              .map_count = g->count,
                              .width = in->view->width,
                              .top = in->gbuffer->tiles.top,
                              .bottom = in->gbuffer->tiles.bottom};
    job.ids = gbuffer_read_ids(in->gbuffer, in->gl, err);
    job.surfaces = job.ids ? gbuffer_read_pixels(in->gbuffer, in->draw, err) : NULL;
    if (!job.surfaces || !job.visibility)
        return false;
    for (unsigned i = 0; i < g->count; i++)
        job.maps[i] = place_map(&g->maps[i], in->view->eye);
    job.rays = pixel_rays_of(in->view);
    job.light = pixel_light_of(in->light, in->view->eye);
    if (job.top < job.bottom)
        job_pool_for(in->pool, (job.bottom - job.top + ROWS - 1) / ROWS, resolve_rows, &job);
    return pixel_upload(in, job.visibility, err);
}
