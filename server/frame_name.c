#include "frame_name.h"

#include <stdio.h>
#include <string.h>

bool frame_name(const char *pattern, unsigned frame, char *out, size_t size)
{
    const char *slash = strrchr(pattern, '/'), *name = slash ? slash + 1 : pattern;
    const char *last = strrchr(name, '#'), *first = last;
    while (first && first > name && first[-1] == '#')
        first--;
    if (!first)
        return false;
    int digits = (int)(last - first) + 1;
    return snprintf(out, size, "%.*s%0*u%s", (int)(first - pattern), pattern, digits, frame, last + 1) < (int)size;
}
