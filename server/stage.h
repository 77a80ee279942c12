/* A scene set up on a device, ready for frames: what render and compare work on. Belongs to the thread that made it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "renderer.h"

struct common_options;
struct job_pool;

struct stage {
    struct scene *scene;
    struct render_settings settings; /* as the options say */
    struct job_pool *pool;
    struct renderer *renderer;
    struct render_scene *uploaded;
    bool (*before_frame)(void *context, struct error *err); /* stage_frame() calls it first; NULL: nothing to do. False stops */
    void *context;
};

/* Loads SCENE, then sets up the device: what is wrong with the scene or the options is told before a device is looked for. The caller
 * finishes it, whatever this returns. */
bool stage_init(struct stage *stage, const char *scene, const struct common_options *options, struct error *err);
void stage_finish(struct stage *stage);

/* Bytes of a picture of these settings. */
size_t stage_picture_bytes(const struct render_settings *settings);
/* Memory for one; ERROR_TRY_AGAIN when there is none. The caller frees. */
void *stage_picture(const struct render_settings *settings, struct error *err);

/* One frame, nothing else in flight; `pixels` holds stage_picture_bytes(). */
bool stage_frame(struct stage *stage, const struct render_settings *settings, void *pixels, struct frame_info *info,
                 struct error *err);

/* Frames of the same view until another would change nothing (of most systems: one), at most STAGE_CONVERGE_MAX. Tells the last in *info,
 * whose `converged` is false if the cap came first, and how many there were in *frames (may be NULL). */
bool stage_converge(struct stage *stage, const struct render_settings *settings, void *pixels, struct frame_info *info,
                    unsigned *frames, struct error *err);
enum { STAGE_CONVERGE_MAX = 512 };
