#include "gl/program.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"
#include "base/log.h"
#include "gl/binary_cache.h"
#include "gl/context.h"
#include "gl/shader_source.h"

struct gl_program {
    GLuint id;
    char *vertex_or_compute, *fragment, *defines; /* fragment NULL: compute */
    struct gl_program *next;
};

struct gl_programs {
    struct gl_context *gl;
    char *shader_dir, *cache_dir; /* may be NULL */
    struct gl_program *first;
    long long newest; /* newest modification time seen in shader_dir, ns */
};

static char *copy(const char *text) { return text ? strdup(text) : NULL; }

struct gl_programs *gl_programs_create(struct gl_context *gl, const char *shader_dir, const char *cache_dir, struct error *err)
{
    struct stat st;
    if (shader_dir && (stat(shader_dir, &st) || !S_ISDIR(st.st_mode))) {
        error_set(err, ERROR_USAGE, "shader-dir", "--shader-dir %s is not a directory", shader_dir);
        return NULL;
    }
    struct gl_programs *programs = calloc(1, sizeof *programs);
    if (!programs) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
        return NULL;
    }
    programs->gl = gl;
    programs->shader_dir = copy(shader_dir);
    programs->cache_dir = copy(cache_dir);
    programs->newest = shader_dir ? shader_source_newest(shader_dir) : 0;
    gl->programs = programs;
    return programs;
}

void gl_programs_destroy(struct gl_programs *programs)
{
    if (!programs)
        return;
    for (struct gl_program *p = programs->first, *next; p; p = next) {
        next = p->next;
        glDeleteProgram(p->id);
        free(p->vertex_or_compute);
        free(p->fragment);
        free(p->defines);
        free(p);
    }
    programs->gl->programs = NULL;
    free(programs->shader_dir);
    free(programs->cache_dir);
    free(programs);
}

static void log_numbered(const char *source)
{
    int line = 1;
    for (const char *at = source; *at; line++) {
        size_t length = strcspn(at, "\n");
        log_info("%4d| %.*s", line, (int)length, at);
        at += length + (at[length] == '\n');
    }
}

static GLuint compile(GLenum stage, const char *name, const char *source, enum error_code code, struct error *err)
{
    GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    GLint ok;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok)
        return shader;
    char text[4096];
    glGetShaderInfoLog(shader, sizeof text, NULL, text);
    glDeleteShader(shader);
    log_numbered(source);
    log_warning("%s: %s", name, text);
    error_set(err, code, NULL, "shader %s does not compile: %.*s", name, (int)strcspn(text, "\n"), text);
    return 0;
}

static GLuint link_sources(char *const sources[2], const struct gl_program *p, enum error_code code, struct error *err)
{
    const char *names[2] = {p->vertex_or_compute, p->fragment};
    GLenum stages[2] = {p->fragment ? GL_VERTEX_SHADER : GL_COMPUTE_SHADER, GL_FRAGMENT_SHADER};
    GLuint id = glCreateProgram();
    glProgramParameteri(id, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
    for (int i = 0; i < (p->fragment ? 2 : 1); i++) {
        GLuint shader = compile(stages[i], names[i], sources[i], code, err);
        if (!shader) {
            glDeleteProgram(id);
            return 0;
        }
        glAttachShader(id, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(id);
    GLint ok;
    glGetProgramiv(id, GL_LINK_STATUS, &ok);
    if (ok)
        return id;
    char text[4096];
    glGetProgramInfoLog(id, sizeof text, NULL, text);
    glDeleteProgram(id);
    log_warning("%s + %s: %s", names[0], names[1] ? names[1] : "-", text);
    error_set(err, code, NULL, "shaders %s and %s do not link: %.*s", names[0], names[1] ? names[1] : "-",
              (int)strcspn(text, "\n"), text);
    return 0;
}

static GLuint build(struct gl_programs *programs, const struct gl_program *p, struct error *err)
{
    enum error_code code = programs->shader_dir ? ERROR_DATA : ERROR_BUG;
    char *sources[2] = {0};
    GLuint id = 0;
    sources[0] = shader_source_load(programs->shader_dir, p->vertex_or_compute, p->defines, err);
    if (!sources[0])
        goto out;
    if (p->fragment && !(sources[1] = shader_source_load(programs->shader_dir, p->fragment, p->defines, err)))
        goto out;
    uint64_t key = binary_cache_key(programs->gl->cache_key, sources[0], sources[1]);
    if (programs->cache_dir && (id = binary_cache_load(programs->cache_dir, key)))
        goto out;
    id = link_sources(sources, p, code, err);
    if (id && programs->cache_dir)
        binary_cache_store(programs->cache_dir, key, id);
out:
    free(sources[0]);
    free(sources[1]);
    return id;
}

static bool same(const char *a, const char *b) { return a && b ? strcmp(a, b) == 0 : a == b; }

struct gl_program *gl_programs_get(struct gl_programs *programs, const char *vertex_or_compute, const char *fragment,
                                   const char *defines, struct error *err)
{
    for (struct gl_program *p = programs->first; p; p = p->next)
        if (same(p->vertex_or_compute, vertex_or_compute) && same(p->fragment, fragment) && same(p->defines, defines))
            return p;
    struct gl_program *p = calloc(1, sizeof *p);
    if (!p) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
        return NULL;
    }
    p->vertex_or_compute = copy(vertex_or_compute);
    p->fragment = copy(fragment);
    p->defines = copy(defines);
    p->id = build(programs, p, err);
    if (!p->id) {
        free(p->vertex_or_compute);
        free(p->fragment);
        free(p->defines);
        free(p);
        return NULL;
    }
    p->next = programs->first;
    programs->first = p;
    return p;
}

void gl_program_use(const struct gl_program *program) { glUseProgram(program->id); }

bool gl_programs_reload(struct gl_programs *programs)
{
    if (!programs->shader_dir)
        return false;
    long long newest = shader_source_newest(programs->shader_dir);
    if (newest == programs->newest)
        return false;
    programs->newest = newest;
    for (struct gl_program *p = programs->first; p; p = p->next) {
        struct error err = {0};
        GLuint id = build(programs, p, &err);
        if (id) {
            glDeleteProgram(p->id);
            p->id = id;
        } else {
            log_warning("%s; the old program stays in use", err.message);
        }
    }
    return true;
}

bool gl_programs_are_files(const struct gl_programs *programs) { return programs->shader_dir != NULL; }
