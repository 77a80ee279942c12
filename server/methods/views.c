#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "frame_sender.h"
#include "methods/methods.h"
#include "server.h"
#include "wire.h"

#define STREAM_QUALITY_DEFAULT 75

/* Device pixels of the view, checked. */
static bool apply_size(struct view_record *view, struct error *err)
{
    double width = round(view->size[0] * view->dpr), height = round(view->size[1] * view->dpr);
    if (!(width >= 1 && height >= 1 && width <= SERVER_STREAM_SIDE_MAX && height <= SERVER_STREAM_SIDE_MAX &&
          width * height <= SERVER_STREAM_PIXELS_MAX))
        return error_set(err, ERROR_USAGE, "size",
                         "size: %g x %g pixels with dpr; 1 to %d a side and at most %u together are accepted", width, height,
                         SERVER_STREAM_SIDE_MAX, SERVER_STREAM_PIXELS_MAX);
    view->state.settings.width = (uint32_t)width;
    view->state.settings.height = (uint32_t)height;
    return true;
}

static bool apply_picture(struct view_record *view, const struct params *p, struct given given, struct error *err)
{
    struct render_settings *settings = &view->state.settings;
    if (is_given(given, PARAM_LIGHTS) && !wire_read_lights(view->scene->scene, p->lights, settings, err))
        return false;
    if (is_given(given, PARAM_ALGORITHM) && !wire_read_algorithm(p->algorithm, settings, err))
        return false;
    if (is_given(given, PARAM_EXPOSURE) && !wire_read_exposure(p->exposure, settings, err))
        return false;
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

static bool apply(struct view_record *view, const struct params *p, struct given given, struct error *err)
{
    struct view_state *state = &view->state;
    if (is_given(given, PARAM_SIZE))
        memcpy(view->size, p->size, sizeof view->size);
    if (is_given(given, PARAM_DPR))
        view->dpr = p->dpr;
    if (is_given(given, PARAM_CODEC))
        state->codec = (enum gnmf_codec)p->codec;
    if (is_given(given, PARAM_QUALITY))
        state->quality = (int)p->quality;
    if (is_given(given, PARAM_FPS))
        state->fps_max = p->fps;
    if (is_given(given, PARAM_PAUSE))
        state->paused = p->pause;
    if (is_given(given, PARAM_CAMERA) && !wire_read_camera(p->camera, &view->camera, view->camera_name, err))
        return false;
    return apply_size(view, err) && apply_picture(view, p, given, err) &&
           camera_choose(view->scene->scene, &view->camera, (double)state->settings.width / state->settings.height,
                         &state->settings.camera, err);
}

void view_publish(struct server *server, struct view_record *view, uint64_t input_seq, uint64_t input_time_us)
{
    if (input_seq || input_time_us) {
        view->state.input_seq = (uint32_t)input_seq;
        view->state.input_time_us = input_time_us;
    }
    render_loop_update(server->loop, view->id, &view->state);
}

/* What the command line asks for, where it fits this scene. */
static bool apply_defaults(const struct server *server, struct view_record *view, struct error *err)
{
    struct common_options options = *server->defaults;
    struct error unfit = {0};
    view->size[0] = options.width;
    view->size[1] = options.height;
    view->dpr = 1;
    view->camera = options.camera;
    view->state.codec = GNMF_JPEG;
    view->state.quality = STREAM_QUALITY_DEFAULT;
    if (common_options_settings(&options, view->scene->scene, &view->state.settings, &unfit))
        return true;
    view->camera = options.camera = camera_choice_default();
    return common_options_settings(&options, view->scene->scene, &view->state.settings, err);
}

static json_t *describe_view(const struct view_record *view)
{
    const struct render_settings *settings = &view->state.settings;
    char algorithm[512];
    shadow_format(settings->system, &settings->params, algorithm, sizeof algorithm);
    json_t *exposure = settings->exposure_auto ? json_string("auto") : json_real(settings->exposure_ev);
    return json_pack("{s:I, s:s, s:[i,i], s:f, s:o, s:s, s:s, s:s, s:i, s:f, s:o, s:b, s:o, s:f, s:s, s:i}", "view",
                     (json_int_t)view->id, "scene", view->scene->name, "size", (int)settings->width, (int)settings->height, "dpr",
                     view->dpr, "camera", wire_camera(view->scene->scene, &settings->camera), "algorithm", algorithm, "show",
                     show_names[settings->show], "codec", codec_names[view->state.codec], "quality", view->state.quality, "fps",
                     view->state.fps_max, "lights", wire_lights(view->scene->scene, settings), "pause", view->state.paused,
                     "exposure", exposure, "ambient", settings->ambient, "tonemap", tonemap_names[settings->tonemap], "aa",
                     (int)settings->aa);
}

static bool check_room(const struct server *server, const struct session *session, struct error *err)
{
    if (session->view_count >= SESSION_VIEWS_MAX)
        return error_set(err, ERROR_TRY_AGAIN, "view", "this session has %u views open; %d are accepted", session->view_count,
                         SESSION_VIEWS_MAX);
    if (server->sessions.view_count >= RENDER_LOOP_VIEWS)
        return error_set(err, ERROR_TRY_AGAIN, "view", "this server has %d views open already; try again later",
                         RENDER_LOOP_VIEWS);
    return true;
}

enum outcome method_view_open(struct server *server, struct call *call, const struct params *p, struct given given,
                              json_t **result, struct error *err)
{
    struct session *session = sessions_find(&server->sessions, call->session);
    struct scene_entry *scene;
    if (!session || !check_room(server, session, err))
        return OUTCOME_FAILED;
    enum outcome outcome = dispatch_scene(server, call, p->scene, &scene, err);
    if (outcome != OUTCOME_DONE)
        return outcome;
    struct view_record *view = sessions_add_view(&server->sessions, session, scene);
    scene_entry_unref(scene);
    if (!view) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for another view");
        return OUTCOME_FAILED;
    }
    view->state.input_seq = (uint32_t)p->input_seq;
    view->state.input_time_us = p->input_time_us;
    if (!apply_defaults(server, view, err) || !apply(view, p, given, err)) {
        sessions_remove_view(&server->sessions, view);
        return OUTCOME_FAILED;
    }
    render_loop_open(server->loop, view->id, view->session, view->scene, &view->state);
    atomic_fetch_add(&server->metrics.views, 1);
    *result = describe_view(view);
    return OUTCOME_DONE;
}

