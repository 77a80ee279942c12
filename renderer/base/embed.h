/* Files built into the program by embed_files() in CMakeLists.txt. */
#pragma once

struct embedded_file {
    const char *name; /* relative path; NULL ends a table */
    const char *data; /* followed by a zero byte that `end` counts */
    const char *end;  /* size = end - data - 1 */
};

extern const struct embedded_file embedded_shaders[];
extern const struct embedded_file embedded_web[];
extern const struct embedded_file embedded_report[]; /* report.css of server/bench */
