#include <stddef.h>

#include "base/error.h"
#include "methods/methods.h"
#include "server.h"
#include "wire.h"

struct light_params {
    uint64_t view, index;
    json_t *light;
    uint64_t input_seq, input_time_us;
};

#define AT(field) offsetof(struct light_params, field)
#define INPUT_MEMBERS                                                                \
    {"input_seq", MEMBER_INTEGER, AT(input_seq), 0, UINT32_MAX},                     \
        {"input_time_us", MEMBER_INTEGER, AT(input_time_us), 0, MEMBER_INTEGER_MAX}, \
    {                                                                                \
        0                                                                            \
    }
#define VIEW_MEMBER                                                       \
    {                                                                     \
        "view", MEMBER_INTEGER, AT(view), 1, UINT32_MAX, .required = true \
    }
#define INDEX_MEMBER                                                                     \
    {                                                                                    \
        "index", MEMBER_INTEGER, AT(index), 0, RENDERER_LIGHTS_MAX - 1, .required = true \
    }
#define LIGHT_MEMBER                                     \
    {                                                    \
        "light", MEMBER_ANY, AT(light), .required = true \
    }

static const struct member add_members[] = {VIEW_MEMBER, LIGHT_MEMBER, INPUT_MEMBERS};
static const struct member set_members[] = {VIEW_MEMBER, INDEX_MEMBER, LIGHT_MEMBER, INPUT_MEMBERS};
static const struct member remove_members[] = {VIEW_MEMBER, INDEX_MEMBER, INPUT_MEMBERS};

static struct view_record *view_of(struct server *server, const struct call *call, const struct light_params *p)
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

static enum outcome publish(struct server *server, struct view_record *view, const struct light_params *p, uint64_t index,
                            json_t **result)
{
    view_publish(server, view, p->input_seq, p->input_time_us);
    *result =
        json_pack("{s:I, s:o}", "index", (json_int_t)index, "lights", wire_lights(view->scene->scene, &view->state.settings));
    return OUTCOME_DONE;
}

static enum outcome add_light(struct server *server, struct call *call, const void *params, struct given given, json_t **result,
                              struct error *err)
{
    const struct light_params *p = params;
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

static enum outcome set_light(struct server *server, struct call *call, const void *params, struct given given, json_t **result,
                              struct error *err)
{
    const struct light_params *p = params;
    struct view_record *view = view_of(server, call, p);
    (void)given;
    if (!view)
        return OUTCOME_NO_VIEW;
    struct light *light = &view->state.settings.lights[p->index];
    if (!check_index(view, p->index, err) || !wire_read_light(view->scene->scene, p->light, light, light, err))
        return OUTCOME_FAILED;
    return publish(server, view, p, p->index, result);
}

static enum outcome remove_light(struct server *server, struct call *call, const void *params, struct given given,
                                 json_t **result, struct error *err)
{
    const struct light_params *p = params;
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

const struct method method_light_add = {"light.add", add_members, sizeof(struct light_params), false, add_light};
const struct method method_light_set = {"light.set", set_members, sizeof(struct light_params), false, set_light};
const struct method method_light_remove = {"light.remove", remove_members, sizeof(struct light_params), false, remove_light};
