/* A node's own transform (glTF 3.5.3), in double. */
#pragma once

#include "import/bridge.hh"
#include "import/tinygltf.hh"

namespace gltf
{

struct trs {
    double translation[3], rotation[4], scale[3]; /* quaternion x, y, z, w, of any length but 0 */
};

/* `index` names the node in errors. */
struct affine trs_transform(const trs &from, size_t index);
struct affine node_transform(const tinygltf::Node &node, size_t index);
bool affine_finite(const struct affine &a);

} // namespace gltf
