/* A running server, spoken to over HTTP: what --server means. remote.c is the only file that includes curl. For commands: calls wait for the
 * answer, which may take as long as the server renders. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#define REMOTE_OPTION_URL "let the server at http://HOST:PORT/ do it, as gnomon serve prints it"
#define REMOTE_OPTION_TOKEN \
    "with --server: a file with the token, or the server's own token file (default: $GNOMON_TOKEN, where set)"

struct error;

/* Strings are borrowed. */
struct remote {
    const char *url;        /* NULL: no server */
    const char *token_file; /* NULL: the environment's GNOMON_TOKEN, where it is set */
};

struct remote_answer {
    char type[80]; /* content type, without parameters */
    uint8_t *data; /* free() */
    size_t size;
};

/* Takes the value of --server. ERROR_USAGE when it is no http:// or https:// address, or has a query or a user in it. */
bool remote_set_url(struct remote *remote, const char *value, struct error *err);

/* GETs `path` ("/v1/scenes") or, when `body` is given (taken over), POSTs that. An answer of 200 is in *out, which the caller frees; every
 * other, and none, is an error with the code that the same failure has without a server: ERROR_USAGE for what the server refuses (a token
 * too), ERROR_TRY_AGAIN when it is busy, ERROR_IO when it cannot be reached, ends the connection early, or is no gnomon server. */
bool remote_ask(const struct remote *remote, const char *path, json_t *body, struct remote_answer *out, struct error *err);

/* The member `name`, an array, of the JSON at `path`; a new reference, NULL on error. */
json_t *remote_list(const struct remote *remote, const char *path, const char *name, struct error *err);
