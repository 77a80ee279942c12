/* Where the trees lie before the camera: asm_block of shaders/blocks.h. */
#pragma once

#include "blocks.h"
#include "scene/view.h"
#include "shadow/asm/tree.h"

/* All but asm_counts.zw. `camera`: in->view; positions in shaders are relative to its eye. */
void asm_place_block(const struct asm_tree *tree, const struct view *camera, struct asm_block *out);
