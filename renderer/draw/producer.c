#include "draw/producer.h"

#include "draw/draw_scene.h"
#include "gl/context.h"

/* llvmpipe takes about 0.2 us a triangle, its vertex work being on one thread, and about 2 ns a texel; Embree 14 ns a ray whatever the
 * scene: they meet where a triangle has this many rays. Measured on two cores over maps of 512 to 4096 and 20 k to 871 k triangles;
 * either side of the line the two are within a few milliseconds. */
#define RAYS_PER_TRIANGLE 18

/* shadow/depth/map_raster.h takes about 0.02 us a triangle on both cores: at one ray a triangle the two meet. Half as many: its lists take memory that
 * rays do not. */
#define RAYS_PER_TRIANGLE_ON_CPU 2

static bool many_triangles(const struct draw_scene *scene, size_t rays)
{
    return scene->gl->caps.software && scene->scene->drawn_triangle_count > rays / RAYS_PER_TRIANGLE;
}

bool producer_traces_camera(const struct draw_scene *scene, size_t pixels)
{
    /* The tracer knows the surface it hit; the rasterizer's ids cost a pass of fetches more (surfaces.frag), 15 ms at 1280 x 720. */
    return (scene->plain && scene->gl->caps.software) || many_triangles(scene, pixels);
}

bool producer_traces_map(const struct draw_scene *scene, size_t texels) { return many_triangles(scene, texels); }

/* Scenes with textures may have holes, which are left to GL. */
bool producer_traces_map_on_cpu(const struct draw_scene *scene, size_t texels)
{
    return scene->plain ? scene->scene->drawn_triangle_count > texels / RAYS_PER_TRIANGLE_ON_CPU : many_triangles(scene, texels);
}

/* docs/performance.md: one tap costs a software rasterizer three times what it costs here, more of them more. */
bool producer_resolves_on_cpu(const struct draw_scene *scene) { return scene->gl->caps.software; }
