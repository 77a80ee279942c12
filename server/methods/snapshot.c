#include <stdlib.h>

#include "base/error.h"
#include "clock.h"
#include "methods/methods.h"
#include "server.h"
#include "wire.h"

#define SNAPSHOT_QUALITY_DEFAULT 90
#define WEBP_SIDE_MAX            16383

static bool apply_size(struct render_settings *settings, const double size[2], enum gnmf_codec codec, struct error *err)
{
    uint32_t side = codec == GNMF_WEBP ? WEBP_SIDE_MAX : RENDERER_SIZE_MAX;
    settings->width = (uint32_t)size[0];
    settings->height = (uint32_t)size[1];
    if (settings->width != size[0] || settings->height != size[1] || settings->width > side || settings->height > side ||
        (uint64_t)settings->width * settings->height > SERVER_SNAPSHOT_PIXELS_MAX)
        return error_set(err, ERROR_USAGE, "size",
                         "size: %g x %g; whole numbers of 1 to %u pixels a side and at most %u together are accepted", size[0],
                         size[1], side, SERVER_SNAPSHOT_PIXELS_MAX);
    return true;
}

static bool apply_picture(const struct scene *scene, const struct params *p, struct given given, struct render_settings *settings,
                          struct error *err)
{
    if (is_given(given, PARAM_LIGHTS) && !wire_read_lights(scene, p->lights, settings, err))
        return false;
    if (is_given(given, PARAM_ALGORITHM) && !shadow_parse(p->algorithm, &settings->system, &settings->params, err))
        return false;
    if (is_given(given, PARAM_EXPOSURE) && !wire_read_exposure(p->exposure, settings, err))
        return false;
    if (p->time > 0)
        return error_set(err, ERROR_USAGE, "time", "time: animations are not built yet; 0 is accepted");
    if (is_given(given, PARAM_SHOW))
        settings->show = (enum show)p->show;
    if (is_given(given, PARAM_AMBIENT))
        settings->ambient = p->ambient;
    if (is_given(given, PARAM_TONEMAP))
        settings->tonemap = (enum tonemap)p->tonemap;
    if (is_given(given, PARAM_AA))
        settings->aa = (unsigned)p->aa;
    return true;
}

static bool fill(const struct server *server, const struct scene *scene, const struct params *p, struct given given,
                 struct snapshot *snapshot, struct error *err)
{
    struct common_options options = *server->defaults;
    char name[WIRE_CAMERA_NAME_MAX];
    struct error unfit = {0};
    struct render_settings *settings = &snapshot->settings;
    if (!common_options_settings(&options, scene, settings, &unfit)) {
        options.camera = camera_choice_default();
        if (!common_options_settings(&options, scene, settings, err))
            return false;
    }
    snapshot->codec = is_given(given, PARAM_FORMAT) ? (enum gnmf_codec)p->format : GNMF_PNG;
    snapshot->quality = is_given(given, PARAM_QUALITY) ? (int)p->quality : SNAPSHOT_QUALITY_DEFAULT;
    settings->format = snapshot->codec == GNMF_EXR ? PIXELS_RGBA32F : PIXELS_RGBA8;
    if (is_given(given, PARAM_SIZE) && !apply_size(settings, p->size, snapshot->codec, err))
        return false;
    if (is_given(given, PARAM_CAMERA) && !wire_read_camera(p->camera, &options.camera, name, err))
        return false;
    return camera_choose(scene, &options.camera, (double)settings->width / settings->height, &settings->camera, err) &&
           apply_picture(scene, p, given, settings, err);
}

static enum outcome start(struct server *server, struct call *call, struct scene_entry *scene, const struct params *p,
                          struct given given, struct error *err)
{
    struct snapshot *snapshot = calloc(1, sizeof *snapshot);
    if (!snapshot) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for another picture");
        return OUTCOME_FAILED;
    }
    snapshot->scene = scene_entry_ref(scene);
    snapshot->session = call->session;
    snapshot->request_id = (uint32_t)p->request_id;
    snapshot->deadline_us = p->deadline_ms ? clock_us() + p->deadline_ms * 1000 : 0;
    bool ok = fill(server, scene->scene, p, given, snapshot, err);
    if (ok && !render_loop_snapshot(server->loop, snapshot))
        ok = error_set(err, ERROR_TRY_AGAIN, NULL, "%d pictures are waiting to be rendered; try again later",
                       RENDER_LOOP_SNAPSHOTS);
    if (ok) {
        call->snapshot = snapshot;
        atomic_fetch_add(&server->metrics.snapshots, 1);
        return OUTCOME_LATER;
    }
    scene_entry_unref(snapshot->scene);
    free(snapshot);
    return OUTCOME_FAILED;
}

enum outcome method_render_snapshot(struct server *server, struct call *call, const struct params *p, struct given given,
                                    json_t **result, struct error *err)
{
    struct scene_entry *scene;
    (void)result;
    enum outcome outcome = dispatch_scene(server, call, p->scene, &scene, err);
    if (outcome != OUTCOME_DONE)
        return outcome;
    outcome = start(server, call, scene, p, given, err);
    scene_entry_unref(scene);
    return outcome;
}
