#include "remote.h"

#include <curl/curl.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "access.h"
#include "base/array.h"
#include "base/error.h"
#include "protocol.h"

#define CONNECT_SECONDS 10
/* A picture of 2^26 pixels in EXR is 1 GiB before compression. */
#define ANSWER_MAX      (3ull << 30)
#define TOKEN_MAX       256

/* One request and what came back. */
struct exchange {
    CURL *curl;
    struct curl_slist *headers;
    char *text; /* the body sent */
    ARRAY(uint8_t) body;
    bool too_long, out_of_memory;
    long status;
    char type[80], why[CURL_ERROR_SIZE];
};

bool remote_set_url(struct remote *remote, const char *value, struct error *err)
{
    CURLU *url = curl_url();
    char *scheme = NULL, *query = NULL, *user = NULL;
    bool good = url && curl_url_set(url, CURLUPART_URL, value, 0) == CURLUE_OK &&
                curl_url_get(url, CURLUPART_SCHEME, &scheme, 0) == CURLUE_OK &&
                (strcmp(scheme, "http") == 0 || strcmp(scheme, "https") == 0) &&
                curl_url_get(url, CURLUPART_QUERY, &query, 0) == CURLUE_NO_QUERY &&
                curl_url_get(url, CURLUPART_USER, &user, 0) == CURLUE_NO_USER;
    curl_free(scheme);
    curl_free(query);
    curl_free(user);
    curl_url_cleanup(url);
    remote->url = value;
    return good || error_set(err, ERROR_USAGE, "server",
                             "http://HOST:PORT/ is accepted, as gnomon serve prints it; a token goes into --token-file or "
                             "GNOMON_TOKEN");
}

/* ---- what is sent ---- */

/* The last word of the first line that is no comment: a bare token, or a line of the server's own file. */
static bool read_token(const char *path, char out[TOKEN_MAX + 1], struct error *err)
{
    FILE *file = fopen(path, "re");
    if (!file)
        return error_set(err, errno == ENOENT ? ERROR_NO_INPUT : ERROR_IO, "token-file",
                         "--token-file %s: %s; a readable file is accepted", path, strerror(errno));
    char line[TOKEN_MAX + 64];
    out[0] = 0;
    while (!out[0] && fgets(line, sizeof line, file)) {
        char *rest, *word = strtok_r(line, " \t\r\n", &rest);
        for (; word && word[0] != '#'; word = strtok_r(NULL, " \t\r\n", &rest))
            snprintf(out, TOKEN_MAX + 1, "%s", word);
    }
    fclose(file);
    return out[0] ||
           error_set(err, ERROR_USAGE, "token-file",
                     "--token-file %s holds no token; a line with TOKEN, view TOKEN or control TOKEN is accepted", path);
}

static bool add_header(struct exchange *x, const char *line, struct error *err)
{
    struct curl_slist *longer = curl_slist_append(x->headers, line);
    if (!longer)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a request");
    x->headers = longer;
    return true;
}

static bool add_token(struct exchange *x, const struct remote *remote, struct error *err)
{
    char token[TOKEN_MAX + 1] = "", line[TOKEN_MAX + 40];
    const char *environment = getenv("GNOMON_TOKEN");
    if (remote->token_file && !read_token(remote->token_file, token, err))
        return false;
    if (!remote->token_file && environment)
        snprintf(token, sizeof token, "%.*s", (int)strcspn(environment, "\r\n"), environment);
    snprintf(line, sizeof line, "Authorization: Bearer %s", token);
    return !token[0] || add_header(x, line, err);
}

static bool add_body(struct exchange *x, json_t *body, struct error *err)
{
    x->text = json_dumps(body, JSON_COMPACT);
    if (!x->text)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a request");
    curl_easy_setopt(x->curl, CURLOPT_POSTFIELDS, x->text);
    curl_easy_setopt(x->curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)strlen(x->text));
    return add_header(x, "Content-Type: application/json", err);
}

static size_t on_data(char *data, size_t one, size_t count, void *context)
{
    struct exchange *x = context;
    size_t size = one * count, at = x->body.count;
    x->too_long = at + size > ANSWER_MAX;
    x->out_of_memory = !x->too_long && !array_extend(&x->body, size);
    if (x->too_long || x->out_of_memory)
        return CURL_WRITEFUNC_ERROR;
    memcpy(x->body.data + at, data, size);
    return size;
}

/* `path` behind the server's address, which may end in a slash, and be below a proxy's path. */
static bool set_address(struct exchange *x, const char *url, const char *path, struct error *err)
{
    size_t length = strlen(url);
    while (length > 0 && url[length - 1] == '/')
        length--;
    char *address = NULL;
    if (asprintf(&address, "%.*s%s", (int)length, url, path) < 0)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a request");
    CURLcode set = curl_easy_setopt(x->curl, CURLOPT_URL, address);
    free(address);
    return set == CURLE_OK || error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a request");
}

