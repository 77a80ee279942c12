/* Inside exact/ only: which faces a light has. */
#pragma once

#include "exact/light_grid.h"

/* Sets directional, position, face_count and the faces' axes and limits. */
void light_faces_choose(struct light_grid *grid, const struct triangles *t, const struct light *light);
