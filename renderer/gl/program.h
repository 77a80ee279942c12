/* Shader programs from the files of shaders/: built in, or read from a directory and reloaded when they change.
 * `#include "file"` is resolved here; line numbers in compile errors are those of the files. Linked binaries are cached on disk. */
#pragma once

#include <stdbool.h>

struct error;
struct gl_context;

/* All programs of one context. */
struct gl_programs;

/* shader_dir NULL: the built-in files. cache_dir NULL: no binary cache. Strings are copied. */
struct gl_programs *gl_programs_create(struct gl_context *gl, const char *shader_dir, const char *cache_dir, struct error *err);
void gl_programs_destroy(struct gl_programs *programs);

/* The program made of these files (vertex and fragment, or compute alone: `fragment` NULL) with `defines` ("NAME VALUE\n..." or NULL) put
 * before them. Made once and shared; lives as long as `programs`. ERROR_BUG (built-in) or ERROR_DATA (shader_dir) with the first line
 * of the log; the assembled source goes to the log. */
struct gl_program *gl_programs_get(struct gl_programs *programs, const char *vertex_or_compute, const char *fragment,
                                   const char *defines, struct error *err);

/* Makes it current. */
void gl_program_use(const struct gl_program *program);

/* They come from a shader_dir. */
bool gl_programs_are_files(const struct gl_programs *programs);

/* With a shader_dir: relinks the programs whose files changed; a program that fails keeps its old form and its log is shown.
 * True when any changed. */
bool gl_programs_reload(struct gl_programs *programs);
