#include "draw/producer.h"

#include "gl/context.h"

bool producer_prefers_tracing(const struct gl_caps *caps, size_t triangles, size_t rays)
{
    return caps->software && triangles > rays / 20;
}
