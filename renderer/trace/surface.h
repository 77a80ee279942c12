/* What is to be known of the surface at a hit, textures apart. */
#pragma once

#include "scene/pixel.h"
#include "trace/rays.h"

/* An instance's share of it, laid out for the hit loop. */
struct surface {
    const float (*normals)[3]; /* of the mesh's first vertex */
    const float (*colors)[4];  /* NULL: none */
    const uint32_t *indices;   /* of its first triangle */
    float cofactor[3][3];      /* takes mesh normals to scene space */
    float base_color[3], roughness;
    uint32_t metallic, color; /* packed (scene/pixel.h); color where there are no vertex colours */
};

/* One an instance; malloc'd, NULL when memory is out. */
struct surface *surfaces_create(const struct scene *scene);

/* Pixels of the packet's hits; zero where there is none. facing: Ng . direction; start: depth at t = 0. False if there is no hit. */
bool surface_pixels(const struct surface *surfaces, const struct RTCRayHit16 *packet, const float facing[LANES], float start,
                    struct pixel out[LANES]);
