#include "numbers.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

/* strtod() also takes white space, hexadecimal, "inf" and "nan": none of them is a number here. */
static bool parse_double(const char *text, const char **end, double *out)
{
    const char *first = text + (*text == '-' || *text == '+');
    if (!isdigit((unsigned char)first[0]) && !(first[0] == '.' && isdigit((unsigned char)first[1])))
        return false;
    if (first[0] == '0' && (first[1] == 'x' || first[1] == 'X'))
        return false;
    char *stop;
    *out = strtod(text, &stop);
    *end = stop;
    return isfinite(*out);
}

bool number_parse(const char *text, double min, double max, double *out)
{
    const char *end;
    double value;
    if (!parse_double(text, &end, &value) || *end || value < min || value > max)
        return false;
    *out = value;
    return true;
}

bool number_parse_unsigned(const char *text, unsigned long min, unsigned long max, unsigned long *out)
{
    if (!*text)
        return false;
    for (const char *c = text; *c; c++)
        if (!isdigit((unsigned char)*c))
            return false;
    errno = 0;
    unsigned long value = strtoul(text, NULL, 10);
    if (errno || value < min || value > max)
        return false;
    *out = value;
    return true;
}

bool number_parse_list(const char *text, double *out, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const char *end;
        if (!parse_double(text, &end, &out[i]))
            return false;
        if (*end != (i + 1 < count ? ',' : 0))
            return false;
        text = end + 1;
    }
    return true;
}

bool number_parse_size(const char *text, uint32_t limit, uint32_t *width, uint32_t *height, struct error *err)
{
    char copy[32];
    unsigned long w, h;
    snprintf(copy, sizeof copy, "%s", text);
    char *x = strchr(copy, 'x');
    if (x)
        *x = 0;
    if (!x || strlen(text) >= sizeof copy || !number_parse_unsigned(copy, 1, limit, &w) ||
        !number_parse_unsigned(x + 1, 1, limit, &h))
        return error_set(err, ERROR_USAGE, "size",
                         "not a size; WIDTHxHEIGHT in pixels is accepted, each 1 to %u, such as 1280x720", limit);
    *width = (uint32_t)w;
    *height = (uint32_t)h;
    return true;
}

bool number_parse_point(const char *text, struct dvec3 *out, struct error *err)
{
    double v[3];
    if (!number_parse_list(text, v, 3))
        return error_set(err, ERROR_USAGE, NULL, "not a point; three finite numbers x,y,z are accepted, such as 0,1.5,-2");
    *out = dvec3(v[0], v[1], v[2]);
    return true;
}

int name_index(const char *const *names, const char *text)
{
    for (int i = 0; names[i]; i++)
        if (!strcmp(names[i], text))
            return i;
    return -1;
}

void name_list(const char *const *names, char *out, size_t size)
{
    size_t used = 0;
    out[0] = 0;
    for (size_t i = 0; names[i] && used < size; i++) {
        const char *separator = i == 0 ? "" : names[i + 1] ? ", " : " or ";
        int n = snprintf(out + used, size - used, "%s%s", separator, names[i]);
        used += n > 0 ? (size_t)n : 0;
    }
}
