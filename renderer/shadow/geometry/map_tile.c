#include "shadow/geometry/map_tile.h"

map_tile_kernel *map_tile_choose(void)
{
#ifdef __x86_64__
    if (map_tile_avx512 && __builtin_cpu_supports("avx512f"))
        return map_tile_avx512;
    if (map_tile_avx2 && __builtin_cpu_supports("avx2"))
        return map_tile_avx2;
#endif
    return map_tile_plain;
}
