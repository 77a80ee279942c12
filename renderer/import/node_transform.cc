#include "import/node_transform.hh"

#include "import/failure.hh"

namespace gltf
{
namespace
{

struct affine matrix_transform(const std::vector<double> &m, size_t index)
{
    struct affine out;
    const double last[4] = {0, 0, 0, 1};
    for (size_t k = 0; k < 4; k++)
        if (!(std::fabs(m[4 * k + 3] - last[k]) < 1e-6))
            fail("nodes[%zu].matrix has a last row that is not 0 0 0 1: it is no affine map", index);
    for (size_t row = 0; row < 3; row++) {
        for (size_t column = 0; column < 3; column++)
            out.linear[row][column] = m[4 * column + row];
        out.offset[row] = m[12 + row];
    }
    return out;
}

void copy(double *to, const std::vector<double> &from)
{
    for (size_t k = 0; k < from.size(); k++)
        to[k] = from[k];
}

} // namespace

struct affine trs_transform(const trs &from, size_t index)
{
    const double *q = from.rotation;
    double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm > 0) || !std::isfinite(norm))
        fail("nodes[%zu]: its rotation is not a quaternion of finite, positive length", index);
    double s = 2 / norm;
    double xx = s * q[0] * q[0], yy = s * q[1] * q[1], zz = s * q[2] * q[2];
    double xy = s * q[0] * q[1], xz = s * q[0] * q[2], yz = s * q[1] * q[2];
    double wx = s * q[3] * q[0], wy = s * q[3] * q[1], wz = s * q[3] * q[2];
    const double rotation[3][3] = {
        {1 - yy - zz, xy - wz, xz + wy}, {xy + wz, 1 - xx - zz, yz - wx}, {xz - wy, yz + wx, 1 - xx - yy}};
    struct affine out;
    for (size_t row = 0; row < 3; row++) {
        for (size_t column = 0; column < 3; column++)
            out.linear[row][column] = rotation[row][column] * from.scale[column];
        out.offset[row] = from.translation[row];
    }
    return out;
}

struct affine node_transform(const tinygltf::Node &node, size_t index)
{
    if (node.matrix.size() == 16)
        return matrix_transform(node.matrix, index);
    trs from = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    copy(from.translation, node.translation);
    copy(from.rotation, node.rotation);
    copy(from.scale, node.scale);
    return trs_transform(from, index);
}

bool affine_finite(const struct affine &a)
{
    double sum = 0;
    for (int row = 0; row < 3; row++)
        sum += std::fabs(a.linear[row][0]) + std::fabs(a.linear[row][1]) + std::fabs(a.linear[row][2]) + std::fabs(a.offset[row]);
    return std::isfinite(sum);
}

} // namespace gltf
