#include "import/accessor.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "import/failure.hh"

namespace gltf
{
namespace
{

/* An accessor without a view is all zero: it costs the file nothing, so it may not cost much here. */
constexpr size_t zero_count_max = size_t{1} << 20;

size_t component_size(int type)
{
    switch (type) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: return 0;
    }
}

size_t component_count(int type)
{
    switch (type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4:
    case TINYGLTF_TYPE_MAT2: return 4;
    case TINYGLTF_TYPE_MAT3: return 9;
    default: return 16;
    }
}

/* glTF 3.6.2.4: matrix columns start at multiples of four bytes. */
size_t element_size(const tinygltf::Accessor &a)
{
    size_t size = component_size(a.componentType);
    if (a.type == TINYGLTF_TYPE_MAT2 && size == 1)
        return 8;
    if (a.type == TINYGLTF_TYPE_MAT3 && size < 4)
        return size == 1 ? 12 : 24;
    return size * component_count(a.type);
}

/* Whether `count` elements lie in `size` bytes from `offset` on; no product or sum can wrap. */
bool fits(uint64_t size, uint64_t offset, uint64_t stride, uint64_t element, uint64_t count)
{
    return offset <= size && element <= size - offset && (count - 1) <= (size - offset - element) / stride;
}

template <typename T> T load(const uint8_t *p)
{
    T value;
    memcpy(&value, p, sizeof value);
    return value;
}

/* glTF 3.6.2.2: f = max(c / max, -1). */
template <typename T> float to_float(T value, bool normalized)
{
    if (std::is_same<T, float>::value || !normalized)
        return static_cast<float>(value);
    return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

uint32_t load_index(const uint8_t *p, int component_type)
{
    return component_type == 5121 ? *p : component_type == 5123 ? load<uint16_t>(p) : load<uint32_t>(p);
}

} // namespace

accessor_reader::accessor_reader(const tinygltf::Model &model, const std::vector<span> &buffers)
    : model_(model), buffers_(buffers)
{
    for (size_t i = 0; i < model.bufferViews.size(); i++)
        check_view(i);
    for (size_t i = 0; i < model.accessors.size(); i++) {
        check_accessor(i);
        if (model.accessors[i].sparse.isSparse)
            check_sparse(i);
    }
}

void accessor_reader::check_view(size_t i) const
{
    const tinygltf::BufferView &view = model_.bufferViews[i];
    size_t size = buffers_[static_cast<size_t>(view.buffer)].size;
    if (view.byteOffset > size || view.byteLength > size - view.byteOffset)
        fail("bufferViews[%zu] covers bytes %zu to %zu of buffers[%d], which has %zu", i, view.byteOffset,
             view.byteOffset + view.byteLength, view.buffer, size);
}

void accessor_reader::check_accessor(size_t i) const
{
    const tinygltf::Accessor &a = model_.accessors[i];
    if (component_size(a.componentType) == 0)
        fail("accessors[%zu].componentType is %d, accepted are 5120 to 5123, 5125 and 5126", i, a.componentType);
    if (a.bufferView < 0) {
        if (a.count > zero_count_max)
            fail("accessors[%zu] has %zu elements without a buffer view, at most %zu are accepted", i, a.count, zero_count_max);
        return;
    }
    const tinygltf::BufferView &view = model_.bufferViews[static_cast<size_t>(a.bufferView)];
    size_t element = element_size(a), stride = view.byteStride ? view.byteStride : element;
    if (stride < element && a.count > 1)
        fail("accessors[%zu] has elements of %zu bytes, more than the byteStride %zu of bufferViews[%d]", i, element, stride,
             a.bufferView);
    if (!fits(view.byteLength, a.byteOffset, stride, element, a.count))
        fail("accessors[%zu] needs %zu elements of %zu bytes, %zu apart, from byte %zu on, but bufferViews[%d] has %zu bytes", i,
             a.count, element, stride, a.byteOffset, a.bufferView, view.byteLength);
}

void accessor_reader::check_sparse(size_t i) const
{
    const tinygltf::Accessor &a = model_.accessors[i];
    size_t count = static_cast<size_t>(a.sparse.count), index_size = component_size(a.sparse.indices.componentType);
    int type = a.sparse.indices.componentType;
    if (count > a.count)
        fail("accessors[%zu].sparse.count is %zu, more than the accessor's %zu elements", i, count, a.count);
    if (type != 5121 && type != 5123 && type != 5125)
        fail("accessors[%zu].sparse.indices.componentType is %d, accepted are 5121, 5123 and 5125", i, type);
    span indices = view_bytes(a.sparse.indices.bufferView), values = view_bytes(a.sparse.values.bufferView);
    size_t offset = static_cast<size_t>(a.sparse.indices.byteOffset), element = element_size(a);
    if (!fits(indices.size, offset, index_size, index_size, count))
        fail("accessors[%zu].sparse.indices reach past the end of bufferViews[%d]", i, a.sparse.indices.bufferView);
    if (!fits(values.size, static_cast<size_t>(a.sparse.values.byteOffset), element, element, count))
        fail("accessors[%zu].sparse.values reach past the end of bufferViews[%d]", i, a.sparse.values.bufferView);
    uint64_t least = 0;
    for (size_t k = 0; k < count; k++) {
        uint64_t index = load_index(indices.data + offset + k * index_size, type);
        if (index < least || index >= a.count)
            fail("accessors[%zu].sparse.indices[%zu] is %llu, they must rise and stay below %zu", i, k,
                 static_cast<unsigned long long>(index), a.count);
        least = index + 1;
    }
}

unsigned accessor_reader::components(int accessor) const
{
    int type = info(accessor).type;
    bool matrix = type == TINYGLTF_TYPE_MAT2 || type == TINYGLTF_TYPE_MAT3 || type == TINYGLTF_TYPE_MAT4;
    return matrix ? 0 : static_cast<unsigned>(component_count(type));
}

span accessor_reader::view_bytes(int index) const
{
    const tinygltf::BufferView &view = model_.bufferViews[static_cast<size_t>(index)];
    return {buffers_[static_cast<size_t>(view.buffer)].data + view.byteOffset, view.byteLength};
}

accessor_reader::layout accessor_reader::layout_of(const tinygltf::Accessor &a) const
{
    if (a.bufferView < 0)
        return {{}, 0};
    size_t stride = model_.bufferViews[static_cast<size_t>(a.bufferView)].byteStride;
    span view = view_bytes(a.bufferView);
    return {{view.data + a.byteOffset, view.size - a.byteOffset}, stride ? stride : element_size(a)};
}

template <typename T> void accessor_reader::read_as(const tinygltf::Accessor &a, float *out, size_t stride) const
{
    size_t components = component_count(a.type);
    layout from = layout_of(a);
    for (size_t i = 0; i < a.count; i++)
        for (size_t k = 0; k < components; k++)
            out[i * stride + k] =
                from.data.data ? to_float(load<T>(from.data.data + i * from.stride + k * sizeof(T)), a.normalized) : 0;
    if (!a.sparse.isSparse)
        return;
    const uint8_t *indices = view_bytes(a.sparse.indices.bufferView).data + a.sparse.indices.byteOffset;
    const uint8_t *values = view_bytes(a.sparse.values.bufferView).data + a.sparse.values.byteOffset;
    size_t index_size = component_size(a.sparse.indices.componentType);
    for (size_t i = 0; i < static_cast<size_t>(a.sparse.count); i++) {
        size_t element = load_index(indices + i * index_size, a.sparse.indices.componentType);
        for (size_t k = 0; k < components; k++)
            out[element * stride + k] = to_float(load<T>(values + (i * components + k) * sizeof(T)), a.normalized);
    }
}

void accessor_reader::read_floats(int accessor, float *out, size_t stride, const char *what) const
{
    const tinygltf::Accessor &a = info(accessor);
    size_t components = component_count(a.type);
    switch (a.componentType) {
    case 5120: read_as<int8_t>(a, out, stride); return;
    case 5121: read_as<uint8_t>(a, out, stride); return;
    case 5122: read_as<int16_t>(a, out, stride); return;
    case 5123: read_as<uint16_t>(a, out, stride); return;
    case 5125: read_as<uint32_t>(a, out, stride); return;
    default: break;
    }
    layout from = layout_of(a);
    if (from.data.data && !a.sparse.isSparse && stride == components && from.stride == components * sizeof(float))
        memcpy(out, from.data.data, a.count * from.stride);
    else
        read_as<float>(a, out, stride);
    for (size_t i = 0; i < a.count; i++)
        for (size_t k = 0; k < components; k++)
            if (!std::isfinite(out[i * stride + k]))
                fail("%s: element %zu of accessors[%d] is %g, finite numbers are accepted", what, i, accessor,
                     static_cast<double>(out[i * stride + k]));
}

void accessor_reader::read_indices(int accessor, uint32_t *out) const
{
    const tinygltf::Accessor &a = info(accessor);
    layout from = layout_of(a);
    if (from.data.data && a.componentType == 5125 && from.stride == sizeof(uint32_t)) {
        memcpy(out, from.data.data, a.count * sizeof(uint32_t));
    } else {
        for (size_t i = 0; i < a.count; i++)
            out[i] = from.data.data ? load_index(from.data.data + i * from.stride, a.componentType) : 0;
    }
    if (!a.sparse.isSparse)
        return;
    const uint8_t *indices = view_bytes(a.sparse.indices.bufferView).data + a.sparse.indices.byteOffset;
    const uint8_t *values = view_bytes(a.sparse.values.bufferView).data + a.sparse.values.byteOffset;
    size_t index_size = component_size(a.sparse.indices.componentType), value_size = component_size(a.componentType);
    for (size_t i = 0; i < static_cast<size_t>(a.sparse.count); i++)
        out[load_index(indices + i * index_size, a.sparse.indices.componentType)] =
            load_index(values + i * value_size, a.componentType);
}

} // namespace gltf
