/* Text of a shader: a file of shaders/ with its includes and definitions put in. */
#pragma once

struct error;

/* From `dir`, or the built-in files when NULL. The result is malloc'd. NULL with err: no such file, or includes nested more than 8 deep. */
char *shader_source_load(const char *dir, const char *name, const char *defines, struct error *err);

/* Newest modification time of a file in `dir` (one level of folders deep), ns since the epoch; 0 if there is none. */
long long shader_source_newest(const char *dir);
