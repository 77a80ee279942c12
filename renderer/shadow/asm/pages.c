#include "shadow/asm/pages.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "shadow/depth/light_maps.h"
#include "trace/tracer.h"

#define TEXELS (ASM_PAGE * ASM_PAGE)
/* Pages traced at a time: enough to keep every thread at work. */
#define BATCH  64

size_t asm_pages_slot_bytes(void) { return TEXELS * (sizeof(float) + sizeof(uint32_t)); }

/* The instances' rows as the rasterizer reads them come on top; they go with the scene, not with the budget, as they do for every system. */
size_t asm_pages_fixed_bytes(void) { return BATCH * asm_pages_slot_bytes(); }

size_t asm_pages_bytes(const struct asm_pages *p)
{
    return p->depths.bytes + p->ids.bytes + p->kept_bytes + (p->traced_depths ? asm_pages_fixed_bytes() : 0) + p->draw.rows.size +
           p->draw.commands.size + p->draw.block.size;
}

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, "budget", "out of memory for shadow pages");
}

static bool keep(struct asm_pages *p, uint32_t slots, struct error *err)
{
    size_t texels = (size_t)slots * TEXELS;
    p->kept_depths = calloc(texels, sizeof *p->kept_depths);
    p->kept_ids = calloc(texels, sizeof *p->kept_ids);
    if (!p->kept_depths || !p->kept_ids)
        return out_of_memory(err);
    p->kept_bytes = texels * (sizeof *p->kept_depths + sizeof *p->kept_ids);
    return true;
}

bool asm_pages_init(struct asm_pages *p, struct gl_context *gl, uint32_t slots, struct error *err)
{
    memset(p, 0, sizeof *p);
    if (!gl)
        return keep(p, slots, err);
    uint32_t width = ASM_COLUMNS * ASM_PAGE, height = slots / ASM_COLUMNS * ASM_PAGE;
    return gl_texture_size(&p->depths, gl, GL_DEPTH_COMPONENT32F, width, height, err) &&
           gl_texture_size(&p->ids, gl, GL_R32UI, width, height, err);
}

void asm_pages_finish(struct asm_pages *p)
{
    gl_texture_finish(&p->depths);
    gl_texture_finish(&p->ids);
    gl_target_finish(&p->target);
    draw_view_finish(&p->draw);
    free(p->kept_depths);
    free(p->kept_ids);
    free(p->traced_depths);
    free(p->traced_ids);
    memset(p, 0, sizeof *p);
}

static uint32_t slot_x(uint32_t slot) { return slot % ASM_COLUMNS * ASM_PAGE; }
static uint32_t slot_y(uint32_t slot) { return slot / ASM_COLUMNS * ASM_PAGE; }

static bool need_room(struct asm_pages *p, struct error *err)
{
    if (!p->traced_depths)
        p->traced_depths = malloc(BATCH * TEXELS * sizeof *p->traced_depths);
    if (!p->traced_ids)
        p->traced_ids = malloc(BATCH * TEXELS * sizeof *p->traced_ids);
    return (p->traced_depths && p->traced_ids) || out_of_memory(err);
}

static void upload(struct asm_pages *p, uint32_t slot, uint32_t width, size_t from)
{
    GLint x = (GLint)slot_x(slot), y = (GLint)slot_y(slot);
    glTextureSubImage2D(p->depths.id, 0, x, y, (GLsizei)width, ASM_PAGE, GL_DEPTH_COMPONENT, GL_FLOAT, p->traced_depths + from);
    glTextureSubImage2D(p->ids.id, 0, x, y, (GLsizei)width, ASM_PAGE, GL_RED_INTEGER, GL_UNSIGNED_INT, p->traced_ids + from);
}

/* Texels from `from` on, rows of `width`, are those of the slots from `slot` on that lie abreast. */
static void put_traced(struct asm_pages *p, uint32_t slot, uint32_t width, size_t from)
{
    if (!p->kept_depths) {
        upload(p, slot, width, from);
        return;
    }
    for (uint32_t i = 0; i < width * ASM_PAGE; i += ASM_PAGE) {
        size_t to = (slot + i % width / ASM_PAGE) * (size_t)TEXELS + i / width * ASM_PAGE;
        memcpy(p->kept_depths + to, p->traced_depths + from + i, ASM_PAGE * sizeof *p->kept_depths);
        memcpy(p->kept_ids + to, p->traced_ids + from + i, ASM_PAGE * sizeof *p->kept_ids);
    }
}

/* `views` of `width` x ASM_PAGE texels each, as many as fit. */
static void trace(struct asm_pages *p, const struct tracer *tracer, const struct view *views, size_t count, uint32_t width,
                  const struct shadow_input *in)
{
    size_t stride = (size_t)width * ASM_PAGE;
    tracer_light_views(tracer, views, count, stride, in->fit->casters, in->fit->caster_count, in->pool, p->traced_depths,
                       p->traced_ids);
    for (size_t i = 0; i < count; i++)
        light_maps_encode(&views[i], p->traced_depths + i * stride, stride);
}

