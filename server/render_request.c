#include "render_request.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "clock.h"
#include "scene_store.h"

#define TELL_EVERY_US 100000

const char *const request_stage_names[] = {"loading", "waiting", "rendering", "comparing", "encoding"};

struct render_request *render_request_create(struct scene_entry *scene)
{
    struct render_request *request = calloc(1, sizeof *request);
    if (!request)
        return NULL;
    request->scene = scene_entry_ref(scene);
    atomic_init(&request->stage, STAGE_WAITING);
    atomic_init(&request->permille, -1);
    return request;
}

void render_request_destroy(struct render_request *request)
{
    if (!request)
        return;
    scene_entry_unref(request->scene);
    json_decref(request->figures);
    free(request);
}

void render_request_tell(struct render_request *request, enum request_stage stage, double done)
{
    int before = atomic_exchange(&request->stage, stage);
    atomic_store(&request->permille, done < 0 ? -1 : (int)(done * 1000));
    if (!request->told)
        return;
    uint64_t now = clock_us(), last = atomic_load(&request->told_us);
    if (before == (int)stage && (now < last + TELL_EVERY_US || !atomic_compare_exchange_strong(&request->told_us, &last, now)))
        return;
    request->told(request->context);
}
