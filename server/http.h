/* What each path answers. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "dispatch.h"
#include "net.h"

struct encode_job;

/* net_handlers.admit: Host, Origin, then the token; the tag is the role. */
int http_admit(void *context, const struct net_request *request, unsigned *tag);
/* net_handlers.request. */
void http_request(void *context, uint64_t id, unsigned tag, const struct net_request *request, const char *body, size_t size);

void http_answer_error(struct server *server, uint64_t request, const char *allow_origin, enum rpc_code code,
                       const struct error *err);
/* Takes the job's packet. */
void http_answer_picture(struct server *server, uint64_t request, const char *allow_origin, struct encode_job *job);
