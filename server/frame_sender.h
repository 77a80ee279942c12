/* Stream frames on their last step, from the encoders to the socket: one at a time, so that a client that ceases to read finds no queue when it
 * reads again. Network thread. */
#pragma once

struct encode_job;
struct server;
struct view_record;

/* Sends a finished frame, or keeps it until frame_sender_acked(). Takes the job over. */
void frame_sender_take(struct server *server, struct encode_job *job);
/* The view's client has acknowledged: sends what was kept, unless it is stale. */
void frame_sender_acked(struct server *server, struct view_record *view);
/* The view goes. */
void frame_sender_drop(struct view_record *view);
