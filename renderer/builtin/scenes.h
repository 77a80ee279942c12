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

extern const struct builtin_scene builtin_box, builtin_ball, builtin_tree, builtin_butterfly, builtin_dragon, builtin_room;
extern const struct builtin_scene builtin_hard_grazing, builtin_hard_contact, builtin_hard_fan, builtin_hard_depth,
    builtin_hard_degenerate, builtin_hard_twosided, builtin_hard_grid;