static bool rasterize(struct asm_pages *p, const struct view *view, uint32_t x, uint32_t y, const struct shadow_input *in,
                      struct error *err)
{
    static const GLfloat farthest;
    static const GLuint nothing[4] = {NO_TRIANGLE, 0, 0, 0};
    GLint at[2] = {(GLint)x, (GLint)y};
    gl_target_attach(&p->target, &p->ids, &p->depths, 0);
    gl_target_bind(&p->target, p->ids.width, p->ids.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(at[0], at[1], (GLsizei)view->width, (GLsizei)view->height);
    glClearNamedFramebufferuiv(p->target.id, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(p->target.id, GL_DEPTH, 0, &farthest);
    glViewport(at[0], at[1], (GLsizei)view->width, (GLsizei)view->height);
    bool ok = draw_view_set_edges(&p->draw, in->draw, view, err) &&
              draw_view_rasterize(&p->draw, in->draw, DRAW_DEPTH_IDS, in->fit->casters, in->fit->caster_count, err);
    glDisable(GL_SCISSOR_TEST);
    return ok;
}

/* A row of pages of the root is one view. */
static struct view root_row(const struct asm_tree *tree, unsigned map, uint32_t row)
{
    struct view v = tree->maps[map];
    double height = v.bottom - v.top, top = v.top;
    v.top = top + height * row / tree->root_side;
    v.bottom = top + height * (row + ASM_PAGE) / tree->root_side;
    v.width = tree->root_side;
    v.height = ASM_PAGE;
    return v;
}

static void trace_root(struct asm_pages *p, const struct tracer *tracer, const struct asm_tree *tree, unsigned map,
                       const struct shadow_input *in)
{
    struct view views[BATCH];
    uint32_t column, row, pages = tree->root_side / ASM_PAGE, at_once = BATCH / pages ? BATCH / pages : 1;
    asm_tree_root_place(tree, map, &column, &row);
    for (uint32_t first = 0; first < pages; first += at_once) {
        uint32_t count = pages - first < at_once ? pages - first : at_once;
        for (uint32_t i = 0; i < count; i++)
            views[i] = root_row(tree, map, (first + i) * ASM_PAGE);
        trace(p, tracer, views, count, tree->root_side, in);
        for (uint32_t i = 0; i < count; i++)
            put_traced(p, (row + first + i) * ASM_COLUMNS + column, tree->root_side, (size_t)i * tree->root_side * ASM_PAGE);
    }
}

bool asm_pages_fill_roots(struct asm_pages *p, const struct asm_tree *tree, const struct shadow_input *in, struct error *err)
{
    const struct tracer *tracer = NULL;
    if (in->trace_maps && (!(tracer = in->tracer(in->owner, err)) || !need_room(p, err)))
        return false;
    for (unsigned map = 0; map < tree->map_count; map++) {
        uint32_t column, row;
        struct view whole = tree->maps[map];
        whole.width = whole.height = tree->root_side;
        asm_tree_root_place(tree, map, &column, &row);
        if (tracer)
            trace_root(p, tracer, tree, map, in);
        else if (!draw_view_set(&p->draw, in->draw, &whole, err) ||
                 !rasterize(p, &whole, column * ASM_PAGE, row * ASM_PAGE, in, err))
            return false;
    }
    return gl_check(in->gl, err);
}

static bool rasterize_pages(struct asm_pages *p, const struct asm_tree *tree, const uint32_t *slots, size_t count,
                            const struct shadow_input *in, struct error *err)
{
    int last_map = -1;
    for (size_t i = 0; i < count; i++) {
        struct view view = asm_tree_view(tree, slots[i]);
        int map = tree->nodes[slots[i]].map;
        if (map != last_map && !draw_view_set(&p->draw, in->draw, &view, err))
            return false;
        last_map = map;
        if (!rasterize(p, &view, slot_x(slots[i]), slot_y(slots[i]), in, err))
            return false;
    }
    return true;
}

bool asm_pages_fill(struct asm_pages *p, const struct asm_tree *tree, const uint32_t *slots, size_t count,
                    const struct shadow_input *in, struct error *err)
{
    if (!in->trace_maps)
        return rasterize_pages(p, tree, slots, count, in, err);
    const struct tracer *tracer = in->tracer(in->owner, err);
    if (!tracer || !need_room(p, err))
        return false;
    struct view views[BATCH];
    for (size_t first = 0; first < count; first += BATCH) {
        size_t n = count - first < BATCH ? count - first : BATCH;
        for (size_t i = 0; i < n; i++)
            views[i] = asm_tree_view(tree, slots[first + i]);
        trace(p, tracer, views, n, ASM_PAGE, in);
        for (size_t i = 0; i < n; i++)
            put_traced(p, slots[first + i], ASM_PAGE, i * TEXELS);
    }
    return gl_check(in->gl, err);
}
