#include "session.h"

#include <stdlib.h>

#include "scene_store.h"

struct session *sessions_add(struct sessions *sessions, uint64_t id, enum role role)
{
    struct session *session = calloc(1, sizeof *session);
    if (!session)
        return NULL;
    session->id = id;
    session->role = role;
    session->link = sessions->first;
    return sessions->first = session;
}

struct session *sessions_find(struct sessions *sessions, uint64_t id)
{
    struct session *session = sessions->first;
    while (session && session->id != id)
        session = session->link;
    return session;
}

void sessions_remove(struct sessions *sessions, uint64_t id)
{
    struct session **at = &sessions->first;
    while (*at && (*at)->id != id)
        at = &(*at)->link;
    if (!*at)
        return;
    struct session *session = *at;
    *at = session->link;
    free(session);
}

struct view_record *sessions_add_view(struct sessions *sessions, struct session *session, struct scene_entry *scene)
{
    struct view_record *view = calloc(1, sizeof *view);
    if (!view)
        return NULL;
    view->id = ++sessions->last_view ? sessions->last_view : ++sessions->last_view;
    view->session = session->id;
    view->scene = scene_entry_ref(scene);
    view->link = sessions->views;
    sessions->views = view;
    sessions->view_count++;
    session->view_count++;
    return view;
}

struct view_record *sessions_find_view(struct sessions *sessions, uint64_t session, uint32_t id)
{
    for (struct view_record *view = sessions->views; view; view = view->link)
        if (view->id == id && view->session == session)
            return view;
    return NULL;
}

void sessions_remove_view(struct sessions *sessions, struct view_record *view)
{
    struct view_record **at = &sessions->views;
    while (*at != view)
        at = &(*at)->link;
    *at = view->link;
    struct session *session = sessions_find(sessions, view->session);
    if (session)
        session->view_count--;
    sessions->view_count--;
    scene_entry_unref(view->scene);
    free(view);
}

struct view_record *sessions_first_view_of(struct sessions *sessions, uint64_t session)
{
    struct view_record *view = sessions->views;
    while (view && view->session != session)
        view = view->link;
    return view;
}
