/* Bytes owned and bytes borrowed, and growing arrays whose memory C can free(). */
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

namespace gltf
{

struct span {
    const uint8_t *data = nullptr;
    size_t size = 0;
};

/* Not zeroed. */
struct bytes {
    std::unique_ptr<uint8_t[]> data;
    size_t size = 0;

    bytes() = default;
    explicit bytes(size_t n) : data(new uint8_t[n ? n : 1]), size(n) {}
    span view() const { return {data.get(), size}; }
};

/* A growing array in malloc'd memory: release() hands it to C. */
template <typename T> class pod_array
{
    static_assert(std::is_trivially_copyable<T>::value, "kept by realloc");

  public:
    pod_array() = default;
    pod_array(const pod_array &) = delete;
    pod_array &operator=(const pod_array &) = delete;
    ~pod_array() { free(data_); }

    size_t size() const { return count_; }
    T *data() { return data_; }
    T &operator[](size_t i) { return data_[i]; }
    const T &operator[](size_t i) const { return data_[i]; }

    /* `n` more elements, not initialised; the first of them. */
    T *extend(size_t n)
    {
        if (n > capacity_ - count_)
            grow(count_ + n);
        T *first = data_ + count_;
        count_ += n;
        return first;
    }
    void push(const T &value) { *extend(1) = value; }
    T *release()
    {
        T *data = data_;
        data_ = nullptr;
        count_ = capacity_ = 0;
        return data;
    }

  private:
    void grow(size_t wanted)
    {
        size_t larger = capacity_ + capacity_ / 2;
        size_t capacity = wanted > larger ? wanted : larger;
        void *grown = capacity > SIZE_MAX / 2 / sizeof(T) ? nullptr : realloc(static_cast<void *>(data_), capacity * sizeof(T));
        if (!grown)
            throw std::bad_alloc();
        data_ = static_cast<T *>(grown);
        capacity_ = capacity;
    }

    T *data_ = nullptr;
    size_t count_ = 0, capacity_ = 0;
};

} // namespace gltf
