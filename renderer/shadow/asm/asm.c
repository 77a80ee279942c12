/* Adaptive shadow maps: R. Fernando, S. Fernandez, K. Bala, D. Greenberg, SIGGRAPH 2001. docs/asm.md: what was chosen where they are silent. */
#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/log.h"
#include "blocks.h"
#include "gl/context.h"
#include "gl/texture.h"
#include "passes/gbuffer.h"
#include "shadow/asm/analysis.h"
#include "shadow/asm/look_up.h"
#include "shadow/asm/pace.h"
#include "shadow/asm/pages.h"
#include "shadow/asm/place.h"
#include "shadow/asm/refine.h"
#include "shadow/asm/tree.h"
#include "shadow/shared_params.h"

/* Rounds of the analysis after which a view counts as done, come what may. */
#define ROUNDS_MAX 32
/* Fewer leave no room below six roots. */
#define SLOTS_MIN  (2 * ASM_COLUMNS)

enum { PARAM_BUDGET, PARAM_FIT, PARAM_BIAS, PARAM_SLOPE, PARAM_DETAIL, PARAM_ANALYSE, PARAM_PACE };

static const struct param_desc params[] = {
    {.name = "budget",
     .unit = "MiB",
     .help = "What depths, ids, tree and all that goes with them may take.",
     .kind = PARAM_INT,
     .min = 1,
     .max = 128,
     .initial = 16},
    {.name = "fit",
     .unit = "",
     .help = "tight: one map around the casters where it can be; cube: always cube faces.",
     .kind = PARAM_CHOICE,
     .min = 0,
     .max = 1,
     .initial = 0,
     .choices = shadow_fit_choices},
    SHADOW_BIAS_PARAMS(1e-5, 1),
    {.name = "detail",
     .unit = "texels a pixel",
     .help = "How fine texels are to be along shadow edges: so many to the side of a pixel.",
     .kind = PARAM_FLOAT,
     .min = 0.125,
     .max = 16,
     .initial = 8},
    {.name = "analyse",
     .unit = "pixels",
     .help = "One pixel in so many is looked at in each frame to find where finer pages are needed.",
     .kind = PARAM_INT,
     .min = 1,
     .max = 32,
     .initial = 8},
    {.name = "pace",
     .unit = "ms",
     .help = "Time that making pages may take in a frame.",
     .kind = PARAM_FLOAT,
     .min = 0.1,
     .max = 1000,
     .initial = 10},
};

struct state {
    struct asm_tree tree;
    struct asm_pages pages;
    struct asm_analysis analysis;
    struct asm_refine refine;
    struct asm_pace pace;
    struct gl_buffer block;
    struct view camera;                      /* of the last frame */
    uint32_t frame, since;                   /* number of this frame; of the first with this camera and light */
    uint32_t looked;                         /* frames analysed in this round */
    uint32_t round, changed;                 /* rounds with this camera and light; pages made or freed in this one */
    uint32_t refinements, evictions, frames; /* with this camera and light */
    unsigned boundary_level;                 /* median level that shadow boundaries of the last full round found */
    bool ready, converged, empty;
};

static size_t fixed_bytes(const struct shadow_input *in)
{
    size_t rasterizing = in->scene->instance_count * 68 + 512; /* what draw_view.c makes */
    return asm_pages_fixed_bytes() + asm_refine_bytes() + rasterizing + sizeof(struct asm_block) + sizeof(struct state) + 64;
}

static size_t slot_bytes(void) { return asm_tree_slot_bytes() + asm_pages_slot_bytes() + asm_analysis_slot_bytes(); }

/* Slots that the budget allows, 0: not even a row of them. */
static uint32_t slots_for(const struct shadow_input *in, size_t *budget)
{
    size_t fixed = fixed_bytes(in);
    *budget = (size_t)in->params[PARAM_BUDGET] << 20;
    if (in->memory && in->memory < *budget)
        *budget = in->memory;
    size_t slots = *budget > fixed ? (*budget - fixed) / slot_bytes() : 0;
    return (uint32_t)(slots / ASM_COLUMNS * ASM_COLUMNS);
}

static void release(struct state *s)
{
    asm_tree_finish(&s->tree);
    asm_pages_finish(&s->pages);
    asm_analysis_finish(&s->analysis);
    asm_refine_finish(&s->refine);
    gl_buffer_finish(&s->block);
}

static bool make_room(struct state *s, const struct shadow_input *in, uint32_t slots, struct error *err)
{
    struct gl_context *gl = in->resolve_on_cpu ? NULL : in->gl;
    return asm_tree_init(&s->tree, gl, slots, err) && asm_pages_init(&s->pages, gl, slots, err) &&
           asm_analysis_init(&s->analysis, gl, slots, err) && asm_refine_init(&s->refine, err);
}

static bool plant(struct state *s, const struct shadow_input *in, struct error *err)
{
    asm_tree_plant(&s->tree, in->fit->maps, in->fit->map_count);
    return asm_pages_fill_roots(&s->pages, &s->tree, in, err) && asm_pace_measure(&s->pace, &s->pages, &s->tree, in, err);
}

