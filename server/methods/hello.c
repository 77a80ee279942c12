#include <stdio.h>
#include <string.h>

#include "figures.h"
#include "listings.h"
#include "methods/methods.h"
#include "output.h"
#include "server.h"

#define PROTOCOL_VERSION 1

static json_t *limits(void)
{
    return json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i}", "message_bytes", (int)NET_MESSAGE_MAX, "views",
                     SESSION_VIEWS_MAX, "lights", RENDERER_LIGHTS_MAX, "stream_side", SERVER_STREAM_SIDE_MAX, "stream_pixels",
                     (int)SERVER_STREAM_PIXELS_MAX, "snapshot_side", RENDERER_SIZE_MAX, "snapshot_pixels",
                     (int)SERVER_SNAPSHOT_PIXELS_MAX, "compare_pixels", (int)SERVER_COMPARE_PIXELS_MAX, "in_flight",
                     STREAM_IN_FLIGHT);
}

static json_t *capabilities(const struct server *server)
{
    json_t *shows = json_array(), *names = json_array(), *notifications = json_array();
    for (size_t i = 0; show_names[i]; i++)
        json_array_append_new(shows, json_string(show_names[i]));
    for (const struct method *method = methods; method->name; method++)
        json_array_append_new(names, json_string(method->name));
    for (size_t i = 0; protocol_notifications[i]; i++)
        json_array_append_new(notifications, json_string(protocol_notifications[i]));
    return json_pack("{s:[s,s,s], s:[s,s,s,s], s:o, s:o, s:o, s:o}", "codecs", codec_names[GNMF_JPEG], codec_names[GNMF_PNG],
                     codec_names[GNMF_WEBP], "formats", codec_names[GNMF_PNG], codec_names[GNMF_JPEG], codec_names[GNMF_WEBP],
                     codec_names[GNMF_EXR], "show", shows, "methods", names, "notifications", notifications, "device",
                     json_text(render_loop_device(server->loop)->renderer));
}

/* The server's own first, then its files, then what is built in. */
json_t *hello_scenes(const struct server *server)
{
    json_t *list = json_array();
    if (scene_is_builtin(server->first_scene))
        json_array_append_new(list, json_pack("{s:s, s:s}", "name", server->first_scene, "source", "builtin"));
    for (size_t i = 0; i < server->catalog.files.count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "name", server->catalog.files.data[i].name, "source", "file"));
    json_t *builtins = listing_scenes(), *entry;
    size_t index;
    json_array_foreach(builtins, index, entry)
    {
        json_object_set_new(entry, "source", json_string("builtin"));
        const char *name = json_string_value(json_object_get(entry, "name"));
        if (!name || strcmp(name, server->first_scene) != 0)
            json_array_append(list, entry);
    }
    json_decref(builtins);
    return list;
}

json_t *hello_params(struct server *server, uint64_t session)
{
    char name[24];
    const struct session *s = sessions_find(&server->sessions, session);
    snprintf(name, sizeof name, "%llx", (unsigned long long)session);
    return json_pack("{s:s, s:i, s:s, s:s, s:o, s:o, s:o, s:o}", "version", GNOMON_VERSION, "protocol", PROTOCOL_VERSION,
                     "session", name, "role", s && s->role == ROLE_CONTROL ? "control" : "view", "capabilities",
                     capabilities(server), "limits", limits(), "scenes", hello_scenes(server), "algorithms",
                     listing_algorithms());
}

json_t *view_stats(struct server *server, const struct view_record *view, double seconds, uint64_t *frames, uint64_t *bytes)
{
    struct stream_view v;
    char algorithm[512];
    if (!render_loop_view(server->loop, view->id, &v))
        return NULL;
    json_t *passes = json_object();
    for (size_t i = 0; i < PASS_COUNT; i++) {
        char name[32];
        snprintf(name, sizeof name, "%s_ms", render_pass_names[i]);
        json_object_set_new(passes, name, json_real(v.last.pass_ms[i]));
    }
    const struct render_settings *settings = &view->state.settings;
    shadow_format(settings->system, &settings->params, algorithm, sizeof algorithm);
    double fps = (double)(v.frames - *frames) / seconds;
    json_int_t sent = (json_int_t)(v.bytes - *bytes);
    *frames = v.frames;
    *bytes = v.bytes;
    return json_pack("{s:I, s:f, s:f, s:o, s:f, s:I, s:I, s:i, s:f, s:s, s:s, s:o, s:I, s:o*}", "view", (json_int_t)view->id,
                     "fps", fps, "frame_ms", v.last.frame_ms, "passes", passes, "encode_ms", v.encode_us / 1000.0, "bytes", sent,
                     "dropped", (json_int_t)v.dropped, "in_flight", (int)v.in_flight_count, "rtt_ms", (double)v.rtt_us / 1000.0,
                     "algorithm", settings->system->name, "settings", algorithm, "params",
                     figures_params(settings->system, &settings->params), "shadow_bytes", (json_int_t)v.last.shadow_bytes,
                     "figures", figures_told(v.last.figures, v.last.figure_count));
}
