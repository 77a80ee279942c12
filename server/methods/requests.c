#include <stdlib.h>

#include "base/error.h"
#include "clock.h"
#include "methods/methods.h"
#include "pending.h"
#include "server.h"
#include "wire.h"

#define SNAPSHOT_QUALITY_DEFAULT 90
#define WEBP_SIDE_MAX            16383

static bool apply_size(struct render_settings *settings, const double size[2], const struct render_request *request,
                       struct error *err)
{
    uint32_t most = request->compare ? SERVER_COMPARE_PIXELS_MAX : SERVER_SNAPSHOT_PIXELS_MAX;
    uint32_t side = request->codec == GNMF_WEBP ? WEBP_SIDE_MAX : RENDERER_SIZE_MAX;
    settings->width = (uint32_t)size[0];
    settings->height = (uint32_t)size[1];
    if (settings->width != size[0] || settings->height != size[1] || settings->width > side || settings->height > side ||
        (uint64_t)settings->width * settings->height > most)
        return error_set(err, ERROR_USAGE, "size",
                         "size: %g x %g; whole numbers of 1 to %u pixels a side and at most %u together are accepted", size[0],
                         size[1], side, most);
    return true;
}

static bool apply_picture(const struct scene *scene, const struct params *p, struct given given, struct render_settings *settings,
                          struct error *err)
{
    if (is_given(given, PARAM_LIGHTS) && !wire_read_lights(scene, p->lights, settings, err))
        return false;
    if (is_given(given, PARAM_ALGORITHM) && !wire_read_algorithm(p->algorithm, settings, err))
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
    if (is_given(given, PARAM_CAMERA_PASS))
        settings->camera_pass = (enum camera_pass)p->camera_pass;
    return true;
}

static bool fill(const struct server *server, const struct scene *scene, const struct params *p, struct given given,
                 struct render_request *request, struct error *err)
{
    struct common_options options = *server->defaults;
    char name[WIRE_CAMERA_NAME_MAX];
    struct error unfit = {0};
    struct render_settings *settings = &request->settings;
    if (!common_options_settings(&options, scene, settings, &unfit)) {
        options.camera = camera_choice_default();
        if (!common_options_settings(&options, scene, settings, err))
            return false;
    }
    request->quality = is_given(given, PARAM_QUALITY) ? (int)p->quality : SNAPSHOT_QUALITY_DEFAULT;
    settings->format = request->codec == GNMF_EXR ? PIXELS_RGBA32F : PIXELS_RGBA8;
    if (is_given(given, PARAM_SIZE) && !apply_size(settings, p->size, request, err))
        return false;
    if (is_given(given, PARAM_CAMERA) && !wire_read_camera(p->camera, &options.camera, name, err))
        return false;
    return camera_choose(scene, &options.camera, (double)settings->width / settings->height, &settings->camera, err) &&
           apply_picture(scene, p, given, settings, err);
}

static void wake(void *context) { net_wake(((struct server *)context)->net); }

static struct render_request *make(struct server *server, const struct call *call, struct scene_entry *scene,
                                   const struct params *p, struct error *err)
{
    struct render_request *request = render_request_create(scene);
    if (!request) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for another picture");
        return NULL;
    }
    request->session = call->session;
    request->request_id = (uint32_t)p->request_id;
    request->deadline_us = p->deadline_ms ? clock_us() + p->deadline_ms * 1000 : 0;
    request->told = wake;
    request->context = server;
    return request;
}

/* Hands the request to the render thread, where `ok`; else frees it. */
static enum outcome submit(struct server *server, struct call *call, struct render_request *request, bool ok, struct error *err)
{
    if (ok && !render_loop_request(server->loop, request))
        ok = error_set(err, ERROR_TRY_AGAIN, NULL, "%d such requests wait for their turn; try again later",
                       request->compare ? RENDER_LOOP_COMPARES : RENDER_LOOP_SNAPSHOTS);
    if (ok) {
        call->request = request;
        atomic_fetch_add(&server->metrics.snapshots, 1);
        return OUTCOME_LATER;
    }
    render_request_destroy(request);
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
    struct render_request *request = make(server, call, scene, p, err);
    scene_entry_unref(scene);
    if (!request)
        return OUTCOME_FAILED;
    request->codec = is_given(given, PARAM_FORMAT) ? (enum gnmf_codec)p->format : GNMF_PNG;
    return submit(server, call, request, fill(server, request->scene->scene, p, given, request, err), err);
}

/* "--algorithm" of the command line is what a comparison takes by default, as `gnomon compare` would. */
static bool fill_compare(struct server *server, const struct params *p, struct given given, struct render_request *request,
                         struct error *err)
{
    request->compare = true;
    request->difference = is_given(given, PARAM_DIFFERENCE);
    request->codec = request->difference ? (enum gnmf_codec)p->difference : GNMF_PNG;
    request->frames = is_given(given, PARAM_FRAMES) ? (unsigned)p->frames : 1;
    request->moving = p->moving;
    if (!against_parse(is_given(given, PARAM_AGAINST) ? p->against : "point", &request->against, err) ||
        !fill(server, request->scene->scene, p, given, request, err))
        return false;
    request->settings.format = PIXELS_RGBA8;
    uint64_t pixels = (uint64_t)request->settings.width * request->settings.height;
    return pixels <= SERVER_COMPARE_PIXELS_MAX ||
           error_set(err, ERROR_USAGE, "size", "size: too many pixels to compare; at most %u are accepted",
                     SERVER_COMPARE_PIXELS_MAX);
}

enum outcome method_compare_run(struct server *server, struct call *call, const struct params *p, struct given given,
                                json_t **result, struct error *err)
{
    struct scene_entry *scene;
    (void)result;
    enum outcome outcome = dispatch_scene(server, call, p->scene, &scene, err);
    if (outcome != OUTCOME_DONE)
        return outcome;
    struct render_request *request = make(server, call, scene, p, err);
    scene_entry_unref(scene);
    if (!request)
        return OUTCOME_FAILED;
    return submit(server, call, request, fill_compare(server, p, given, request, err), err);
}

enum outcome method_cancel(struct server *server, struct call *call, const struct params *p, struct given given, json_t **result,
                           struct error *err)
{
    (void)given;
    if (!json_is_string(p->id) && !json_is_number(p->id)) {
        error_set(err, ERROR_USAGE, "id", "id has the wrong type; the string or number of a request is accepted");
        return OUTCOME_FAILED;
    }
    *result = json_pack("{s:b}", "cancelled", pending_cancel(server, call->session, p->id));
    return OUTCOME_DONE;
}
