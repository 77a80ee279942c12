#include "output.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

/* Enough digits for any figure; 17 would print 0.1 as 0.10000000000000001. */
enum { JSON_FORMAT = JSON_INDENT(2) | JSON_REAL_PRECISION(12) };

static bool write_failed(const char *path, struct error *err)
{
    const char *why = errno ? strerror(errno) : "write error";
    if (!strcmp(path, "-"))
        return error_set(err, ERROR_IO, NULL, "cannot write to standard output: %s", why);
    return error_set(err, ERROR_IO, NULL, "cannot write %s: %s", path, why);
}

static bool write_text(const char *path, const char *text, struct error *err)
{
    bool to_stdout = !strcmp(path, "-");
    errno = 0;
    FILE *file = to_stdout ? stdout : fopen(path, "w");
    if (!file)
        return write_failed(path, err);
    bool good = fputs(text, file) >= 0 && fputc('\n', file) >= 0 && fflush(file) == 0;
    int why = errno;
    if (!to_stdout && fclose(file) != 0 && good) {
        good = false;
        why = errno;
    }
    errno = why;
    return good || write_failed(path, err);
}

bool output_json(const char *path, json_t *root, struct error *err)
{
    char *text = root ? json_dumps(root, JSON_FORMAT) : NULL;
    json_decref(root);
    if (!text)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out: cannot write the figures to %s", path);
    bool good = write_text(path, text, err);
    free(text);
    return good;
}

static bool folder_writable(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    bool good = folder && access(folder, W_OK) == 0;
    int why = errno;
    free(folder);
    errno = why;
    return good;
}

bool output_check(const char *path, struct error *err)
{
    struct stat found;
    if (!strcmp(path, "-"))
        return true;
    if (!*path)
        return error_set(err, ERROR_USAGE, NULL, "an output's file name is empty; a path or - (standard output) is accepted");
    bool exists = stat(path, &found) == 0;
    if (exists && S_ISDIR(found.st_mode))
        return error_set(err, ERROR_IO, NULL, "cannot write %s: it is a folder; a file name is accepted", path);
    if (exists && !S_ISREG(found.st_mode)) /* a device or a pipe: what its folder allows does not matter */
        return true;
    return folder_writable(path) || write_failed(path, err);
}

bool output_flush(struct error *err)
{
    errno = 0;
    bool failed_before = ferror(stdout);
    if (fflush(stdout) == 0 && !failed_before)
        return true;
    return write_failed("-", err);
}

json_t *json_text(const char *text)
{
    json_t *string = json_string(text);
    if (string)
        return string;
    char *copy = strdup(text);
    for (char *c = copy; c && *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    string = copy ? json_string(copy) : NULL;
    free(copy);
    return string;
}

json_t *json_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }
