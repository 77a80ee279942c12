#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "shadow/fit.h"

/* Cells a side of the grid that groups a mesh's vertices. The overshoot of a fit is at most a box's shape inside one cell. */
#define CELLS 8

static unsigned cell_of(const struct mesh *mesh, const float p[3])
{
    unsigned cell = 0;
    for (int axis = 0; axis < 3; axis++) {
        float extent = mesh->bounds_max[axis] - mesh->bounds_min[axis];
        float where = extent > 0 ? (p[axis] - mesh->bounds_min[axis]) / extent * CELLS : 0;
        unsigned i = where < CELLS - 1 ? (unsigned)where : CELLS - 1;
        cell = cell * CELLS + i;
    }
    return cell;
}

static void box_add(struct fit_box *box, const float p[3])
{
    for (int axis = 0; axis < 3; axis++) {
        box->min[axis] = fminf(box->min[axis], p[axis]);
        box->max[axis] = fmaxf(box->max[axis], p[axis]);
    }
}

static bool finite3(const float p[3]) { return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]); }

/* Triangles without area cast nothing. Exactly collinear corners come out as exactly zero here. */
static bool has_area(const float *const p[3])
{
    struct dvec3 a = dvec3_from_float(p[0]), n;
    n = dvec3_cross(dvec3_sub(dvec3_from_float(p[1]), a), dvec3_sub(dvec3_from_float(p[2]), a));
    return n.x != 0 || n.y != 0 || n.z != 0;
}

static void fill_cells(const struct scene *s, const struct mesh *mesh, struct fit_box cells[CELLS * CELLS * CELLS])
{
    for (unsigned c = 0; c < CELLS * CELLS * CELLS; c++)
        cells[c] = (struct fit_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    /* By index: a vertex that no triangle uses casts nothing. */
    for (uint32_t i = 0; i + 2 < mesh->index_count; i += 3) {
        const float *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = s->positions[mesh->first_vertex + s->indices[mesh->first_index + i + (uint32_t)k]];
        if (finite3(p[0]) && finite3(p[1]) && finite3(p[2]) && has_area(p))
            for (int k = 0; k < 3; k++)
                box_add(&cells[cell_of(mesh, p[k])], p[k]);
    }
}

bool fit_geometry_init(struct fit_geometry *g, const struct scene *scene, struct error *err)
{
    struct fit_box *cells = malloc(CELLS * CELLS * CELLS * sizeof *cells);
    ARRAY(struct fit_box) boxes = {0};
    *g = (struct fit_geometry){.scene = scene, .first_box = calloc(scene->mesh_count + 1, sizeof *g->first_box)};
    bool ok = cells && g->first_box;
    for (size_t m = 0; ok && m < scene->mesh_count; m++) {
        fill_cells(scene, &scene->meshes[m], cells);
        for (unsigned c = 0; ok && c < CELLS * CELLS * CELLS; c++)
            if (cells[c].min[0] <= cells[c].max[0])
                ok = array_push(&boxes, cells[c]);
        g->first_box[m + 1] = boxes.count;
    }
    free(cells);
    g->boxes = boxes.data;
    if (ok)
        return true;
    fit_geometry_finish(g);
    return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the scene's boxes");
}

void fit_geometry_finish(struct fit_geometry *g)
{
    free(g->boxes);
    free(g->first_box);
    memset(g, 0, sizeof *g);
}
