#include "shadow/depth/map_ranges.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

#include "blocks.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"
#include "shadow/depth/light_maps.h"

static bool run(struct map_ranges *r, const struct shadow_input *in, const struct gl_texture *to, unsigned step, unsigned layer,
                struct error *err)
{
    char defines[64];
    snprintf(defines, sizeof defines, "STEP %u\nBLOCK_SIDE %u\nLAYER %u\n", step, r->block, layer);
    struct gl_program *program = gl_programs_get(in->gl->programs, "full_screen.vert", "map_ranges.frag", defines, err);
    if (!program)
        return false;
    gl_program_use(program);
    gl_target_attach(&r->target, to, NULL, layer);
    gl_target_bind(&r->target, to->width, to->height);
    glBindVertexArray(in->draw->vertex_array);
    gl_draw_full_screen();
    return gl_check(in->gl, err);
}

bool map_ranges_prepare(struct map_ranges *r, const struct light_maps *maps, const struct shadow_input *in, uint32_t block,
                        struct error *err)
{
    unsigned count = maps->fit.map_count;
    if (count == 0)
        return true;
    uint32_t side = (maps->depth.width + block - 1) / block;
    r->block = block;
    if (!gl_texture_size_layers(&r->own, in->gl, GL_RG32F, side, side, count, err) ||
        !gl_texture_size_layers(&r->ranges, in->gl, GL_RG32F, side, side, count, err))
        return false;
    gl_texture_bind(&maps->depth, UNIT_SHADOW_MAP);
    gl_texture_bind(&r->own, UNIT_MAP_RANGES);
    for (unsigned step = 0; step < 2; step++)
        for (unsigned i = 0; i < count; i++)
            if (!run(r, in, step ? &r->ranges : &r->own, step, i, err))
                return false;
    return true;
}

void map_ranges_bind(const struct map_ranges *r) { gl_texture_bind(&r->ranges, UNIT_MAP_RANGES); }

size_t map_ranges_bytes(const struct map_ranges *r) { return r->own.bytes + r->ranges.bytes; }

void map_ranges_finish(struct map_ranges *r)
{
    gl_texture_finish(&r->own);
    gl_texture_finish(&r->ranges);
    gl_target_finish(&r->target);
    memset(r, 0, sizeof *r);
}
