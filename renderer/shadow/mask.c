/* Shadows with supersampled boundaries by a shadow-mask table: after a patent filing of Zhejiang University (Wang, Hua, Bao). What its text leaves
 * open, and what one facet a pixel cannot do: docs/filtered.md.
 *
 * Silhouettes, lists and pixels on the CPU, on the job pool: a software rasterizer runs a shader's longest branch for every pixel, and few
 * pixels lie on the contour. */
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
#include "shadow/depth/light_maps.h"
#include "shadow/mask/mask_facet.h"
#include "shadow/pixel_pass.h"
#include "shadow/shared_params.h"

enum { PARAM_BIAS = SHADOW_PARAM_FIT + 1, PARAM_SLOPE };
enum { ROWS = 8 }; /* picture rows a job */

/* slope: a plane leaves a texel's centre by at most half a texel along both axes, 0.71 of a texel. */
static const struct param_desc params[] = {SHADOW_MAP_PARAMS, SHADOW_BIAS_PARAMS(0.00075, 1)};

/* Faces need no bias against a texel's grain, only against their neighbours of the receiver, whose planes the facet leaves: less of it where
 * light grazes. */
static const float FACE_TANGENT = 2;

struct mask {
    struct mask_table table;
    struct light_maps maps;
    struct adjacency adjacency;
    struct mask_contour contours[SHADOW_MAPS_MAX];
    unsigned count;
    float *visibility; /* of the last picture; masks likewise */
    uint32_t *receivers, *lit;
    size_t pixel_room, pixels;
    struct mask_counts counts;
};

/* One picture at work. */
struct resolve_job {
    struct mask *state;
    struct mask_map maps[SHADOW_MAPS_MAX];
    const uint32_t *ids;
    const struct pixel *surfaces;
    uint32_t width, height;
    bool orthographic; /* the camera */
    struct pixel_rays rays;
    struct pixel_light light;
    float bias, slope;
    struct mask_counts *counts; /* a worker */
};

static bool out_of_memory(struct error *err) { return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for shadow masks"); }

static bool init(void *state, const struct shadow_input *in, struct error *err)
{
    struct mask *s = state;
    mask_table_fill(&s->table);
    return adjacency_init(&s->adjacency, in->scene, err);
}

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    struct mask *s = state;
    for (unsigned i = in->fit->map_count; i < s->count; i++)
        mask_contour_finish(&s->contours[i]);
    s->count = 0;
    if (!light_maps_prepare_on_cpu(&s->maps, in, err))
        return false;
    for (unsigned i = 0; i < in->fit->map_count; i++) {
        if (!mask_contour_build(&s->contours[i], in->scene, &s->adjacency, &in->fit->maps[i], in->fit->casters,
                                in->fit->caster_count, in->memory, in->pool, err))
            return false;
        s->count = i + 1;
    }
    return true;
}

static struct mask_map place_map(const struct mask *s, unsigned i, struct dvec3 camera_eye)
{
    const struct mask_contour *c = &s->contours[i];
    const struct view *v = &c->mesh.view;
    const struct dvec3 axes[3] = {v->right, v->up, v->forward};
    struct mask_map m = {.contour = c,
                         .depths = s->maps.texels + (size_t)i * c->size * c->size,
                         .scale_x = (float)c->mesh.scale_x,
                         .scale_y = (float)c->mesh.scale_y,
                         .offset_x = (float)c->mesh.offset_x,
                         .offset_y = (float)c->mesh.offset_y,
                         .near = (float)v->near,
                         .far = (float)v->far,
                         .texel = (float)fmax(1 / fabs(c->mesh.scale_x), 1 / fabs(c->mesh.scale_y)),
                         .orthographic = v->orthographic};
    for (int k = 0; k < 3; k++) {
        pixel_put(m.row[k], axes[k]);
        m.row[k][3] = (float)dvec3_dot(axes[k], dvec3_sub(camera_eye, v->eye));
    }
    return m;
}

static inline float dot3(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A pixel's receiver, relative to the camera's eye. */
struct receiver {
    float point[3], direction[3], depth; /* of its ray */
    float normal[3], to_light[3];        /* unit */
    float cosine;                        /* of the angle of incidence */
};

/* As receiver_at() of shaders/receiver.glsl. */
static bool find_receiver(const struct resolve_job *job, uint32_t x, uint32_t y, struct receiver *r)
{
    const struct pixel *surface = &job->surfaces[(size_t)y * job->width + x];
    float fx = (float)x, fy = (float)y, v[3];
    r->depth = surface->depth;
    if (!(r->depth > 0))
        return false;
    for (int k = 0; k < 3; k++) {
        r->direction[k] = job->rays.direction[k] + fx * job->rays.direction_dx[k] + fy * job->rays.direction_dy[k];
        r->point[k] =
            job->rays.origin[k] + fx * job->rays.origin_dx[k] + fy * job->rays.origin_dy[k] + r->depth * r->direction[k];
        v[k] = job->light.kind == LIGHT_DIRECTIONAL ? job->light.light[k] : job->light.light[k] - r->point[k];
    }
    pixel_geometric(surface, r->normal);
    float facing = dot3(r->normal, v), d2 = dot3(v, v), scale = 1 / sqrtf(d2);
    if (!(facing > 0) || !(d2 <= job->light.range2))
        return false;
    for (int k = 0; k < 3; k++)
        r->to_light[k] = v[k] * scale;
    r->cosine = facing * scale;
    return job->light.kind != LIGHT_SPOT || -dot3(r->to_light, job->light.axis) >= job->light.cosine;
}

static void turn(const struct mask_map *m, const float v[3], float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = dot3(m->row[k], v);
}

/* False: the point lies outside the map. */
static bool put_on_map(const struct mask_map *m, const float p[3], float q[3])
{
    for (int k = 0; k < 3; k++)
        q[k] = dot3(m->row[k], p) + m->row[k][3];
    float w = m->orthographic ? 1 : 1 / q[2], side = (float)m->contour->size;
    float x = q[0] * w * m->scale_x + m->offset_x, y = q[1] * w * m->scale_y + m->offset_y;
    return w > 0 && x >= 0 && y >= 0 && x < side && y < side;
}

/* The facet's derivatives: in perspective P = t d, t = D / (N . d), so dP = t (d' - d N . d' / N . d), and N . d changes by N . d'. */
static void make_facet(const struct resolve_job *job, const struct mask_map *m, const struct receiver *r, uint32_t id,
                       struct mask_facet *f)
{
    float along = dot3(r->normal, r->direction), step[2][3], change[2];
    const float *steps[2] = {job->orthographic ? job->rays.origin_dx : job->rays.direction_dx,
                             job->orthographic ? job->rays.origin_dy : job->rays.direction_dy};
    for (int i = 0; i < 2; i++) {
        change[i] = dot3(r->normal, steps[i]) / along;
        for (int k = 0; k < 3; k++)
            step[i][k] = (job->orthographic ? 1 : r->depth) * (steps[i][k] - r->direction[k] * change[i]);
    }
    const float away[3] = {-r->normal[0], -r->normal[1], -r->normal[2]};
    turn(m, away, f->normal);
    turn(m, step[0], f->dx);
    turn(m, step[1], f->dy);
    turn(m, r->to_light, f->to_light);
    f->kx = job->orthographic ? 0 : change[0];
    f->ky = job->orthographic ? 0 : change[1];
    float tangent = sqrtf(fmaxf(1 / (r->cosine * r->cosine) - 1, 0)), texel = m->texel * (m->orthographic ? 1 : f->point[2]);
    f->bias = job->bias + job->slope * texel * tangent;
    f->face_bias = job->bias + job->slope * texel * fminf(tangent, FACE_TANGENT);
    f->id = id;
}

static void resolve_pixel(struct resolve_job *job, uint32_t x, uint32_t y, struct mask_counts *counts)
{
    struct mask *s = job->state;
    size_t i = (size_t)y * job->width + x;
    struct receiver r;
    struct mask_facet facet;
    s->receivers[i] = find_receiver(job, x, y, &r) ? UINT32_MAX : 0;
    uint32_t dark = 0;
    for (unsigned k = 0; s->receivers[i] && k < s->count; k++)
        if (put_on_map(&job->maps[k], r.point, facet.point)) {
            make_facet(job, &job->maps[k], &r, job->ids[i], &facet);
            dark = mask_facet_shadow(&s->table, &job->maps[k], &facet, counts);
            break;
        }
    s->lit[i] = s->receivers[i] & ~dark;
    s->visibility[i] = (float)__builtin_popcount(s->lit[i]) * (1.0f / 32);
}

static void resolve_rows(void *context, size_t index, unsigned worker)
{
    struct resolve_job *job = context;
    uint32_t end = ((uint32_t)index + 1) * ROWS < job->height ? ((uint32_t)index + 1) * ROWS : job->height;
    for (uint32_t y = (uint32_t)index * ROWS; y < end; y++)
        for (uint32_t x = 0; x < job->width; x++)
            resolve_pixel(job, x, y, &job->counts[worker]);
}

static bool reserve(struct mask *s, size_t pixels, struct error *err)
{
    s->pixels = pixels;
    if (s->pixel_room >= pixels)
        return true;
    free(s->visibility);
    free(s->receivers);
    free(s->lit);
    s->visibility = malloc(pixels * sizeof *s->visibility);
    s->receivers = malloc(pixels * sizeof *s->receivers);
    s->lit = malloc(pixels * sizeof *s->lit);
    s->pixel_room = s->visibility && s->receivers && s->lit ? pixels : 0;
    s->pixels = s->pixel_room ? pixels : 0;
    return s->pixel_room || out_of_memory(err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    struct mask *s = state;
    struct resolve_job job = {.state = s,
                              .width = in->view->width,
                              .height = in->view->height,
                              .bias = (float)in->params[PARAM_BIAS],
                              .slope = (float)in->params[PARAM_SLOPE]};
    unsigned workers = job_pool_threads(in->pool);
    if (!reserve(s, (size_t)job.width * job.height, err))
        return false;
    job.ids = gbuffer_read_ids(in->gbuffer, in->gl, err);
    job.surfaces = job.ids ? gbuffer_read_pixels(in->gbuffer, in->draw, err) : NULL;
    if (!job.surfaces)
        return false;
    job.counts = calloc(workers, sizeof *job.counts);
    if (!job.counts)
        return out_of_memory(err);
    for (unsigned i = 0; i < s->count; i++)
        job.maps[i] = place_map(s, i, in->view->eye);
    job.orthographic = in->view->orthographic;
    job.rays = pixel_rays_of(in->view);
    job.light = pixel_light_of(in->light, in->view->eye);
    job_pool_for(in->pool, (job.height + ROWS - 1) / ROWS, resolve_rows, &job);
    s->counts = (struct mask_counts){0};
    for (unsigned i = 0; i < workers; i++) {
        s->counts.receivers += job.counts[i].receivers;
        s->counts.contour += job.counts[i].contour;
        s->counts.faces += job.counts[i].faces;
    }
    free(job.counts);
    return pixel_upload(in, s->visibility, err);
}

static bool read_masks(void *state, const struct shadow_input *in, uint32_t *receivers, uint32_t *lit, struct error *err)
{
    const struct mask *s = state;
    size_t pixels = (size_t)in->view->width * in->view->height;
    if (s->pixels != pixels)
        return error_set(err, ERROR_BUG, NULL, "masks of a picture that was not resolved were asked for");
    memcpy(receivers, s->receivers, pixels * sizeof *receivers);
    memcpy(lit, s->lit, pixels * sizeof *lit);
    return true;
}

static size_t figures(const void *state, struct shadow_figure *out)
{
    const struct mask *s = state;
    double texels = 0, entries = 0, faces = 0, pixels = (double)s->counts.receivers, contour = (double)s->counts.contour;
    for (unsigned i = 0; i < s->count; i++) {
        texels += (double)s->contours[i].crossed_count;
        entries += (double)s->contours[i].entry_count;
        faces += (double)s->contours[i].face_count;
    }
    size_t n = 0;
    out[n++] = (struct shadow_figure){"table_bits_wrong_fraction", s->table.wrong};
    out[n++] = (struct shadow_figure){"contour_texels", texels};
    out[n++] = (struct shadow_figure){"list_entries", entries};
    out[n++] = (struct shadow_figure){"list_faces", faces};
    out[n++] = (struct shadow_figure){"contour_pixels_fraction", pixels > 0 ? contour / pixels : 0};
    out[n++] = (struct shadow_figure){"faces_per_contour_pixel", contour > 0 ? (double)s->counts.faces / contour : 0};
    return n;
}

static void finish(void *state)
{
    struct mask *s = state;
    light_maps_finish(&s->maps);
    adjacency_finish(&s->adjacency);
    for (unsigned i = 0; i < SHADOW_MAPS_MAX; i++)
        mask_contour_finish(&s->contours[i]);
    free(s->visibility);
    free(s->receivers);
    free(s->lit);
}

static size_t bytes(const void *state)
{
    const struct mask *s = state;
    size_t sum =
        sizeof s->table.bits + light_maps_bytes(&s->maps) + s->adjacency.count * sizeof *s->adjacency.across + s->pixel_room * 12;
    for (unsigned i = 0; i < s->count; i++)
        sum += s->contours[i].bytes;
    return sum;
}

const struct shadow_system shadow_mask = {
    .name = "mask",
    .title = "Shadow-mask table",
    .help = "Depth map; on its contour the faces listed there, as masks of the pixel's 32 samples from a table of half-planes.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_MAPS | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct mask),
    .init = init,
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
    .read_masks = read_masks,
    .figures = figures,
};
