/* How failure is told. Three kinds, never mixed:
 *   a bug              -> assert();
 *   bad input          -> error_set() with one clear sentence, a code and the offending field;
 *   an expected answer -> a return value.
 *
 * A function that can fail takes a `struct error *` last and returns false (or NULL) after error_set().
 * The caller owns the struct; `err` may not be NULL. The first error set wins: later calls keep it. */
#pragma once

#include <stdbool.h>

/* Values are the process exit codes of the command line (sysexits.h where one exists). */
enum error_code {
    ERROR_NONE = 0,
    ERROR_USAGE = 64,     /* wrong option, parameter or request */
    ERROR_DATA = 65,      /* bad scene or image data, or a file that a scene names is missing, unreadable or outside its folder */
    ERROR_NO_INPUT = 66,  /* the scene argument itself does not exist */
    ERROR_NO_DEVICE = 69, /* no usable GL device */
    ERROR_BUG = 70,       /* ours: please report */
    ERROR_IO = 74,        /* reading or writing failed */
    ERROR_TRY_AGAIN = 75, /* device lost, server busy */
};

struct error {
    enum error_code code;
    char message[480]; /* one sentence: what, where, and what would be accepted; no newline */
    char field[64];    /* the option, parameter or JSON member at fault, "" if none */
};

/* Always returns false, so that `return error_set(...)` reads well. `field` may be NULL. Control characters in the
 * formatted text become '?'; a longer text is cut at a UTF-8 boundary. */
bool error_set(struct error *err, enum error_code code, const char *field, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Puts "format: " before the message that `err` already holds. Returns false. */
bool error_prefix(struct error *err, const char *format, ...) __attribute__((format(printf, 2, 3)));