static bool set_up(struct state *s, const struct shadow_input *in, struct error *err)
{
    size_t budget, least = fixed_bytes(in) + SLOTS_MIN * slot_bytes();
    uint32_t slots = slots_for(in, &budget);
    if (slots < SLOTS_MIN)
        return error_set(err, ERROR_TRY_AGAIN, "budget",
                         "%zu bytes are too few for the shadows of this scene; at least %zu will do", budget, least);
    s->ready = make_room(s, in, slots, err) && plant(s, in, err);
    log_debug("a page costs %g us a texel and %g us; taken as %g us", s->pace.texel_us, s->pace.page_us, s->pace.cost_us);
    if (!s->ready)
        release(s);
    return s->ready;
}

static bool same_view(const struct view *a, const struct view *b)
{
    return a->width == b->width && a->height == b->height && a->orthographic == b->orthographic &&
           memcmp(&a->eye, &b->eye, offsetof(struct view, far) + sizeof a->far - offsetof(struct view, eye)) == 0;
}

static bool same_maps(const struct asm_tree *t, const struct shadow_fit *fit)
{
    bool same = t->map_count == fit->map_count;
    for (unsigned i = 0; same && i < fit->map_count; i++)
        same = same_view(&t->maps[i], &fit->maps[i]);
    return same;
}

/* A light that moved a little wants pages about where it wanted them before. */
static bool follow_light(struct state *s, const struct shadow_input *in, unsigned pages, struct error *err)
{
    if (s->tree.map_count == in->fit->map_count) {
        memcpy(s->tree.maps, in->fit->maps, in->fit->map_count * sizeof s->tree.maps[0]);
        asm_refine_keep(&s->refine, &s->tree, pages);
    } else {
        asm_tree_plant(&s->tree, in->fit->maps, in->fit->map_count);
    }
    return asm_pages_fill_roots(&s->pages, &s->tree, in, err);
}

static void find_boundary_level(struct state *s, const uint32_t *levels)
{
    uint64_t all = 0, sum = 0;
    for (int i = 0; i <= ASM_LEVELS; i++)
        all += levels[i];
    s->boundary_level = 0;
    for (unsigned i = 0; i <= ASM_LEVELS && 2 * sum < all; i++) {
        sum += levels[i];
        s->boundary_level = i;
    }
}

static void begin_round(struct state *s)
{
    asm_analysis_clear(&s->analysis);
    s->looked = 0;
    s->changed = 0;
}

/* What the last frame's analysis asks for; of the light's last place, if it moved. */
static void refine(struct state *s, const struct asm_counters *counters, unsigned every, unsigned pages)
{
    s->looked++;
    bool whole = s->looked >= every;
    if (whole)
        find_boundary_level(s, counters->levels);
    asm_refine_run(&s->refine, &s->tree, counters, pages, s->since, whole);
    s->changed += s->refine.refinements + s->refine.evictions;
    if (!whole)
        return;
    s->round++;
    s->converged = s->changed == 0 || s->round >= ROUNDS_MAX;
}

static void begin_view(struct state *s, const struct shadow_input *in)
{
    s->camera = *in->view;
    s->since = s->frame;
    s->round = s->refinements = s->evictions = s->frames = 0;
    s->converged = false;
    begin_round(s);
}

static bool advance(struct state *s, const struct shadow_input *in, bool moved, struct error *err)
{
    struct asm_counters counters;
    unsigned every = (unsigned)in->params[PARAM_ANALYSE], pages = asm_pace_pages(&s->pace, in->params[PARAM_PACE]);
    bool known = asm_analysis_map(&s->analysis, &counters);
    if (known)
        asm_refine_note(&s->tree, &counters, s->frame);
    s->refine.made_count = s->refine.refinements = s->refine.evictions = 0;
    bool ok = !moved || follow_light(s, in, pages, err);
    if (ok && known)
        refine(s, &counters, every, pages);
    if (known)
        asm_analysis_unmap(&s->analysis);
    ok = ok && asm_pages_fill(&s->pages, &s->tree, s->refine.made, s->refine.made_count, in, err);
    if (known && s->looked >= every)
        begin_round(s);
    return ok;
}

static bool prepare(void *state, const struct shadow_input *in, struct error *err)
{
    struct state *s = state;
    s->frame++;
    s->empty = in->fit->map_count == 0;
    if (s->empty)
        return true;
    bool first = !s->ready;
    if (first && !set_up(s, in, err))
        return false;
    bool moved = !first && !same_maps(&s->tree, in->fit), turned = !same_view(&s->camera, in->view);
    if (s->converged && !moved && !turned) {
        s->refine.refinements = s->refine.evictions = 0;
        return true;
    }
    if (!first && !advance(s, in, moved, err))
        return false;
    if (moved || turned)
        begin_view(s, in);
    s->refinements += s->refine.refinements;
    s->evictions += s->refine.evictions;
    s->frames++;
    return true;
}

