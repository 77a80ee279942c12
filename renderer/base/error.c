#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void clean(char *text)
{
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
}

/* A cut may fall inside a UTF-8 sequence: drop its head. */
static void end_at_character(char *text, size_t capacity)
{
    size_t length = strlen(text);
    if (length + 1 < capacity)
        return;
    size_t start = length;
    while (start > 0 && ((unsigned char)text[start - 1] & 0xc0) == 0x80)
        start--;
    if (start == 0)
        return;
    unsigned char lead = (unsigned char)text[start - 1];
    size_t wanted = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 1;
    if (length - (start - 1) < wanted)
        text[start - 1] = 0;
}

bool error_set(struct error *err, enum error_code code, const char *field, const char *format, ...)
{
    if (err->code != ERROR_NONE)
        return false;
    va_list args;
    va_start(args, format);
    vsnprintf(err->message, sizeof err->message, format, args);
    va_end(args);
    clean(err->message);
    end_at_character(err->message, sizeof err->message);
    snprintf(err->field, sizeof err->field, "%s", field ? field : "");
    clean(err->field);
    err->code = code;
    return false;
}

bool error_prefix(struct error *err, const char *format, ...)
{
    char text[sizeof err->message];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    size_t used = n < 0 ? 0 : (size_t)n < sizeof text ? (size_t)n : sizeof text - 1;
    bool cut = (size_t)snprintf(text + used, sizeof text - used, ": %s", err->message) >= sizeof text - used;
    memcpy(err->message, text, sizeof text);
    clean(err->message);
    if (cut)
        end_at_character(err->message, sizeof err->message);
    return false;
}
