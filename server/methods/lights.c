#include "base/error.h"
#include "methods/methods.h"
#include "server.h"
#include "wire.h"

static struct view_record *view_of(struct server *server, const struct call *call, const struct params *p)
{
    return sessions_find_view(&server->sessions, call->session, (uint32_t)p->view);
}

static bool check_index(const struct view_record *view, uint64_t index, struct error *err)
{
    size_t count = view->state.settings.light_count;
    if (index < count)
        return true;
    if (count == 0)
        return error_set(err, ERROR_USAGE, "index", "index: the view has no lights; light.add makes one");
    return error_set(err, ERROR_USAGE, "index", "index: the view has %zu lights; 0 to %zu is accepted", count, count - 1);
}

static enum outcome publish(struct server *server, struct view_record *view, const struct params *p, uint64_t index,
                            json_t **result)
{
    view_publish(server, view, p->input_seq, p->input_time_us);
    *result =
        json_pack("{s:I, s:o}", "index", (json_int_t)index, "lights", wire_lights(view->scene->scene, &view->state.settings));
    return OUTCOME_DONE;
}

enum outcome method_light_add(struct server *server, struct call *call, const struct params *p, struct given given,
                              json_t **result, struct error *err)
{
    struct view_record *view = view_of(server, call, p);
    (void)given;
    if (!view)
        return OUTCOME_NO_VIEW;
    struct render_settings *settings = &view->state.settings;
    if (settings->light_count == RENDERER_LIGHTS_MAX) {
        error_set(err, ERROR_USAGE, "light", "light: the view has %d lights; no more are accepted", RENDERER_LIGHTS_MAX);
        return OUTCOME_FAILED;
    }
    if (!wire_read_light(view->scene->scene, p->light, NULL, &settings->lights[settings->light_count], err))
        return OUTCOME_FAILED;
    settings->light_count++;
    return publish(server, view, p, settings->light_count - 1, result);
}

enum outcome method_light_set(struct server *server, struct call *call, const struct params *p, struct given given,
                              json_t **result, struct error *err)
{
    struct view_record *view = view_of(server, call, p);
    (void)given;
    if (!view)
        return OUTCOME_NO_VIEW;
    struct light *light = &view->state.settings.lights[p->index];
    if (!check_index(view, p->index, err) || !wire_read_light(view->scene->scene, p->light, light, light, err))
        return OUTCOME_FAILED;
    return publish(server, view, p, p->index, result);
}

enum outcome method_light_remove(struct server *server, struct call *call, const struct params *p, struct given given,
                                 json_t **result, struct error *err)
{
    struct view_record *view = view_of(server, call, p);
    (void)given;
    if (!view)
        return OUTCOME_NO_VIEW;
    if (!check_index(view, p->index, err))
        return OUTCOME_FAILED;
    struct render_settings *settings = &view->state.settings;
    settings->light_count--;
    for (size_t i = p->index; i < settings->light_count; i++)
        settings->lights[i] = settings->lights[i + 1];
    return publish(server, view, p, p->index, result);
}
