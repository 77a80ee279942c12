#include "stage.h"

#include <stdlib.h>

#include "base/job_pool.h"
#include "common_options.h"
#include "progress.h"

static bool set_up(struct stage *stage, const char *scene, const struct common_options *options, struct error *err)
{
    stage->scene = scene_load(scene, err);
    if (!stage->scene || !common_options_settings(options, stage->scene, &stage->settings, err))
        return false;
    stage->pool = job_pool_create(options->threads, err);
    if (!stage->pool)
        return false;
    struct renderer_options wanted = common_options_renderer(options);
    stage->renderer = renderer_create(&wanted, stage->pool, err);
    if (!stage->renderer)
        return false;
    stage->uploaded = render_scene_create(stage->renderer, stage->scene, err);
    return stage->uploaded != NULL;
}

bool stage_init(struct stage *stage, const char *scene, const struct common_options *options, struct error *err)
{
    struct progress progress;
    *stage = (struct stage){0};
    progress_init(&progress, "loading", options->quiet);
    bool good = set_up(stage, scene, options, err);
    progress_finish(&progress);
    return good;
}

void stage_finish(struct stage *stage)
{
    render_scene_destroy(stage->uploaded);
    renderer_destroy(stage->renderer);
    job_pool_destroy(stage->pool);
    scene_destroy(stage->scene);
    *stage = (struct stage){0};
}

size_t stage_picture_bytes(const struct render_settings *settings)
{
    return (size_t)settings->width * settings->height * (settings->format == PIXELS_RGBA8 ? 4 : 16);
}

void *stage_picture(const struct render_settings *settings, struct error *err)
{
    void *pixels = malloc(stage_picture_bytes(settings));
    if (!pixels)
        error_set(err, ERROR_TRY_AGAIN, "size", "memory is out for a picture of %ux%u; a smaller --size is accepted",
                  settings->width, settings->height);
    return pixels;
}

bool stage_frame(struct stage *stage, const struct render_settings *settings, void *pixels, struct frame_info *info,
                 struct error *err)
{
    if (stage->before_frame && !stage->before_frame(stage->context, err))
        return false;
    if (!renderer_submit(stage->renderer, stage->uploaded, settings, 0, err))
        return false;
    if (renderer_collect(stage->renderer, true, pixels, stage_picture_bytes(settings), info, err))
        return true;
    return error_set(err, ERROR_BUG, NULL, "the frame was lost without a reason; please report this");
}

bool stage_converge(struct stage *stage, const struct render_settings *settings, void *pixels, struct frame_info *info,
                    unsigned *frames, struct error *err)
{
    unsigned done = 0;
    do {
        if (!stage_frame(stage, settings, pixels, info, err))
            return false;
        done++;
    } while (!info->converged && done < STAGE_CONVERGE_MAX);
    if (frames)
        *frames = done;
    return true;
}
