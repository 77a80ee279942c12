#include <epoxy/gl.h>
#include <stdio.h>

#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "passes/gbuffer.h"
#include "shadow/depth/light_maps.h"
#include "shadow/shared_params.h"

const char *const shadow_fit_choices[] = {"tight", "cube", NULL};

bool shadow_run_full_screen(const struct shadow_input *in, const char *fragment, const char *defines, struct error *err)
{
    char all[256];
    snprintf(all, sizeof all, "LIGHT %d\n%s", (int)in->light->kind, defines ? defines : "");
    struct gl_program *program = gl_programs_get(in->gl->programs, "full_screen.vert", fragment, all, err);
    if (!program)
        return false;
    gl_program_use(program);
    gbuffer_bind(in->gbuffer, in->draw);
    tiles_draw(&in->gbuffer->tiles, in->draw->vertex_array);
    return gl_check(in->gl, err);
}

bool shadow_run_with_maps(struct light_maps *maps, const struct shadow_input *in, const char *fragment, struct error *err)
{
    char defines[64];
    if (maps->fit.map_count == 0)
        return shadow_run_full_screen(in, "none.frag", NULL, err);
    snprintf(defines, sizeof defines, "MAPS %u\nMAP_PERSPECTIVE %d\n", maps->fit.map_count, !maps->fit.maps[0].orthographic);
    return light_maps_bind(maps, in, err) && shadow_run_full_screen(in, fragment, defines, err);
}
