#include "reference/metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reference/contour.h"

/* Which reference classes the receivers around a pixel have. */
enum { CLASS_DARK = 1, CLASS_LIT = 2 };

static unsigned classes_around(const struct metrics_input *in, uint32_t x, uint32_t y, uint32_t reach)
{
    uint32_t x0 = x > reach ? x - reach : 0, y0 = y > reach ? y - reach : 0;
    unsigned classes = 0;
    for (uint32_t v = y0; v <= y + reach && v < in->height; v++)
        for (uint32_t u = x0; u <= x + reach && u < in->width; u++) {
            size_t at = (size_t)v * in->width + u;
            if (in->receiver[at])
                classes |= in->reference[at] < 0.5f ? CLASS_DARK : CLASS_LIT;
        }
    return classes;
}

/* Sums over one picture. */
struct sums {
    double square, square_one, boundary_square, shift;
    uint64_t one;
};

static void add_pixel(const struct metrics_input *in, uint32_t x, uint32_t y, struct metrics *m, struct sums *sums)
{
    size_t at = (size_t)y * in->width + x;
    double error = (double)in->visibility[at] - (double)in->reference[at], square = error * error;
    m->receivers++;
    sums->square += square;
    m->max_abs = fmax(m->max_abs, fabs(error));
    if (in->one_triangle && in->one_triangle[at]) {
        sums->one++;
        sums->square_one += square;
    }
    if (classes_around(in, x, y, 1) == (CLASS_DARK | CLASS_LIT)) {
        m->boundary.pixels++;
        sums->boundary_square += square;
    }
    if (!(fabs(error) > 0.5))
        return;
    m->misclassified++;
    unsigned classes = classes_around(in, x, y, 2);
    m->leaks += classes == CLASS_DARK;
    m->acne += classes == CLASS_LIT;
}

int64_t metrics_wrong_samples(const struct sample_masks *a, const struct sample_masks *b, size_t pixels)
{
    int64_t samples = 0;
    for (size_t i = 0; i < pixels; i++)
        samples += __builtin_popcount((a->receivers[i] ^ b->receivers[i]) | (a->lit[i] ^ b->lit[i]));
    return samples;
}

static double root_mean(double sum, uint64_t count) { return count ? sqrt(sum / (double)count) : 0; }

static void derive(struct metrics *m, const struct sums *sums, bool one_measured)
{
    m->misclassified_fraction = m->receivers ? (double)m->misclassified / (double)m->receivers : 0;
    m->rmse = root_mean(sums->square, m->receivers);
    m->rmse_one_receiver = one_measured ? root_mean(sums->square_one, sums->one) : NAN;
    m->boundary.rmse = root_mean(sums->boundary_square, m->boundary.pixels);
}

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Mean and nearest-rank 95 % of `count` shifts, which it sorts; returns their sum. */
static double summarise_shifts(float *shifts, size_t count, struct metrics *m)
{
    double sum = 0;
    m->boundary.edge_shift_mean = m->boundary.edge_shift_p95 = 0;
    if (count == 0)
        return 0;
    qsort(shifts, count, sizeof *shifts, by_size);
    for (size_t i = 0; i < count; i++)
        sum += (double)shifts[i];
    m->boundary.edge_shift_mean = sum / (double)count;
    m->boundary.edge_shift_p95 = (double)shifts[(count * 95 + 99) / 100 - 1];
    return sum;
}

void metrics_pool_init(struct metrics_pool *pool)
{
    *pool = (struct metrics_pool){.total.wrong_samples = -1, .total.rmse_one_receiver = NAN};
}

void metrics_pool_finish(struct metrics_pool *pool)
{
    free(pool->shifts);
    pool->shifts = NULL;
    pool->shift_count = 0;
}

static bool keep_shifts(struct metrics_pool *pool, const float *shifts, size_t count)
{
    if (count == 0)
        return true;
    float *grown = realloc(pool->shifts, (pool->shift_count + count) * sizeof *grown);
    if (!grown)
        return false;
    memcpy(grown + pool->shift_count, shifts, count * sizeof *grown);
    pool->shifts = grown;
    pool->shift_count += count;
    return true;
}

/* Adds a light's figures to the pool's and derives the means anew. */
static void merge(struct metrics_pool *pool, const struct metrics *m, const struct sums *sums)
{
    struct metrics *total = &pool->total;
    bool one_measured = !isnan(total->rmse_one_receiver) || !isnan(m->rmse_one_receiver);
    total->receivers += m->receivers;
    total->misclassified += m->misclassified;
    total->leaks += m->leaks;
    total->acne += m->acne;
    total->max_abs = fmax(total->max_abs, m->max_abs);
    if (m->wrong_samples >= 0)
        total->wrong_samples = (total->wrong_samples < 0 ? 0 : total->wrong_samples) + m->wrong_samples;
    total->boundary.pixels += m->boundary.pixels;
    total->boundary.edge_shift_max = fmax(total->boundary.edge_shift_max, m->boundary.edge_shift_max);
    pool->square_sum += sums->square;
    pool->square_sum_one += sums->square_one;
    pool->boundary_square_sum += sums->boundary_square;
    pool->one_receivers += sums->one;
    pool->shift_sum = summarise_shifts(pool->shifts, pool->shift_count, total);
    pool->shift_vertices = pool->shift_count;
    const struct sums all = {.square = pool->square_sum,
                             .square_one = pool->square_sum_one,
                             .boundary_square = pool->boundary_square_sum,
                             .one = pool->one_receivers};
    derive(total, &all, one_measured);
}

bool metrics_pool_add(struct metrics_pool *pool, const struct metrics_input *in, struct metrics *light)
{
    const struct contours contours = {in->width, in->height, in->visibility, in->reference, in->receiver};
    struct sums sums = {0};
    struct metrics m = {0};
    float *shifts = NULL;
    size_t count = 0;
    bool ok = false;

    for (uint32_t y = 0; y < in->height; y++)
        for (uint32_t x = 0; x < in->width; x++)
            if (in->receiver[(size_t)y * in->width + x])
                add_pixel(in, x, y, &m, &sums);
    m.wrong_samples = in->wrong_samples;
    derive(&m, &sums, in->one_triangle != NULL);
    if (!contour_shifts(&contours, &shifts, &count, &m.boundary.edge_shift_max) || !keep_shifts(pool, shifts, count))
        goto done;
    summarise_shifts(shifts, count, &m);
    merge(pool, &m, &sums);
    *light = m;
    ok = true;
done:
    free(shifts);
    return ok;
}

bool metrics_measure(const struct metrics_input *in, struct metrics *out)
{
    struct metrics_pool pool;
    metrics_pool_init(&pool);
    bool ok = metrics_pool_add(&pool, in, out);
    metrics_pool_finish(&pool);
    return ok;
}
