#include "shadow/asm/place.h"

#include <math.h>
#include <string.h>

#include "draw/put_vec4.h"

/* A base beyond this many finest texels (of 2^25) is of no use: integers overflow at 2^31, with the offset as far again. */
#define BASE_MAX 268435456.0

/* Finest texels per unit of the map's picture plane, and of its left or top edge. */
struct axis {
    double scale, edge;
};

/* Row of `axis` of the map, as seen from a base: position = base + (row . p1) / w. The base is where the camera's eye lies in the map, so that a point near
 * the eye has a small row . p1, whatever the size of the map: single precision then errs by a fraction of the distance to the eye, as
 * pixels grow by it. An eye behind the light's plane has no place in the map: then the base is the map's edge. */
static double put_axis(vec4 row, const struct view *map, struct dvec3 axis, struct axis a, struct dvec3 offset)
{
    double x = dvec3_dot(axis, offset), w = dvec3_dot(map->forward, offset), base = -a.edge * a.scale;
    if (map->orthographic) {
        double at = (x - a.edge) * a.scale;
        bool useful = fabs(at) < BASE_MAX;
        put_vec4(row, dvec3_scale(axis, a.scale), useful ? 0 : x * a.scale);
        return useful ? at : base;
    }
    double k = w > 0 ? x / w : 0;
    if (!(w > 0) || !(fabs((k - a.edge) * a.scale) < BASE_MAX)) {
        put_vec4(row, dvec3_scale(axis, a.scale), x * a.scale);
        return base;
    }
    put_vec4(row, dvec3_scale(dvec3_mad(axis, map->forward, -k), a.scale), (x - k * w) * a.scale);
    return (k - a.edge) * a.scale;
}

static void put_map(const struct asm_tree *tree, unsigned i, struct dvec3 eye, struct asm_block *out)
{
    const struct view *map = &tree->maps[i];
    struct dvec3 offset = dvec3_sub(eye, map->eye);
    double side = ldexp(tree->root_side, 2 * ASM_LEVELS);
    struct axis across = {side / (map->right_edge - map->left), map->left};
    struct axis down = {side / (map->bottom - map->top), map->top};
    double x = put_axis(out->asm_rows[3 * i], map, map->right, across, offset);
    double y = put_axis(out->asm_rows[3 * i + 1], map, map->up, down, offset);
    put_vec4(out->asm_rows[3 * i + 2], map->forward, dvec3_dot(map->forward, offset));
    vec4 part = {(float)(x - floor(x)), (float)(y - floor(y)), (float)map->near, isinf(map->far) ? 0 : (float)map->far};
    memcpy(out->asm_part[i], part, sizeof part);
    uint32_t column, row;
    asm_tree_root_place(tree, i, &column, &row);
    ivec4 base = {(int)floor(x), (int)floor(y), (int)column, (int)row};
    memcpy(out->asm_base[i], base, sizeof base);
}

void asm_place_block(const struct asm_tree *tree, const struct view *camera, struct asm_block *out)
{
    memset(out, 0, sizeof *out);
    for (unsigned i = 0; i < tree->map_count; i++) {
        const struct view *map = &tree->maps[i];
        double width = (map->right_edge - map->left) / tree->root_side, height = (map->top - map->bottom) / tree->root_side;
        put_map(tree, i, camera->eye, out);
        out->asm_texel[0] = (float)fmax(width, height);
        out->asm_texel[1] = (float)fmin(width, height);
    }
    out->asm_counts[0] = (int)ldexp(tree->root_side, 2 * ASM_LEVELS);
    out->asm_counts[1] = (int)tree->slots;
}
