/* Numbers out of buffers: every buffer view and accessor is checked once, by construction of the reader; reading cannot go wrong after. */
#pragma once

#include <vector>

#include "import/bytes.hh"
#include "import/tinygltf.hh"

namespace gltf
{

class accessor_reader
{
  public:
    /* Checks all views and accessors of `model` against `buffers`; both must outlive it. */
    accessor_reader(const tinygltf::Model &model, const std::vector<span> &buffers);

    size_t count(int accessor) const { return model_.accessors[static_cast<size_t>(accessor)].count; }
    const tinygltf::Accessor &info(int accessor) const { return model_.accessors[static_cast<size_t>(accessor)]; }

    /* 1 for SCALAR, 2 to 4 for vectors, 0 for matrices. */
    unsigned components(int accessor) const;

    /* count * components floats to `out`, `stride` floats apart. Normalized integers as glTF 3.6.2.2 says, others as their value. Fails on
     * a value that is not finite; `what` names the accessor. */
    void read_floats(int accessor, float *out, size_t stride, const char *what) const;

    /* Unsigned integers. */
    void read_indices(int accessor, uint32_t *out) const;

    /* The bytes of a buffer view. */
    span view_bytes(int view) const;

  private:
    struct layout {
        span data; /* from the first element; empty: all zero */
        size_t stride;
    };

    void check_view(size_t view) const;
    void check_accessor(size_t accessor) const;
    void check_sparse(size_t accessor) const;
    layout layout_of(const tinygltf::Accessor &a) const;
    template <typename T> void read_as(const tinygltf::Accessor &a, float *out, size_t stride) const;

    const tinygltf::Model &model_;
    const std::vector<span> &buffers_;
};

} // namespace gltf
