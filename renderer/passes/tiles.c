#include "passes/tiles.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "gl/context.h"
#include "scene/scene.h"

#define SIDE 64

struct rectangle {
    float x0, y0, x1, y1;
};

static bool upload(struct tiles *t, struct gl_context *gl, const struct rectangle *rectangles, uint32_t count, struct error *err)
{
    t->count = count;
    if (!gl_buffer_set(&t->rectangles, gl, rectangles, count * sizeof *rectangles, 0, err))
        return false;
    if (!t->vertex_array) {
        glCreateVertexArrays(1, &t->vertex_array);
        glVertexArrayAttribFormat(t->vertex_array, 0, 4, GL_FLOAT, GL_FALSE, 0);
        glVertexArrayAttribBinding(t->vertex_array, 0, 0);
        glVertexArrayBindingDivisor(t->vertex_array, 0, 1);
        glEnableVertexArrayAttrib(t->vertex_array, 0);
    }
    /* Every time: a buffer remade may have the old one's name, and is another one still. */
    glVertexArrayVertexBuffer(t->vertex_array, 0, t->rectangles.id, 0, sizeof *rectangles);
    return gl_check(gl, err);
}

bool tiles_set_all(struct tiles *t, struct gl_context *gl, uint32_t height, struct error *err)
{
    t->top = 0;
    t->bottom = height;
    static const struct rectangle all = {-1, -1, 1, 1};
    return upload(t, gl, &all, 1, err);
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

/* Runs of occupied tiles of one row. */
static uint32_t join_row(const struct scan *s, uint32_t row, struct rectangle *out)
{
    const uint8_t *occupied = s->occupied + (size_t)row * s->columns;
    uint32_t n = 0, y1 = (row + 1) * SIDE < s->height ? (row + 1) * SIDE : s->height;
    for (uint32_t from = 0, to; from < s->columns; from = to) {
        for (to = from; to < s->columns && occupied[to] == occupied[from]; to++)
            ;
        uint32_t x1 = to * SIDE < s->width ? to * SIDE : s->width;
        if (occupied[from])
            out[n++] = (struct rectangle){2.0f * (float)(from * SIDE) / (float)s->width - 1, 2.0f * (float)(row * SIDE) / (float)s->height - 1,
                                          2.0f * (float)x1 / (float)s->width - 1, 2.0f * (float)y1 / (float)s->height - 1};
    }
    return n;
}

bool tiles_set_occupied(struct tiles *t, struct gl_context *gl, const uint32_t *ids, uint32_t width, uint32_t height,
                        struct job_pool *pool, struct error *err)
{
    uint32_t rows = (height + SIDE - 1) / SIDE, count = 0;
    struct scan scan = {ids, width, height, (width + SIDE - 1) / SIDE, NULL};
    scan.occupied = malloc((size_t)rows * scan.columns);
    struct rectangle *rectangles = malloc(((size_t)rows * scan.columns + 1) * sizeof *rectangles);
    bool ok = scan.occupied && rectangles;
    if (ok) {
        job_pool_for(pool, rows, scan_row, &scan);
        t->top = height;
        t->bottom = 0;
        for (uint32_t row = 0; row < rows; row++) {
            uint32_t runs = join_row(&scan, row, rectangles + count), end = (row + 1) * SIDE < height ? (row + 1) * SIDE : height;
            t->top = runs && t->top == height ? row * SIDE : t->top;
            t->bottom = runs ? end : t->bottom;
            count += runs;
        }
        ok = upload(t, gl, rectangles, count, err);
    } else {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %u x %u", width, height);
    }
    free(scan.occupied);
    free(rectangles);
    return ok;
}

void tiles_draw(const struct tiles *t)
{
    glBindVertexArray(t->vertex_array);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)t->count);
}

void tiles_finish(struct tiles *t)
{
    glDeleteVertexArrays(t->vertex_array != 0, &t->vertex_array);
    gl_buffer_finish(&t->rectangles);
    memset(t, 0, sizeof *t);
}
