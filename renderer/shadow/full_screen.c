#include <epoxy/gl.h>

#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "passes/gbuffer.h"
#include "shadow/shared_params.h"

const char *const shadow_fit_choices[] = {"tight", "cube", NULL};

bool shadow_run_full_screen(const struct shadow_input *in, const char *fragment, const char *defines, struct error *err)
{
    struct gl_program *program = gl_programs_get(in->gl->programs, "full_screen.vert", fragment, defines, err);
    if (!program)
        return false;
    gl_program_use(program);
    glBindVertexArray(in->draw->vertex_array);
    gbuffer_bind(in->gbuffer, in->draw);
    gl_draw_full_screen();
    return gl_check(in->gl, err);
}
