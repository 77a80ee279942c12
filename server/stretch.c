#include "stretch.h"

bool stretch_report(void *context, double done)
{
    const struct stretch *s = context;
    return !s->progress || s->progress->report(s->progress->context, s->from + s->share * done);
}
