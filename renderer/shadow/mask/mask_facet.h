/* The shadow that a contour map casts on one pixel: the pixel's facet (the receiver's plane over the pixel's square) against the faces listed
 * where the facet falls on the map. Per face four half-planes of the picture (three edges seen from the light, the face's own plane), each
 * looked up as a mask; AND within a face, OR over faces. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "shadow/mask/mask_contour.h"
#include "shadow/mask/mask_table.h"

/* A map with its depths, for one picture: along the map's axes, relative to its eye. */
struct mask_map {
    const struct mask_contour *contour;
    const float *depths; /* size * size; encoding: shaders/maps.glsl */
    float row[3][4];     /* map axes from camera-relative */
    float scale_x, scale_y, offset_x, offset_y;
    float near, far, texel; /* texel: world size at depth 1 (perspective) or anywhere */
    bool orthographic;
};

/* All vectors along the map's axes. */
struct mask_facet {
    float point[3];             /* of the pixel's centre, relative to the map's eye */
    float normal[3];            /* unit, away from the camera */
    float dx[3], dy[3], kx, ky; /* the facet's point at (X, Y) pixels off centre: point + (X dx + Y dy) / (1 + kx X + ky Y) */
    float to_light[3];          /* unit */
    float bias;                 /* by which an occluder must be nearer to the light, along the way there: in the plain test, */
    float face_bias;            /* and of a listed face */
    uint32_t id;                /* the receiver's own triangle */
};

/* What the pixel loop counts. */
struct mask_counts {
    uint64_t receivers, contour; /* pixels; of those, on the contour */
    uint64_t faces;              /* looked at */
};

/* Bits of the samples that are shadowed. */
uint32_t mask_facet_shadow(const struct mask_table *table, const struct mask_map *map, const struct mask_facet *facet,
                           struct mask_counts *counts);
