#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>

bool array_reserve_bytes(void **data, size_t *capacity, size_t count, size_t more, size_t element_size)
{
    if (more <= *capacity - count)
        return true;
    size_t limit = SIZE_MAX / 2 / element_size;
    if (more > limit - count)
        return false;
    size_t wanted = *capacity < 16 ? 16 : *capacity;
    while (wanted < count + more)
        wanted = wanted < limit / 2 ? wanted * 2 : count + more;
    void *grown = realloc(*data, wanted * element_size);
    if (!grown)
        return false;
    *data = grown;
    *capacity = wanted;
    return true;
}

void array_finish_bytes(void **data, size_t *count, size_t *capacity)
{
    free(*data);
    *data = NULL;
    *count = *capacity = 0;
}
