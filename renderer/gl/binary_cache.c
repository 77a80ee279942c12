#include "gl/binary_cache.h"

#include <epoxy/gl.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"

#define BINARY_MAX (64u << 20)

/* FNV-1a, 64 bits (Fowler, Noll, Vo): the hash only has to name files. */
static uint64_t hash(uint64_t h, const char *text)
{
    for (; text && *text; text++)
        h = (h ^ (unsigned char)*text) * 0x100000001b3u;
    return (h ^ 0xff) * 0x100000001b3u;
}

uint64_t binary_cache_key(const char *device, const char *first, const char *second)
{
    return hash(hash(hash(hash(0xcbf29ce484222325u, GNOMON_VERSION), device), first), second);
}

static void file_name(char *out, size_t size, const char *dir, uint64_t key)
{
    snprintf(out, size, "%s/%016llx.bin", dir, (unsigned long long)key);
}

static unsigned link_binary(GLenum format, const void *data, size_t size)
{
    GLuint id = glCreateProgram();
    glProgramBinary(id, format, data, (GLsizei)size);
    GLint ok = 0;
    glGetProgramiv(id, GL_LINK_STATUS, &ok);
    if (ok)
        return id;
    glDeleteProgram(id);
    while (glGetError() != GL_NO_ERROR)
        ;
    return 0;
}

unsigned binary_cache_load(const char *dir, uint64_t key)
{
    char path[1024];
    file_name(path, sizeof path, dir, key);
    FILE *f = fopen(path, "rb");
    if (!f)
        return 0;
    unsigned id = 0;
    GLenum format;
    struct stat st;
    if (fstat(fileno(f), &st) == 0 && st.st_size > (off_t)sizeof format && st.st_size < (off_t)BINARY_MAX &&
        fread(&format, sizeof format, 1, f) == 1) {
        size_t size = (size_t)st.st_size - sizeof format;
        void *data = malloc(size);
        if (data && fread(data, size, 1, f) == 1)
            id = link_binary(format, data, size);
        free(data);
    }
    fclose(f);
    return id;
}

static void make_directories(const char *dir)
{
    char path[1024];
    snprintf(path, sizeof path, "%s", dir);
    for (char *at = path + 1; *at; at++)
        if (*at == '/') {
            *at = 0;
            mkdir(path, 0700);
            *at = '/';
        }
    mkdir(path, 0700);
}

void binary_cache_store(const char *dir, uint64_t key, unsigned program)
{
    GLint size = 0;
    glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &size);
    if (size <= 0 || (unsigned)size >= BINARY_MAX)
        return;
    void *data = malloc((size_t)size);
    GLenum format = 0;
    if (!data)
        return;
    glGetProgramBinary(program, size, &size, &format, data);
    make_directories(dir);
    char path[1024], temporary[1100];
    file_name(path, sizeof path, dir, key);
    snprintf(temporary, sizeof temporary, "%s.tmp-%d", path, (int)getpid());
    FILE *f = fopen(temporary, "wb");
    bool ok = f && fwrite(&format, sizeof format, 1, f) == 1 && fwrite(data, (size_t)size, 1, f) == 1;
    if (f && fclose(f))
        ok = false;
    if (!ok || rename(temporary, path)) {
        log_debug("no shader cache in %s: %s", dir, strerror(errno));
        unlink(temporary);
    }
    free(data);
}
