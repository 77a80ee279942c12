/* One frame's work for one light, cut into tiles that any thread may take. The tiles' code is compiled once an instruction set
 * (tile_*.c); which one runs changes no result, since every decision is certain. */
#pragma once

#include "exact/bins.h"
#include "exact/light_grid.h"
#include "exact/lines.h"
#include "exact/slow.h"

enum {
    TILE_PIXELS = TILE_SIDE * TILE_SIDE,
    OCCLUDERS_KEPT = 1024,
    MASKED_KEPT = 1024,
    RECEIVERS_KEPT = 512,
    CANDIDATES_MAX = 12
};

struct tile_job {
    const struct triangles *triangles;
    const struct light_grid *grid;
    const struct light *light;
    const struct view *view;
    struct exact_apex to_light;
    struct screen screen;
    const struct bins *bins;   /* 32 samples */
    const uint32_t *ids;       /* 1 sample */
    uint32_t *receivers, *lit; /* masks, 32 samples */
    float *visibility;
    struct tile_scratch *scratch; /* one a thread */
};

/* A triangle that may shadow others: its lines on the picture, turned so that all four are positive where it does, on planes whose F is
 * negative; scaled to about 1. */
struct occluder {
    struct lines lines;
    uint32_t id;
    int side; /* the light's; 0: it shadows nothing */
};

/* A triangle with a mask, as an occluder or as what the camera sees. */
struct masked {
    uint32_t id;
    struct hole_map map;
    struct dvec3 a; /* first corner */
    double e1, e2;  /* sums of the absolute components of b - a, c - a */
    lane4 unscale;  /* what brings its lines back to the forms' own measure */
};

/* Triangles that together shadowed all samples of a pixel. */
enum { BLOCKERS_KEPT = 8 };
struct blockers {
    unsigned count;
    uint32_t ids[BLOCKERS_KEPT];
};

/* A triangle that is seen: its plane's form, turned so that F is negative, scaled to about 1. */
struct receiver {
    uint32_t id;
    bool certain; /* the sign of F is known */
    bool faces;   /* if certain: it faces the light where the camera sees it */
    double fixed, v, vx, vy, fixed_size, v_size;
    lane4 edge, edge_x, edge_y,
        edge_error;        /* its edges in the picture: positive inside, or negative, all three; lane 3 nothing */
    struct forms to_light; /* seen from the light: positive inside its edges, and on the light's side of its plane */
    int side;              /* the light's: -1, 0, 1; -2: not known yet */
    bool sees_light;       /* to_light is known */
    bool boxed;            /* the next two are known: receiver_boxes() */
    unsigned faces_met;    /* bit a face of the grid */
    struct light_box boxes[LIGHT_FACES_MAX];
    struct blockers recent; /* of its last pixel that was shadowed wholly */
    int candidate_count;    /* what may shadow its points in `candidate_area`, or CANDIDATES_MANY: ask the grid */
    uint32_t candidate_area;
    uint32_t crowded_tile; /* the last tile with too many candidates */
    uint32_t candidates[CANDIDATES_MAX];
};
enum { CANDIDATES_MANY = -1 };

/* Areas of the picture whose pixels share a receiver's candidates: all of it, a tile, or a block of BLOCK_SIDE x BLOCK_SIDE pixels. */
enum { BLOCK_SIDE = 4, BLOCKS_PER_ROW = TILE_SIDE / BLOCK_SIDE, AREAS_PER_TILE = 1 + BLOCKS_PER_ROW * BLOCKS_PER_ROW };
#define AREA_PICTURE (UINT32_MAX - 1)
#define AREA_NONE    UINT32_MAX

struct tile_counts {
    uint64_t receivers; /* samples that may receive */
    uint64_t tests;     /* occluders against a pixel's samples */
    uint64_t undecided; /* samples that single precision left */
    uint64_t exact;     /* decided in integers */
};

struct tile_scratch {
    float x[32], y[32]; /* view_samples32 */
    float key[TILE_PIXELS][32];
    uint32_t id[TILE_PIXELS][32];
    float key_error[TILE_PIXELS]; /* of any key of the pixel */
    float farthest[TILE_PIXELS];  /* not more than any key of the pixel; INFINITY outside the picture */
    float column[TILE_SIDE];      /* 0, 1, 2 ... */
    struct occluder occluders[OCCLUDERS_KEPT];
    struct masked masked[MASKED_KEPT]; /* of occluders */
    struct masked shown_mask;
    struct receiver seen[RECEIVERS_KEPT];
    struct slow slow;
    struct tile_counts counts;
    struct bin_entry *order; /* of a tile: room for bins.most */
    size_t order_room;
};

typedef void tile_function(void *job, size_t index, unsigned worker);
struct tile_kernel {
    tile_function *samples32, *point; /* of struct tile_job, for job_pool_for() */
};

extern const struct tile_kernel tile_plain, tile_avx2, tile_avx512;
