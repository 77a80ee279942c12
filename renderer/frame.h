/* A renderer and one frame of it: private to renderer.c, render_scene.c and frame.c. */
#pragma once

#include "gl/context.h"
#include "gl/readback.h"
#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/gbuffer.h"
#include "passes/lighting.h"
#include "passes/visibility.h"
#include "renderer.h"

struct render_scene;

struct in_flight {
    struct frame_info info;
    double start_ms;    /* clock at renderer_submit() */
    unsigned timer_age; /* frames submitted since */
    bool finish_each_pass;
};

struct renderer {
    struct gl_context gl;
    struct gl_programs *programs;
    struct job_pool *pool;
    unsigned threads;
    struct gl_timer timer;
    struct gl_readback readback;
    struct gbuffer gbuffer;
    struct visibility visibility;
    struct gl_buffer light_block, params_block;
    struct lighting lighting;
    struct in_flight frames[RENDERER_IN_FLIGHT];
    unsigned first, count; /* oldest in flight, how many */
    double reload_checked_ms;
};

/* All passes up to the picture, which is left bound as the framebuffer. Fills info but for frame_ms and the read-back. */
bool frame_render(struct renderer *r, struct render_scene *s, const struct render_settings *settings, struct frame_info *info,
                  struct error *err);
