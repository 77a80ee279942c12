/* A material as shaders read it (shaders/blocks.h). */
#pragma once

#include "blocks.h"
#include "scene/scene.h"

void pack_material(const struct material *m, float out[MATERIAL_TEXELS][4]);
