/* A growing array of T: `ARRAY(uint32_t) ids = {0};`. Zero-initialised is empty. Owned by whoever owns the struct. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define ARRAY(T)         \
    struct {             \
        T *data;         \
        size_t count;    \
        size_t capacity; \
    }

/* Room for `n` more elements; false when memory is out (the array is unchanged). */
#define array_reserve(a, n) array_reserve_bytes((void **)&(a)->data, &(a)->capacity, (a)->count, (n), sizeof *(a)->data)

/* Appends `value`; false when memory is out. */
#define array_push(a, value) (array_reserve((a), 1) && ((a)->data[(a)->count++] = (value), true))

/* Appends `n` elements for the caller to fill; false when memory is out. */
#define array_extend(a, n) (array_reserve((a), (n)) && ((a)->count += (n), true))

#define array_finish(a) array_finish_bytes((void **)&(a)->data, &(a)->count, &(a)->capacity)

bool array_reserve_bytes(void **data, size_t *capacity, size_t count, size_t more, size_t element_size);
void array_finish_bytes(void **data, size_t *count, size_t *capacity);
