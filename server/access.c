#include "access.h"

#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/error.h"

#define TOKEN_MAX 256

static bool add_line(struct access *access, const char *path, unsigned number, char *line, struct error *err)
{
    char *rest, *word = strtok_r(line, " \t\r\n", &rest);
    if (!word || word[0] == '#')
        return true;
    enum role role = strcmp(word, "view") == 0 ? ROLE_VIEW : strcmp(word, "control") == 0 ? ROLE_CONTROL : ROLE_NONE;
    char *token = strtok_r(NULL, " \t\r\n", &rest);
    if (role == ROLE_NONE || !token || strlen(token) > TOKEN_MAX || strtok_r(NULL, " \t\r\n", &rest))
        return error_set(err, ERROR_USAGE, "--token-file",
                         "%s line %u: \"view TOKEN\" or \"control TOKEN\" is wanted; a token has 1 to %d characters", path,
                         number, TOKEN_MAX);
    char *copy = strdup(token);
    if (!copy || !array_push(&access->tokens, ((struct access_token){copy, role}))) {
        free(copy);
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for tokens");
    }
    return true;
}

bool access_read_tokens(struct access *access, const char *path, struct error *err)
{
    FILE *file = fopen(path, "re");
    if (!file)
        return error_set(err, errno == ENOENT ? ERROR_NO_INPUT : ERROR_IO, "--token-file",
                         "--token-file %s: %s; a readable file is wanted", path, strerror(errno));
    char line[TOKEN_MAX + 64];
    bool ok = true;
    for (unsigned number = 1; ok && fgets(line, sizeof line, file); number++)
        ok = add_line(access, path, number, line, err);
    if (ok && ferror(file))
        ok = error_set(err, ERROR_IO, "--token-file", "--token-file %s: reading failed", path);
    fclose(file);
    access->tokens_needed = true;
    if (ok && access->tokens.count == 0)
        return error_set(err, ERROR_USAGE, "--token-file",
                         "%s holds no token; lines \"view TOKEN\" or \"control TOKEN\" are wanted", path);
    return ok;
}

void access_finish(struct access *access)
{
    for (size_t i = 0; i < access->tokens.count; i++)
        free(access->tokens.data[i].text);
    array_finish(&access->tokens);
}

static bool same_secret(const char *a, const char *b)
{
    size_t length = strlen(a);
    if (strlen(b) != length)
        return false;
    unsigned char difference = 0;
    for (size_t i = 0; i < length; i++)
        difference |= (unsigned char)(a[i] ^ b[i]);
    return difference == 0;
}

enum role access_role(const struct access *access, const char *token)
{
    if (!access->tokens_needed)
        return ROLE_CONTROL;
    enum role role = ROLE_NONE;
    for (size_t i = 0; token && i < access->tokens.count; i++)
        if (same_secret(access->tokens.data[i].text, token) && access->tokens.data[i].role > role)
            role = access->tokens.data[i].role;
    return role;
}

static bool is_ip_literal(const char *host)
{
    unsigned char address[16];
    return inet_pton(AF_INET, host, address) == 1 || inet_pton(AF_INET6, host, address) == 1;
}

bool access_is_loopback(const char *host)
{
    struct in_addr v4;
    if (strcasecmp(host, "localhost") == 0 || strcmp(host, "::1") == 0)
        return true;
    return inet_pton(AF_INET, host, &v4) == 1 && (ntohl(v4.s_addr) >> 24) == 127;
}

/* The host part of "HOST", "HOST:PORT", "[V6]" or "[V6]:PORT"; false when it is none of them. */
static bool host_part(const char *text, char *out, size_t size)
{
    bool bracket = text[0] == '[';
    size_t length = bracket ? strcspn(++text, "]") : strcspn(text, ":");
    const char *after = text + length;
    if (bracket && *after++ != ']')
        return false;
    if (length == 0 || length >= size || (*after && (*after != ':' || strspn(after + 1, "0123456789") != strlen(after + 1))))
        return false;
    memcpy(out, text, length);
    out[length] = 0;
    return true;
}

static const char *after_scheme(const char *origin)
{
    const char *at = strstr(origin, "://");
    return at ? at + 3 : NULL;
}

static bool is_host_of_allowed_origin(const struct access *access, const char *host)
{
    for (size_t i = 0; i < access->origin_count; i++) {
        char name[256];
        const char *rest = after_scheme(access->origins[i]);
        if (rest && host_part(rest, name, sizeof name) && strcasecmp(name, host) == 0)
            return true;
    }
    return false;
}

bool access_host_ok(const struct access *access, const char *host)
{
    char name[256], own[256];
    if (!host || !host_part(host, name, sizeof name))
        return false;
    if (access_is_loopback(name) || strcasecmp(name, access->listen_host) == 0)
        return true;
    if (access->loopback)
        return false;
    if (is_ip_literal(name) || is_host_of_allowed_origin(access, name))
        return true;
    return gethostname(own, sizeof own) == 0 && strcasecmp(name, own) == 0;
}

bool access_origin_allowed(const struct access *access, const char *origin)
{
    for (size_t i = 0; i < access->origin_count; i++)
        if (strcasecmp(access->origins[i], origin) == 0)
            return true;
    return false;
}

bool access_origin_ok(const struct access *access, const char *origin, const char *host)
{
    if (!origin || access_origin_allowed(access, origin))
        return true;
    const char *rest = after_scheme(origin);
    return rest && host && strcasecmp(rest, host) == 0;
}
