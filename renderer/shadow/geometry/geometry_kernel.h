/* The loops of geometry maps' resolve that are worth it, compiled once an instruction set (geometry_plain.c, geometry_avx2.c), to the same bits. */
#pragma once

#include "shadow/geometry/coverage_lists.h"
#include "shadow/geometry/map_looks.h"

struct geometry_kernel {
    void (*find_points)(void *point_job, size_t chunk, unsigned worker); /* for job_pool_for() */
    void (*look)(const struct geometry_map *m, struct map_looks *l,
                 uint32_t *hint);                   /* all eight; wild and holed ones are not looked after */
    void (*load_window)(struct coverage_window *w); /* its ids; it lies on the map wholly, but for its low ends */
    void (*make_lists)(struct coverage_texels *t);
};
extern const struct geometry_kernel geometry_plain, geometry_avx2; /* the latter empty where the compiler has none */

/* The best that this machine runs. */
static inline const struct geometry_kernel *geometry_kernel_choose(void)
{
#ifdef __x86_64__
    if (geometry_avx2.look && __builtin_cpu_supports("avx2"))
        return &geometry_avx2;
#endif
    return &geometry_plain;
}
