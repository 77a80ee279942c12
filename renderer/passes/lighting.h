/* The last passes: light times visibility, summed over the lights; tone map; the mean over samples. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "gl/buffer.h"
#include "gl/texture.h"
#include "scene/scene.h"

struct draw_scene;
struct error;
struct gbuffer;
struct job_pool;
struct visibility;

/* As in renderer.h (checked there). */
enum lighting_show { LIGHTING_SHADED, LIGHTING_VISIBILITY, LIGHTING_DEPTH, LIGHTING_NORMAL, LIGHTING_ID };
enum lighting_display { LIGHTING_LINEAR, LIGHTING_SRGB, LIGHTING_ACES };

struct lighting_input {
    struct draw_scene *scene;
    struct gbuffer *gbuffer;
    struct visibility *visibility; /* a layer a light */
    struct job_pool *pool;
    const struct light *lights;
    size_t light_count;
    enum lighting_show show;
    enum lighting_display display;
    double exposure;  /* picture = radiance * exposure */
    double ambient;   /* radiance reflected by white */
    unsigned aa_side; /* samples a side: 1, 2, 4; the gbuffer is that much larger than the result */
};

struct lighting {
    struct gl_buffer block;
    struct gl_texture samples; /* at the gbuffer's size, RGBA16F, or RGBA32F if display is linear; aa_side > 1 only */
    struct gl_texture result;
    struct gl_target target; /* bound, with `result`, when lighting_run() returns */
    uint32_t *picture;       /* `result` as made on the CPU */
    size_t room;             /* its pixels */
};

/* True if the CPU can do it (lighting_pixels.h); it does, where the visibility is kept there. */
bool lighting_fits_cpu(const struct lighting_input *in);

/* Writes `result`: RGBA32F if display is linear, else RGBA8. */
bool lighting_run(struct lighting *l, const struct lighting_input *in, struct error *err);
void lighting_finish(struct lighting *l);

/* Illuminance at the scene's centre, all lights facing it (lux): what auto exposure and ambient light go by. */
double lighting_illuminance(const struct scene *scene, const struct light *lights, size_t light_count);