static bool prepare(struct exchange *x, const struct remote *remote, const char *path, json_t *body, struct error *err)
{
    if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK || !(x->curl = curl_easy_init()))
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for a request");
    curl_easy_setopt(x->curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(x->curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(x->curl, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_SECONDS);
    /* A picture may take minutes in which nothing comes: only a dead machine ends that. */
    curl_easy_setopt(x->curl, CURLOPT_TCP_KEEPALIVE, 1L);
    curl_easy_setopt(x->curl, CURLOPT_USERAGENT, "gnomon/" GNOMON_VERSION);
    curl_easy_setopt(x->curl, CURLOPT_ERRORBUFFER, x->why);
    curl_easy_setopt(x->curl, CURLOPT_WRITEFUNCTION, on_data);
    curl_easy_setopt(x->curl, CURLOPT_WRITEDATA, x);
    return set_address(x, remote->url, path, err) && (!body || add_body(x, body, err)) && add_token(x, remote, err) &&
           curl_easy_setopt(x->curl, CURLOPT_HTTPHEADER, x->headers) == CURLE_OK;
}

static void finish(struct exchange *x)
{
    array_finish(&x->body);
    curl_easy_cleanup(x->curl);
    curl_slist_free_all(x->headers);
    free(x->text);
}

/* ---- what comes back ---- */

static bool no_answer(const struct exchange *x, CURLcode code, const char *url, struct error *err)
{
    const char *why = x->why[0] ? x->why : curl_easy_strerror(code);
    if (x->too_long || x->out_of_memory)
        return error_set(err, x->too_long ? ERROR_IO : ERROR_TRY_AGAIN, "server", "%s answered with more than %s", url,
                         x->too_long ? "any picture has" : "memory holds");
    if (x->status)
        return error_set(err, ERROR_IO, "server", "%s ended its answer early: %s", url, why);
    return error_set(err, ERROR_IO, "server", "no answer from %s: %s; the address of a running gnomon serve is accepted", url,
                     why);
}

/* The opposite of rpc_code_of(). */
static enum error_code code_of(json_int_t rpc)
{
    switch (rpc) {
    case RPC_NO_SUCH_SCENE: return ERROR_NO_INPUT;
    case RPC_BAD_SCENE: return ERROR_DATA;
    case RPC_NO_DEVICE: return ERROR_NO_DEVICE;
    case RPC_IO: return ERROR_IO;
    case RPC_BUSY:
    case RPC_CANCELLED: return ERROR_TRY_AGAIN;
    case RPC_INTERNAL: return ERROR_BUG;
    default: return ERROR_USAGE;
    }
}

static bool refused(const struct exchange *x, const char *url, const char *path, struct error *err)
{
    json_t *body = strcmp(x->type, "application/json") == 0 ? json_loadb((char *)x->body.data, x->body.count, 0, NULL) : NULL;
    const json_t *error = json_object_get(body, "error"), *code = json_object_get(error, "code");
    const char *message = json_string_value(json_object_get(error, "message"));
    if (message && json_is_integer(code))
        error_set(err, code_of(json_integer_value(code)), "server", "%s: %s", url, message);
    else if (x->status == 401)
        error_set(err, ERROR_USAGE, "server", "%s wants a token that it knows; --token-file FILE or GNOMON_TOKEN is accepted",
                  url);
    else if (x->status == 403)
        error_set(err, ERROR_USAGE, "server", "%s does not go by that name; an address that it listens on is accepted", url);
    else if (x->status == 503)
        error_set(err, ERROR_TRY_AGAIN, "server", "%s is busy; try again later", url);
    else
        error_set(err, ERROR_IO, "server", "%s answered %ld to %s: the address of a running gnomon serve is accepted", url,
                  x->status, path);
    json_decref(body);
    return false;
}

static void read_type(struct exchange *x)
{
    char *type = NULL;
    curl_easy_getinfo(x->curl, CURLINFO_RESPONSE_CODE, &x->status);
    curl_easy_getinfo(x->curl, CURLINFO_CONTENT_TYPE, &type);
    if (type)
        snprintf(x->type, sizeof x->type, "%.*s", (int)strcspn(type, "; "), type);
}

bool remote_ask(const struct remote *remote, const char *path, json_t *body, struct remote_answer *out, struct error *err)
{
    struct exchange x = {0};
    bool good = prepare(&x, remote, path, body, err);
    if (good) {
        CURLcode code = curl_easy_perform(x.curl);
        read_type(&x);
        good = code == CURLE_OK ? x.status == 200 || refused(&x, remote->url, path, err) : no_answer(&x, code, remote->url, err);
    }
    if (good) {
        *out = (struct remote_answer){.data = x.body.data, .size = x.body.count};
        memcpy(out->type, x.type, sizeof out->type);
        x.body.data = NULL;
    }
    finish(&x);
    json_decref(body);
    return good;
}

json_t *remote_list(const struct remote *remote, const char *path, const char *name, struct error *err)
{
    struct remote_answer answer;
    if (!remote_ask(remote, path, NULL, &answer, err))
        return NULL;
    json_t *root = json_loadb((char *)answer.data, answer.size, 0, NULL), *list = json_object_get(root, name);
    free(answer.data);
    if (json_is_array(list))
        json_incref(list);
    else
        list = NULL;
    json_decref(root);
    if (!list)
        error_set(err, ERROR_IO, "server", "%s answered %s with no list of %s: the address of a running gnomon serve is accepted",
                  remote->url, path, name);
    return list;
}
