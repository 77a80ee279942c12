#include "gl/shader_source.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/array.h"
#include "base/embed.h"
#include "base/error.h"

#define DEPTH_MAX 8

struct text {
    ARRAY(char) bytes;
    const char *dir;
    int depth;
    int file; /* number in #line directives */
};

static bool append(struct text *out, const char *data, size_t size)
{
    size_t at = out->bytes.count;
    if (!array_extend(&out->bytes, size))
        return false;
    memcpy(out->bytes.data + at, data, size);
    return true;
}

static bool append_string(struct text *out, const char *s) { return append(out, s, strlen(s)); }

static char *read_file(const char *dir, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *f = fopen(path, "rb");
    if (!f)
        return NULL;
    char *data = NULL;
    size_t size = 0;
    if (getdelim(&data, &size, 0, f) < 0) {
        free(data);
        data = NULL;
    }
    fclose(f);
    return data;
}

static char *find_source(const char *dir, const char *name)
{
    if (dir)
        return read_file(dir, name);
    for (const struct embedded_file *f = embedded_shaders; f->name; f++)
        if (strcmp(f->name, name) == 0)
            return strdup(f->data);
    return NULL;
}

static bool append_file(struct text *out, const char *name, struct error *err);

static bool append_line(struct text *out, const char *line, size_t length, int number, int file, struct error *err)
{
    char name[128], line_directive[64];
    if (sscanf(line, "#include \"%127[^\"]\"", name) != 1)
        return append(out, line, length) || error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
    if (!append_file(out, name, err))
        return false;
    snprintf(line_directive, sizeof line_directive, "#line %d %d\n", number + 1, file);
    return append_string(out, line_directive) || error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
}

static bool append_file(struct text *out, const char *name, struct error *err)
{
    if (out->depth == DEPTH_MAX)
        return error_set(err, ERROR_DATA, NULL, "shader %s: includes nested more than %d deep", name, DEPTH_MAX);
    char *source = find_source(out->dir, name);
    if (!source)
        return error_set(err, ERROR_DATA, NULL, "shader file %s not found in %s", name, out->dir ? out->dir : "the program");
    out->depth++;
    int file = ++out->file, number = 1;
    char line_directive[64];
    snprintf(line_directive, sizeof line_directive, "#line 1 %d\n", file);
    bool ok = append_string(out, line_directive) || error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
    for (const char *at = source; ok && *at; number++) {
        size_t length = strcspn(at, "\n");
        length += at[length] == '\n';
        ok = append_line(out, at, length, number, file, err);
        at += length;
    }
    out->depth--;
    free(source);
    return ok;
}

char *shader_source_load(const char *dir, const char *name, const char *defines, struct error *err)
{
    struct text out = {.dir = dir};
    bool ok = append_string(&out, "#version 450 core\n");
    for (const char *at = defines; ok && at && *at;) {
        size_t length = strcspn(at, "\n");
        ok = append_string(&out, "#define ") && append(&out, at, length) && append_string(&out, "\n");
        at += length + (at[length] == '\n');
    }
    if (!ok)
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
    ok = ok && append_file(&out, name, err) && append(&out, "\n", 2);
    if (!ok)
        array_finish(&out.bytes);
    return out.bytes.data;
}

static long long newest_in(const char *dir, int depth)
{
    long long newest = 0;
    DIR *d = opendir(dir);
    if (!d)
        return 0;
    for (struct dirent *e; (e = readdir(d));) {
        char path[1024];
        struct stat st;
        snprintf(path, sizeof path, "%s/%s", dir, e->d_name);
        if (e->d_name[0] == '.' || stat(path, &st))
            continue;
        long long t = (long long)st.st_mtim.tv_sec * 1000000000 + st.st_mtim.tv_nsec;
        if (S_ISDIR(st.st_mode))
            t = depth > 0 ? newest_in(path, depth - 1) : 0;
        newest = t > newest ? t : newest;
    }
    closedir(d);
    return newest;
}

long long shader_source_newest(const char *dir) { return newest_in(dir, 1); }
