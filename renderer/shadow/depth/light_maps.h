/* A light's depth maps: the tool that every system built on plain depth shares. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "draw/draw_view.h"
#include "gl/buffer.h"
#include "gl/texture.h"
#include "shadow/depth/map_raster.h"
#include "shadow/shadow.h"

/* Floats that may be read past the last texel. */
#define LIGHT_MAPS_PAST 8

struct light_maps {
    struct gl_texture
        depth; /* D32F array, a layer a map; encoding: shaders/maps.glsl. On the CPU: one layer, if GL rasterized; else nothing */
    float *texels; /* on the CPU: all maps, row 0 at the top, else NULL; owned */
    size_t texel_room;
    struct map_raster raster; /* on the CPU */
    struct gl_target target;
    struct draw_view draw;
    struct gl_buffer block; /* maps_block, relative to the camera of the last bind */
    struct shadow_fit fit;  /* as rendered; casters not kept */
};

/* A system whose state is one struct light_maps names these three in its descriptor. prepare renders all maps of in->fit, to the CPU if
 * in->resolve_on_cpu. */
bool light_maps_prepare(void *maps, const struct shadow_input *in, struct error *err);
size_t light_maps_bytes(const void *maps);
void light_maps_finish(void *maps);

/* prepare to the CPU, whatever in->resolve_on_cpu says. */
bool light_maps_prepare_on_cpu(struct light_maps *maps, const struct shadow_input *in, struct error *err);

/* Depths along the axis of `view` (INFINITY: none) to what a depth buffer would hold (shaders/maps.glsl), in place. */
void light_maps_encode(const struct view *view, float *texels, size_t count);

/* Makes them what shaders/maps.glsl reads, relative to in->view. */
bool light_maps_bind(struct light_maps *m, const struct shadow_input *in, struct error *err);
