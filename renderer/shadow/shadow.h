/* The one interface of a shadow system. A system answers, for every pixel of the camera's picture and one light: what fraction of the
 * light reaches the pixel's receiver? Its whole product is that visibility buffer. Adding one = one .c file, its shaders, one line in
 * algorithms.def; CLI help, wire, viewer, contract test and error test loop over the registry.
 *
 * Everything here is called on the render thread, with the GL context current. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"
#include "scene/view.h"

struct error;
struct gl_texture;
struct job_pool;
struct reference;
struct tracer;
struct visibility_layer;
struct gbuffer;
struct draw_scene;
struct gl_context;

enum param_kind { PARAM_INT, PARAM_FLOAT, PARAM_CHOICE };

struct param_desc {
    const char *name; /* [a-z_]+ */
    const char *unit; /* "texels", "scene units", "" */
    const char *help; /* one sentence */
    enum param_kind kind;
    double min, max, initial;   /* PARAM_CHOICE: 0, choices - 1, index of the default */
    const char *const *choices; /* PARAM_CHOICE: NULL-terminated names; a numeric choice may be written as its number */
    bool odd;                   /* PARAM_INT: only odd values */
};

#define SHADOW_PARAM_MAX 12

/* Values in the order of the system's descriptors; a choice is its index. */
struct shadow_params {
    double value[SHADOW_PARAM_MAX];
};

#define SHADOW_MAPS_MAX 6
#define SHADOW_FIT_SIDE 512

/* What a light's maps see: the same for every map system (shadow/fit.h). Part of the tight fit: casters only. */
struct shadow_fit {
    unsigned map_count;                /* 0: no casters */
    struct view maps[SHADOW_MAPS_MAX]; /* square: width = height = the size parameter */
    double fov_deg[SHADOW_MAPS_MAX];   /* widest full angle of the map; 0 for an orthographic one */
    const uint32_t *casters;           /* instances that cast, ascending; valid during the call */
    size_t caster_count;
};

struct shadow_input {
    const struct scene *scene;
    const struct light *light;
    unsigned light_index;
    uint32_t viewer;              /* whose picture: light_states.h */
    const struct shadow_fit *fit; /* NULL for systems without SHADOW_USES_MAPS or _FIT */
    const double *params;         /* the values, in the order of the system's descriptors */
    const struct view *view;      /* the camera; resolve, and prepare of view-driven systems */
    struct gbuffer *gbuffer;      /* likewise */
    struct draw_scene *draw;      /* the scene on the GPU */
    /* The scene's ray tracers, made when first asked for; NULL with err set when that failed. */
    const struct tracer *(*tracer)(void *owner, struct error *err);
    const struct reference *(*reference)(void *owner, struct error *err);
    void *owner;
    struct visibility_layer *
        layer; /* what resolve fills, in place of the framebuffer (passes/visibility.h), where it has room and the system works on
                                     * the CPU; NULL outside resolve */
    bool trace_maps;     /* make depth maps by tracing (draw/producer.h) */
    bool resolve_on_cpu; /* where a system can do either (draw/producer.h); with SHADOW_USES_FIT only what is traced */
    size_t memory;       /* bytes that a light's structure may take; 0: no limit */
    struct job_pool *pool;
    struct gl_context *gl;
};

/* A system's triangle lists, read back for measuring: texel t = (map * size + row) * size + column holds the drawn-triangle ids
 * triangles[first[t]] .. triangles[first[t + 1]], each once. Rows run as the map's texture does: row 0 at the top of the map's view. Both
 * arrays are malloc'd and become the caller's. */
struct shadow_lists {
    unsigned map_count;
    uint32_t size;
    uint32_t *first; /* map_count * size * size + 1 */
    uint32_t *triangles;
};

/* Something a system tells about itself in the stats and in view.stats: "nodes", "undecided_fraction". */
struct shadow_figure {
    const char *name; /* [a-z0-9_]+, static */
    double value;
};
#define SHADOW_FIGURES_MAX 16

enum shadow_flags {
    SHADOW_USES_MAPS = 1,   /* wants shadow_fit; must have a parameter "size" */
    SHADOW_VIEW_DRIVEN = 2, /* prepare runs every frame, with view and gbuffer; state per view too */
    SHADOW_NO_SHADOWS = 4,  /* answers 1 for every receiver: full cover need not be dark */
    SHADOW_BINARY = 8,      /* values are 0 or 1 only */
    SHADOW_EXACT = 16,      /* promises the reference's own answer: error test demands 0 */
    SHADOW_USES_FIT = 32,   /* wants shadow_fit, and chooses the resolution itself: maps come as SHADOW_FIT_SIDE a side */
    SHADOW_BRIGHTENS = 64,  /* full cover may leave some light, below one half */
    SHADOW_FILLS = 128,     /* resolve_on_cpu fills in->layer where that has room: no framebuffer is bound then */
};

struct shadow_system {
    const char *name;  /* [a-z0-9_]+: wire, CLI, golden files */
    const char *title; /* shown in the viewer */
    const char *help;  /* one sentence */
    unsigned lights;   /* 1 << enum light_kind, or-ed */
    unsigned flags;    /* enum shadow_flags */
    const struct param_desc *params;
    size_t param_count; /* <= SHADOW_PARAM_MAX */
    size_t state_size;  /* per light, shared by all views; zeroed, owned by the framework; 0: none */

    bool (*init)(void *state, const struct shadow_input *in, struct error *err);    /* optional: allocations, programs */
    bool (*prepare)(void *state, const struct shadow_input *in, struct error *err); /* optional: maps, lists, trees */
    /* Writes one value in [0, 1] per pixel to the framebuffer bound by the framework (one R32F colour attachment of the picture's
     * size, cleared to 0), or to in->layer; 0 where there is no receiver (shaders/receiver.glsl). */
    bool (*resolve)(void *state, const struct shadow_input *in, struct error *err);
    void (*finish)(void *state);        /* optional; accepts half-initialised state */
    size_t (*bytes)(const void *state); /* optional: what the state holds on the GPU and CPU, now */

    /* For systems with lists, with the state prepared: what each texel's list holds. Slow; never in a streamed frame. */
    bool (*read_lists)(void *state, const struct shadow_input *in, struct shadow_lists *out, struct error *err);
    /* For systems that decide each of the 32 samples: the masks behind the last resolve, as reference_samples32 defines them, one
     * entry a pixel. Returns false without an error set where the parameters ask for one sample. Slow. */
    bool (*read_masks)(void *state, const struct shadow_input *in, uint32_t *receivers, uint32_t *lit, struct error *err);
    /* Optional: figures of the last frame; returns how many, at most SHADOW_FIGURES_MAX. */
    size_t (*figures)(const void *state, struct shadow_figure *out);
    /* View-driven, progressive systems: true once another frame of the same still view would change nothing. NULL: always. */
    bool (*converged)(const void *state);
};

/* The registry, in the order of algorithms.def. */
extern const struct shadow_system *const shadow_systems[];
extern const size_t shadow_system_count;

/* What is used when nobody chose. */
const struct shadow_system *shadow_default(void);

/* NULL if there is none of that name. */
const struct shadow_system *shadow_find(const char *name, size_t length);

/* Parses "NAME[:key=value,...]". Errors (ERROR_USAGE) name what would be accepted. Every parameter not given takes its default. */
bool shadow_parse(const char *text, const struct shadow_system **system, struct shadow_params *params, struct error *err);

/* Sets one parameter from text, checking kind, range and choice. */
bool shadow_param_parse(const struct shadow_system *system, struct shadow_params *params, const char *key, const char *value,
                        struct error *err);

struct shadow_params shadow_defaults(const struct shadow_system *system);

/* "NAME:key=value,..." with every parameter, default or not, into `out` (at least 256 bytes). */
void shadow_format(const struct shadow_system *system, const struct shadow_params *params, char *out, size_t size);

/* Index of parameter `key`, or -1. */
int shadow_param_index(const struct shadow_system *system, const char *key);
