/* The table's entries: one descriptor and one function a scene. Private to this folder. */
#pragma once

#include "builtin/builtin.h"
#include "builtin/mesh_builder.h"

#define BUILTIN_MAX_PARAMS 4

struct builtin_scene {
    struct builtin_desc desc;
    /* `values`: one a parameter, in the descriptor's order, in range. */
    void (*make)(struct mesh_builder *b, const double *values);
};

extern const struct builtin_scene builtin_box, builtin_ball, builtin_tree, builtin_butterfly, builtin_dragon, builtin_room,
    builtin_contact;
extern const struct builtin_scene builtin_hard_grazing, builtin_hard_plane, builtin_hard_sliver, builtin_hard_contact,
    builtin_hard_noise, builtin_hard_fan, builtin_hard_tjunction, builtin_hard_depth, builtin_hard_thin, builtin_hard_duplicate,
    builtin_hard_degenerate, builtin_hard_behind, builtin_hard_near, builtin_hard_far, builtin_hard_offset, builtin_hard_scale,
    builtin_hard_ratio, builtin_hard_seams, builtin_hard_cards, builtin_hard_twosided, builtin_hard_grid, builtin_hard_million,
    builtin_hard_facets, builtin_hard_clipped, builtin_hard_sheets;
