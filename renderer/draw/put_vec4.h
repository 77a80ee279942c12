/* A double vector into a uniform block (shaders/blocks.h). */
#pragma once

#include "base/dmath.h"
#include "blocks.h"

static inline void put_vec4(vec4 out, struct dvec3 v, double w)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
    out[3] = (float)w;
}
