/* The options that serve, render, compare and batch share. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "cameras.h"
#include "options.h"
#include "renderer.h"

enum { THREADS_MAX = 256, FRAMES_TIMED_MAX = 100000, MEMORY_MAX_MIB = 1 << 20, COMMON_OPTIONS_MAX = 40 };

/* Strings are borrowed from argv. */
struct common_options {
    uint32_t width, height;
    struct camera_choice camera;
    bool camera_named, eye_given, target_given, up_given, fov_given, ortho_given;
    struct light lights[RENDERER_LIGHTS_MAX];     /* world; none: the scene's */
    const char *light_texts[RENDERER_LIGHTS_MAX]; /* as written */
    size_t light_count;
    const struct shadow_system *system; /* NULL: the renderer's default */
    struct shadow_params params;
    enum show show;
    bool difference; /* instead: how far visibility is from the reference's */
    bool exposure_auto;
    double exposure_ev;
    double ambient;
    enum tonemap tonemap;
    unsigned aa;
    enum camera_pass camera_pass;
    unsigned frames_timed; /* 0: not given */
    bool moving;
    unsigned threads;       /* >= 1 */
    size_t memory;          /* bytes; 0: no limit */
    const char *device;     /* NULL: first that works */
    const char *shader_dir; /* NULL: the built-in ones */
    bool quiet;
    const char
        *given[COMMON_OPTIONS_MAX]; /* text of each option of the table that was given ("" where it takes none), else NULL */
};

extern const struct option common_option_table[];

/* "shaded", "visibility", ... in the order of enum show; ended by NULL. The others likewise. */
extern const char *const show_names[];
extern const char *const tonemap_names[];
extern const char *const camera_pass_names[];

void common_options_init(struct common_options *options);

/* The parser notes what was given. */
void common_options_note(struct common_options *options, const struct option *option, const char *value);
/* The text of an option, "" where it takes none; NULL when it was not given. */
const char *common_options_given(const struct common_options *options, const char *name);

/* What depends on several options; options_parse() calls it. */
bool common_options_check(struct common_options *options, struct error *err);

/* Everything that a frame of `scene` needs, lights and camera in scene space. */
bool common_options_settings(const struct common_options *options, const struct scene *scene, struct render_settings *out,
                             struct error *err);

/* What renderer_create() wants. */
struct renderer_options common_options_renderer(const struct common_options *options);

/* SLURM_CPUS_PER_TASK, else the cores this process may run on; 1..THREADS_MAX. */
unsigned threads_allowed(void);
