#include "passes/tiles.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "gl/texture.h"
#include "scene/scene.h"

#define SIDE 64

static bool reserve(struct tiles *t, uint32_t count, struct error *err)
{
    if (t->capacity >= count)
        return true;
    struct tile_rectangle *grown = realloc(t->rectangles, count * sizeof *grown);
    if (!grown)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture's tiles");
    t->rectangles = grown;
    t->capacity = count;
    return true;
}

bool tiles_set_all(struct tiles *t, uint32_t width, uint32_t height, struct error *err)
{
    if (!reserve(t, 1, err))
        return false;
    t->rectangles[0] = (struct tile_rectangle){0, 0, width, height};
    t->count = 1;
    t->top = 0;
    t->bottom = height;
    return true;
}

struct scan {
    const uint32_t *ids;
    uint32_t width, height, columns;
    uint8_t *occupied;
};

static bool holds_surface(const struct scan *s, uint32_t x0, uint32_t y0)
{
    uint32_t x1 = x0 + SIDE < s->width ? x0 + SIDE : s->width, y1 = y0 + SIDE < s->height ? y0 + SIDE : s->height;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            if (s->ids[(size_t)y * s->width + x] != SCENE_NONE)
                return true;
    return false;
}

static void scan_row(void *context, size_t row, unsigned worker)
{
    (void)worker;
    const struct scan *s = context;
    for (uint32_t column = 0; column < s->columns; column++)
        s->occupied[row * s->columns + column] = holds_surface(s, column * SIDE, (uint32_t)row * SIDE);
}

/* Adds a run of tiles; one that continues a rectangle of the row above makes that one taller. */
static void add_run(struct tiles *t, struct tile_rectangle run)
{
    for (uint32_t i = 0; i < t->count; i++) {
        struct tile_rectangle *above = &t->rectangles[i];
        if (above->x == run.x && above->width == run.width && above->y + above->height == run.y) {
            above->height += run.height;
            return;
        }
    }
    t->rectangles[t->count++] = run;
}

static void add_row(struct tiles *t, const struct scan *s, uint32_t row)
{
    const uint8_t *occupied = s->occupied + (size_t)row * s->columns;
    uint32_t y = row * SIDE, end = y + SIDE < s->height ? y + SIDE : s->height;
    for (uint32_t from = 0, to; from < s->columns; from = to) {
        for (to = from; to < s->columns && occupied[to] == occupied[from]; to++)
            ;
        if (!occupied[from])
            continue;
        uint32_t x_end = to * SIDE < s->width ? to * SIDE : s->width;
        add_run(t, (struct tile_rectangle){from * SIDE, y, x_end - from * SIDE, end - y});
        t->top = y < t->top ? y : t->top;
        t->bottom = end;
    }
}

bool tiles_set_occupied(struct tiles *t, const uint32_t *ids, uint32_t width, uint32_t height, struct job_pool *pool,
                        struct error *err)
{
    uint32_t rows = (height + SIDE - 1) / SIDE;
    struct scan scan = {ids, width, height, (width + SIDE - 1) / SIDE, NULL};
    if (!reserve(t, rows * scan.columns, err))
        return false;
    scan.occupied = malloc((size_t)rows * scan.columns);
    if (!scan.occupied)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %u x %u", width, height);
    job_pool_for(pool, rows, scan_row, &scan);
    t->count = 0;
    t->top = height;
    t->bottom = 0;
    for (uint32_t row = 0; row < rows; row++)
        add_row(t, &scan, row);
    free(scan.occupied);
    return true;
}

void tiles_draw(const struct tiles *t, uint32_t vertex_array)
{
    glBindVertexArray(vertex_array);
    glEnable(GL_SCISSOR_TEST);
    for (uint32_t i = 0; i < t->count; i++) {
        const struct tile_rectangle *r = &t->rectangles[i];
        glScissor((GLint)r->x, (GLint)r->y, (GLsizei)r->width, (GLsizei)r->height);
        gl_draw_full_screen();
    }
    glDisable(GL_SCISSOR_TEST);
}

void tiles_finish(struct tiles *t)
{
    free(t->rectangles);
    memset(t, 0, sizeof *t);
}