enum outcome method_view_set(struct server *server, struct call *call, const struct params *p, struct given given,
                             json_t **result, struct error *err)
{
    struct view_record *view = sessions_find_view(&server->sessions, call->session, (uint32_t)p->view);
    if (!view)
        return OUTCOME_NO_VIEW;
    /* All or nothing: a refused member leaves the view as it was. */
    struct view_record changed = *view;
    if (changed.camera.source == CAMERA_NAMED && changed.camera.name == view->camera_name)
        changed.camera.name = changed.camera_name;
    if (!apply(&changed, p, given, err))
        return OUTCOME_FAILED;
    *view = changed;
    if (view->camera.source == CAMERA_NAMED && view->camera.name == changed.camera_name)
        view->camera.name = view->camera_name;
    view_publish(server, view, p->input_seq, p->input_time_us);
    if (call->id)
        *result = describe_view(view);
    return OUTCOME_DONE;
}

void view_close(struct server *server, struct view_record *view)
{
    render_loop_close(server->loop, view->id);
    frame_sender_drop(view);
    sessions_remove_view(&server->sessions, view);
    atomic_fetch_sub(&server->metrics.views, 1);
}

enum outcome method_view_close(struct server *server, struct call *call, const struct params *p, struct given given,
                               json_t **result, struct error *err)
{
    struct view_record *view = sessions_find_view(&server->sessions, call->session, (uint32_t)p->view);
    (void)given, (void)result, (void)err;
    if (!view)
        return OUTCOME_NO_VIEW;
    view_close(server, view);
    return OUTCOME_DONE;
}

enum outcome method_frame_ack(struct server *server, struct call *call, const struct params *p, struct given given,
                              json_t **result, struct error *err)
{
    (void)given, (void)result;
    struct view_record *view = sessions_find_view(&server->sessions, call->session, (uint32_t)p->view);
    if (!view)
        return OUTCOME_NO_VIEW;
    if (render_loop_ack(server->loop, view->id, p->frame)) {
        frame_sender_acked(server, view);
        return OUTCOME_DONE;
    }
    error_set(err, ERROR_USAGE, "frame",
              "frame: no such frame has been sent; the number in a received frame's header is accepted");
    return OUTCOME_FAILED;
}
