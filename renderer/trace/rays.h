/* Camera rays in packets of sixteen, and what comes back of them. */
#pragma once

#include "trace/tree.h"

/* A packet is PACKET x PACKET picture positions, row by row; a job is TILE x TILE of them. */
enum { PACKET = 4, LANES = PACKET * PACKET, TILE = 32 };

/* Pixels of one job, clipped to the picture. */
struct tile {
    uint32_t x, y, width, height;
};

size_t tile_count(const struct view *view);
struct tile tile_at(const struct view *view, size_t index);

/* view_ray() as a linear function of the picture position, in double; rays are rounded to fp32 one by one. What differs between the rays
 * of a picture is the direction (perspective) or the origin (orthographic): `varying`. */
struct ray_frame {
    bool orthographic;
    struct dvec3 shared;          /* the origin, or the direction */
    struct dvec3 varying, dx, dy; /* at picture position (0, 0), and per pixel */
    double start;                 /* depth at t = 0 */
    float tnear, tfar;
};

/* Where the rays of a packet lie, relative to the packet's picture position. */
struct ray_offsets {
    double x[LANES], y[LANES], z[LANES];
};

struct ray_frame ray_frame_make(const struct view *view);

/* Sixteen positions in pixels. */
struct ray_offsets ray_offsets_make(const struct ray_frame *f, const float (*positions)[2]);
/* The centres of PACKET x PACKET pixels, row by row. */
struct ray_offsets ray_offsets_pixels(const struct ray_frame *f);

/* Sets what all packets of a frame share. */
void ray_frame_start(const struct ray_frame *f, struct RTCRayHit16 *packet);
/* Sets the packet at picture position (x, y). */
void ray_frame_packet(const struct ray_frame *f, const struct ray_offsets *offsets, double x, double y,
                      struct RTCRayHit16 *packet);

/* -1 for the lanes of the packet at pixel (x, y) that lie in the tile, else 0. True when all do. */
bool tile_lanes(const struct tile *tile, uint32_t x, uint32_t y, int valid[LANES]);

/* Drawn-triangle ids of sixteen hits; SCENE_NONE where there is none. */
void hit_ids(const struct tracer *t, const struct RTCHit16 *hit, uint32_t ids[LANES]);

/* Nearest hits as the camera sees them: back faces of one-sided materials are passed through (by a second, filtering query of the rays
 * that met one: filters on everything would cost every ray). facing: Ng . direction of each hit. */
void trace_visible(const struct tracer *t, const int valid[LANES], float tfar, struct RTCRayHit16 *packet, float facing[LANES]);
