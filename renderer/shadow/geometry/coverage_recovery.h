/* Boundary recovery: triangles so small that no texel kept them (papers/coverage-li-2017, 3.3). */
#pragma once

#include "shadow/geometry/coverage_asks.h"

/* Goes all ways, from triangles that a list holds over the mesh's edges to those that hold the points: the paper projects the list's triangles
 * along the surface and probes around for the one that holds the point. A way ends at the point's own triangle too, and where the mesh
 * ends or folds over, which says nothing. Forgets them all where there is no adjacency. */
void coverage_recover(struct coverage_asks *a);
