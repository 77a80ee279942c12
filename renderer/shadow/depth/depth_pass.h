/* From pixels to visibility by depth maps, on the CPU: what sm, pcf, apcf and soft end in where the GL device is a CPU as well
 * (draw/producer.h). A software rasterizer runs both sides of a shader's branches and fetches texel by texel; here eight pixels go together, and
 * what none of them needs is left out. The loops are compiled once an instruction set (depth_plain.c, depth_avx*.c), to the same bits.
 *
 * The arithmetic is that of shaders/receiver.glsl and shaders/maps.glsl, but for roundings. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "shadow/depth/light_maps.h"
#include "shadow/pixel_pass.h"
#include "shadow/shadow.h"

struct pixel;

enum {
    DEPTH_ROWS = 16,     /* picture rows a job */
    DEPTH_COLUMNS = 256, /* worked on together: what they read of a map stays near */
};

/* A map as maps_block has it (shaders/blocks.h). */
struct depth_map {
    float row[3][4];
    float scale_x, scale_y, offset_x, offset_y;
    float near, range, far; /* range: far - near */
    float texel;            /* world size, at depth 1 if perspective */
};

enum depth_filter {
    DEPTH_ONE,      /* the point's own texel */
    DEPTH_SQUARE,   /* the weighted share of a square of texels that see the point */
    DEPTH_ADAPTIVE, /* the same where the square's corners differ; where they agree, they decide */
};

enum { DEPTH_SIDE_MAX = 31, DEPTH_WEIGHT_LANES = (DEPTH_SIDE_MAX + 7) / 8 * 8 };

/* The weights of a square, rows of whole vectors: 0 beyond its side. */
struct depth_square {
    int side; /* texels, odd */
    int32_t total;
    int32_t weight[DEPTH_SIDE_MAX][DEPTH_WEIGHT_LANES] __attribute__((aligned(32)));
};

/* One light of one picture at work. Everything is relative to the camera's eye. */
struct depth_job {
    const struct pixel *pixels;
    float *visibility;
    uint32_t width, height;
    uint32_t top, bottom; /* the rows that hold surfaces */
    struct pixel_rays rays;
    struct pixel_light light;
    struct depth_map maps[SHADOW_MAPS_MAX];
    unsigned map_count;
    bool orthographic; /* the maps */
    int32_t side;      /* texels */
    const float *texels;
    float bias, slope;
    enum depth_filter filter;
    const struct depth_square *square;
    float umbra;                     /* what is left of the light where all is dark */
    const struct map_bounds *bounds; /* of texels; DEPTH_ADAPTIVE and struct soft_job */
};

/* For job_pool_for(). */
typedef void depth_rows(void *job, size_t index, unsigned worker);
struct depth_kernel {
    depth_rows *filter;                /* of struct depth_job, depth_job_count() of them */
    depth_rows *soft_term, *soft_blur; /* of struct soft_job (soft_pass.h), one after the other */
    depth_rows *rasterize;             /* of struct raster_job (map_raster.h): a band */
    depth_rows *bound, *bound_widen;   /* of struct bound_job (map_bounds.h): a band; one after the other */
};
extern const struct depth_kernel depth_plain, depth_avx2, depth_avx512; /* empty where the compiler has none */

/* The best that this machine runs. */
const struct depth_kernel *depth_kernel_choose(void);

size_t depth_job_count(const struct depth_job *job);

/* Pixels and light, and no map: every receiver is lit. `visibility` is pixel_values(). */
bool depth_job_begin(struct depth_job *job, const struct shadow_input *in, struct error *err);

/* All but filter, square and umbra, for a system with SHADOW_BIAS_PARAMS whose maps were prepared with in->resolve_on_cpu. */
bool depth_job_init(struct depth_job *job, const struct light_maps *maps, const struct shadow_input *in, struct error *err);

/* A map, as seen from the camera's eye. */
struct depth_map depth_map_of(const struct view *map, struct dvec3 camera_eye);

/* A square of `side` texels, all alike. */
void depth_square_flat(struct depth_square *square, int side);

/* The whole pass for systems that filter and no more. square: NULL for DEPTH_ONE. */
bool depth_pass_filter(const struct light_maps *maps, const struct shadow_input *in, enum depth_filter filter,
                       const struct depth_square *square, float umbra, struct error *err);

/* The whole pass where nothing shadows. */
bool depth_pass_lit(const struct shadow_input *in, struct error *err);
