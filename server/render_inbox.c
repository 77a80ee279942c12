#include <assert.h>
#include <stdatomic.h>

#include "clock.h"
#include "render_loop_state.h"
#include "scene_store.h"

void render_loop_changed(struct render_loop *loop)
{
    loop->events++;
    pthread_cond_signal(&loop->changed);
}

struct stream_view *render_loop_find_view(struct render_loop *loop, uint32_t view)
{
    for (size_t i = 0; i < RENDER_LOOP_VIEWS; i++)
        if (loop->views[i].id == view && view != 0)
            return &loop->views[i];
    return NULL;
}

bool render_loop_open(struct render_loop *loop, uint32_t view, uint64_t session, struct scene_entry *scene,
                      const struct view_state *state)
{
    assert(view != 0 && scene->status == SCENE_READY);
    bool found = false;
    pthread_mutex_lock(&loop->mutex);
    for (size_t i = 0; i < RENDER_LOOP_VIEWS && !found; i++) {
        if (loop->views[i].id != 0)
            continue;
        loop->views[i] = (struct stream_view){.id = view, .session = session, .scene = scene_entry_ref(scene)};
        enum drop_reason reason;
        stream_view_update(&loop->views[i], state, clock_us(), &reason);
        render_loop_changed(loop);
        found = true;
    }
    pthread_mutex_unlock(&loop->mutex);
    return found;
}

void render_loop_update(struct render_loop *loop, uint32_t view, const struct view_state *state)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    if (v) {
        enum drop_reason reason;
        if (stream_view_update(v, state, clock_us(), &reason))
            atomic_fetch_add(&loop->options.metrics->dropped[reason], 1);
        render_loop_changed(loop);
    }
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_close(struct render_loop *loop, uint32_t view)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    if (v) {
        scene_entry_unref(v->scene);
        *v = (struct stream_view){0};
    }
    pthread_mutex_unlock(&loop->mutex);
}

bool render_loop_ack(struct render_loop *loop, uint32_t view, uint64_t frame)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    bool ok = v && stream_view_ack(v, frame, clock_us());
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
    return ok;
}

void render_loop_sent(struct render_loop *loop, uint32_t view, uint64_t frame, uint32_t encode_us, size_t bytes)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    if (v)
        stream_view_sent(v, frame, encode_us, bytes, clock_us());
    pthread_mutex_unlock(&loop->mutex);
}

bool render_loop_may_send(struct render_loop *loop, uint32_t view)
{
    pthread_mutex_lock(&loop->mutex);
    const struct stream_view *v = render_loop_find_view(loop, view);
    bool may = !v || stream_view_may_send(v);
    pthread_mutex_unlock(&loop->mutex);
    return may;
}

bool render_loop_is_stale(struct render_loop *loop, uint32_t view, uint64_t frame, uint64_t since_us)
{
    pthread_mutex_lock(&loop->mutex);
    const struct stream_view *v = render_loop_find_view(loop, view);
    bool stale = !v || stream_view_is_stale(v, frame, since_us, clock_us());
    pthread_mutex_unlock(&loop->mutex);
    return stale;
}

void render_loop_lost(struct render_loop *loop, uint32_t view, uint64_t frame)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    if (v)
        stream_view_lost(v, frame);
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_blocked(struct render_loop *loop, uint64_t session, bool blocked)
{
    pthread_mutex_lock(&loop->mutex);
    for (size_t i = 0; i < RENDER_LOOP_VIEWS; i++)
        if (loop->views[i].id != 0 && loop->views[i].session == session)
            loop->views[i].blocked = blocked;
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

static bool queue(struct render_loop *loop, struct render_request **list, size_t *count, size_t most,
                  struct render_request *request)
{
    pthread_mutex_lock(&loop->mutex);
    bool room = *count < most && !loop->stopping;
    if (room) {
        while (*list)
            list = &(*list)->link;
        *list = request;
        request->link = NULL;
        ++*count;
        render_loop_changed(loop);
    }
    pthread_mutex_unlock(&loop->mutex);
    return room;
}

bool render_loop_request(struct render_loop *loop, struct render_request *request)
{
    if (request->compare)
        return queue(loop, &loop->compares, &loop->compare_count, RENDER_LOOP_COMPARES, request);
    return queue(loop, &loop->snapshots, &loop->snapshot_count, RENDER_LOOP_SNAPSHOTS, request);
}

bool render_loop_view(struct render_loop *loop, uint32_t view, struct stream_view *out)
{
    pthread_mutex_lock(&loop->mutex);
    struct stream_view *v = render_loop_find_view(loop, view);
    if (v)
        *out = *v;
    pthread_mutex_unlock(&loop->mutex);
    return v;
}

void render_loop_retire(struct render_loop *loop, struct scene_entry *scene)
{
    pthread_mutex_lock(&loop->mutex);
    scene->link = loop->retired;
    loop->retired = scene;
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}

void render_loop_kick(struct render_loop *loop)
{
    pthread_mutex_lock(&loop->mutex);
    render_loop_changed(loop);
    pthread_mutex_unlock(&loop->mutex);
}