static bool bind(struct state *s, const struct shadow_input *in, struct error *err)
{
    struct asm_block block;
    asm_place_block(&s->tree, in->view, &block);
    block.asm_counts[2] = (int)in->params[PARAM_ANALYSE];
    block.asm_counts[3] = (int)s->analysis.turn;
    if (!gl_buffer_set(&s->block, in->gl, &block, sizeof block, 0, err) || !gbuffer_need_ids(in->gbuffer, in->gl, err))
        return false;
    glBindBufferBase(GL_UNIFORM_BUFFER, 7, s->block.id);
    gl_texture_bind(&s->pages.depths, UNIT_SHADOW_MAP);
    gl_texture_bind(&s->pages.ids, UNIT_ASM_IDS);
    gl_buffer_bind_texture(&s->tree.table, UNIT_ASM_TABLE);
    return true;
}

static bool resolve_on_gpu(struct state *s, const struct shadow_input *in, struct error *err)
{
    char defines[64];
    if (s->empty)
        return shadow_run_full_screen(in, "none.frag", NULL, err);
    snprintf(defines, sizeof defines, "MAPS %u\nMAP_PERSPECTIVE %d\n", s->tree.map_count, !s->tree.maps[0].orthographic);
    return bind(s, in, err) && shadow_run_full_screen(in, "asm.frag", defines, err) &&
           (s->converged || asm_analysis_start(&s->analysis, in, defines, (unsigned)in->params[PARAM_ANALYSE], err));
}

static bool resolve_on_cpu(struct state *s, const struct shadow_input *in, struct error *err)
{
    struct asm_job job;
    unsigned every = (unsigned)in->params[PARAM_ANALYSE];
    if (s->empty)
        return depth_pass_lit(in, err);
    if (!asm_job_init(&job, &s->tree, &s->pages, in, err))
        return false;
    job.depth.bias = (float)in->params[PARAM_BIAS];
    job.depth.slope = (float)in->params[PARAM_SLOPE];
    job.detail = (float)in->params[PARAM_DETAIL];
    job.block.asm_counts[2] = (int)every;
    job.block.asm_counts[3] = (int)s->analysis.turn;
    bool analyse = !s->converged && !s->analysis.counted; /* equal lights share this state */
    if (analyse)
        job.counters = asm_analysis_count(&s->analysis, every);
    asm_job_run(&job, in->pool, analyse);
    return pixel_upload(in, job.depth.visibility, err);
}

static bool resolve(void *state, const struct shadow_input *in, struct error *err)
{
    return in->resolve_on_cpu ? resolve_on_cpu(state, in, err) : resolve_on_gpu(state, in, err);
}

static void finish(void *state)
{
    struct state *s = state;
    release(s);
    memset(s, 0, sizeof *s);
}

static size_t bytes(const void *state)
{
    const struct state *s = state;
    return sizeof *s + asm_tree_bytes(&s->tree) + asm_pages_bytes(&s->pages) + asm_analysis_bytes(&s->analysis) +
           (s->refine.made ? asm_refine_bytes() : 0) + s->block.size;
}

static size_t figures(const void *state, struct shadow_figure *out)
{
    const struct state *s = state;
    uint32_t pages = 0, depth = 0;
    for (uint32_t i = 0; i < s->tree.slots; i++)
        if (asm_node_is_page(&s->tree.nodes[i])) {
            pages++;
            depth = s->tree.nodes[i].level > depth ? s->tree.nodes[i].level : depth;
        }
    double root = s->empty ? 0 : s->tree.root_side;
    const struct shadow_figure all[] = {
        {"nodes", s->empty ? 0 : pages + s->tree.map_count},
        {"depth", depth},
        {"bytes", (double)bytes(s)},
        {"root_size", root},
        {"effective_resolution", ldexp(root, 2 * (int)s->boundary_level)},
        {"refinements", s->refine.refinements},
        {"evictions", s->refine.evictions},
        {"refinements_of_view", s->refinements},
        {"evictions_of_view", s->evictions},
        {"frames_of_view", s->frames},
    };
    memcpy(out, all, sizeof all);
    return sizeof all / sizeof *all;
}

static bool converged(const void *state)
{
    const struct state *s = state;
    return s->converged || s->empty;
}

const struct shadow_system shadow_asm = {
    .name = "asm",
    .title = "Adaptive shadow map",
    .help = "A tree of small depth maps, finer where the camera needs it, within a budget of memory.",
    .lights = 1 << LIGHT_DIRECTIONAL | 1 << LIGHT_POINT | 1 << LIGHT_SPOT,
    .flags = SHADOW_USES_FIT | SHADOW_VIEW_DRIVEN | SHADOW_BINARY | SHADOW_FILLS,
    .params = params,
    .param_count = sizeof params / sizeof *params,
    .state_size = sizeof(struct state),
    .prepare = prepare,
    .resolve = resolve,
    .finish = finish,
    .bytes = bytes,
    .figures = figures,
    .converged = converged,
};
