/* The shadow's edge as a polyline: marching squares (Lorensen and Cline 1987, in the plane) at V = 0.5 over pixel centres, linear between
 * them. Only cells whose four corners are receivers have a contour: the picture's own silhouettes are no shadow edges. In a saddle the
 * corners' mean says which pair is joined. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct contours {
    uint32_t width, height;
    const float *tested, *reference; /* [0,1] */
    const uint8_t *receiver;
};

#define CONTOUR_CAP 8 /* pixels: distances count no more */

/* Distances in 1/32 px from every vertex of the reference's contour to the tested contour, appended to *shifts (realloc'd, *count of
 * them); *farthest: the largest distance either way (symmetric Hausdorff, taken at vertices). False when memory is out. */
bool contour_shifts(const struct contours *c, float **shifts, size_t *count, double *farthest);
