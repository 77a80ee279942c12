/* What the methods share; protocol.h declares the handlers themselves, one for each method of proto/gnomon.openrpc.json. */
#pragma once

#include "dispatch.h"

struct view_record;

/* Hands the view's new state to the render thread, with the newest input's echo (0: none given, keeps the last). */
void view_publish(struct server *server, struct view_record *view, uint64_t input_seq, uint64_t input_time_us);
void view_close(struct server *server, struct view_record *view);

/* [{name, source, ...}]: what this server offers. */
json_t *hello_scenes(const struct server *server);
/* The notification that each session gets first. */
json_t *hello_params(struct server *server, uint64_t session);
/* view.stats of one view; NULL when it is gone. `seconds` since the counts in *frames and *dropped, which it replaces. */
json_t *view_stats(struct server *server, const struct view_record *view, double seconds, uint64_t *frames, uint64_t *bytes);
