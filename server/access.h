/* Who may come in: tokens, Host and Origin. Decided from text alone, before any upgrade. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/array.h"

struct error;

enum role { ROLE_NONE, ROLE_VIEW, ROLE_CONTROL };

struct access_token {
    char *text; /* owned */
    enum role role;
};

struct access {
    ARRAY(struct access_token) tokens;
    bool tokens_needed;         /* a token file was given */
    const char *listen_host;    /* as in --listen, without brackets; borrowed */
    bool loopback;              /* listen_host is one */
    const char *const *origins; /* --allow-origin, borrowed */
    size_t origin_count;
};

/* Reads lines `view TOKEN` or `control TOKEN`; empty lines and lines beginning with # are skipped. ERROR_NO_INPUT, ERROR_IO, ERROR_USAGE. */
bool access_read_tokens(struct access *access, const char *path, struct error *err);
void access_finish(struct access *access);

/* The role of `token` (NULL: none given). Without a token file everybody is in control. Takes the same time for every wrong token of a
 * length. */
enum role access_role(const struct access *access, const char *token);

/* Whether the Host header (NULL: absent) names this server. A name that resolves here but is not ours is how a foreign page reaches a
 * loopback server (DNS rebinding): only loopback names, the listening address and, for servers that listen to the network, IP literals,
 * this machine's name and hosts of allowed origins are. */
bool access_host_ok(const struct access *access, const char *host);

/* Whether a page from `origin` (NULL: not from a page) may talk to us: the page we served ourselves (http://HOST), or an allowed one. */
bool access_origin_ok(const struct access *access, const char *origin, const char *host);
/* True when `origin` is in the --allow-origin list. */
bool access_origin_allowed(const struct access *access, const char *origin);

bool access_is_loopback(const char *host);
