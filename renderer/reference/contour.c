#include "reference/contour.h"

#include <math.h>
#include <stdlib.h>

struct spot {
    double x, y; /* in pixel centres */
};

/* One of the two pictures, and who counts. */
struct field {
    uint32_t width, height;
    const float *values;
    const uint8_t *receiver;
};

static double value_at(const struct field *f, uint32_t x, uint32_t y) { return (double)f->values[(size_t)y * f->width + x]; }
static bool is_high(double value) { return value >= 0.5; }

/* A cell is named by its top left corner. */
static bool has_cell(const struct field *f, int64_t x, int64_t y)
{
    if (x < 0 || y < 0 || x + 1 >= f->width || y + 1 >= f->height)
        return false;
    const uint8_t *top = f->receiver + (size_t)y * f->width + (size_t)x, *bottom = top + f->width;
    return top[0] && top[1] && bottom[0] && bottom[1];
}

static bool crossing(const struct field *f, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, struct spot *at)
{
    double a = value_at(f, x0, y0), b = value_at(f, x1, y1);
    if (is_high(a) == is_high(b))
        return false;
    double t = (0.5 - a) / (b - a);
    *at = (struct spot){x0 + t * (double)(x1 - x0), y0 + t * (double)(y1 - y0)};
    return true;
}

/* Up to two segments of a cell, as pairs of spots; returns how many. */
static int cell_segments(const struct field *f, uint32_t x, uint32_t y, struct spot out[4])
{
    struct spot top, right, bottom, left;
    bool t = crossing(f, x, y, x + 1, y, &top), r = crossing(f, x + 1, y, x + 1, y + 1, &right);
    bool b = crossing(f, x, y + 1, x + 1, y + 1, &bottom), l = crossing(f, x, y, x, y + 1, &left);
    if (t && r && b && l) {
        double mean = (value_at(f, x, y) + value_at(f, x + 1, y) + value_at(f, x, y + 1) + value_at(f, x + 1, y + 1)) / 4;
        bool joined = is_high(value_at(f, x, y)) == is_high(mean); /* top left with bottom right */
        out[0] = top;
        out[1] = joined ? right : left;
        out[2] = bottom;
        out[3] = joined ? left : right;
        return 2;
    }
    int n = 0;
    if (t)
        out[n++] = top;
    if (r)
        out[n++] = right;
    if (b)
        out[n++] = bottom;
    if (l)
        out[n++] = left;
    return n / 2;
}

static double segment_distance(struct spot p, struct spot a, struct spot b)
{
    double ux = b.x - a.x, uy = b.y - a.y, wx = p.x - a.x, wy = p.y - a.y;
    double square = ux * ux + uy * uy;
    double t = square > 0 ? fmin(fmax((wx * ux + wy * uy) / square, 0), 1) : 0;
    return hypot(wx - t * ux, wy - t * uy);
}

static double cell_distance(const struct field *f, int64_t x, int64_t y, struct spot p, double best)
{
    struct spot ends[4];
    if (!has_cell(f, x, y))
        return best;
    int n = cell_segments(f, (uint32_t)x, (uint32_t)y, ends);
    for (int i = 0; i < n; i++)
        best = fmin(best, segment_distance(p, ends[2 * i], ends[2 * i + 1]));
    return best;
}

/* Distance from `p` to the contour, at most CONTOUR_CAP: square rings of cells outwards; those of ring r are at least r - 1 away. */
static double distance_to(const struct field *f, struct spot p)
{
    int64_t cx = (int64_t)floor(p.x), cy = (int64_t)floor(p.y);
    double best = CONTOUR_CAP;
    for (int64_t r = 0; (double)(r - 1) < best; r++)
        for (int64_t y = cy - r; y <= cy + r; y++) {
            int64_t step = y == cy - r || y == cy + r || r == 0 ? 1 : 2 * r;
            for (int64_t x = cx - r; x <= cx + r; x += step)
                best = cell_distance(f, x, y, p, best);
        }
    return best;
}

/* A vertex counts once, for the first of its two cells. */
struct walk {
    const struct field *from, *to;
    float **shifts; /* NULL: only the farthest is wanted */
    size_t *count, capacity;
    double farthest;
};

static bool visit(struct walk *w, struct spot p)
{
    double distance = distance_to(w->to, p) * 32;
    w->farthest = fmax(w->farthest, distance);
    if (!w->shifts)
        return true;
    if (*w->count >= w->capacity) {
        size_t capacity = w->capacity ? 2 * w->capacity : 1024;
        float *grown = realloc(*w->shifts, capacity * sizeof *grown);
        if (!grown)
            return false;
        *w->shifts = grown;
        w->capacity = capacity;
    }
    (*w->shifts)[(*w->count)++] = (float)distance;
    return true;
}

static bool walk_vertices(struct walk *w)
{
    const struct field *f = w->from;
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            struct spot p;
            bool here = has_cell(f, x, y);
            if ((here || has_cell(f, x, (int64_t)y - 1)) && x + 1 < f->width && crossing(f, x, y, x + 1, y, &p) && !visit(w, p))
                return false;
            if ((here || has_cell(f, (int64_t)x - 1, y)) && y + 1 < f->height && crossing(f, x, y, x, y + 1, &p) && !visit(w, p))
                return false;
        }
    return true;
}

bool contour_shifts(const struct contours *c, float **shifts, size_t *count, double *farthest)
{
    const struct field tested = {c->width, c->height, c->tested, c->receiver};
    const struct field reference = {c->width, c->height, c->reference, c->receiver};
    struct walk forth = {.from = &reference, .to = &tested, .shifts = shifts, .count = count, .capacity = *count};
    struct walk back = {.from = &tested, .to = &reference};
    if (!walk_vertices(&forth) || !walk_vertices(&back))
        return false;
    *farthest = fmax(forth.farthest, back.farthest);
    return true;
}
