/* How far a visibility buffer is from the reference's. Pure functions of pictures; definitions in docs/figures.md. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct metrics_input {
    uint32_t width, height;
    const float *visibility;     /* tested, [0,1] */
    const float *reference;      /* [0,1] */
    const uint8_t *receiver;     /* 1 where the pixel counts */
    const uint8_t *one_triangle; /* 1 where all 32 samples hit one triangle; NULL: rmse_one_receiver is not a number */
    int64_t wrong_samples;       /* as metrics_wrong_samples() counted; -1: not measured */
};

struct metrics {
    uint64_t receivers;
    uint64_t misclassified;        /* |V - Vref| > 0.5 */
    double misclassified_fraction; /* of receivers; 0 if there are none */
    double rmse, max_abs;          /* over receivers */
    double rmse_one_receiver;      /* NAN: not measured */
    int64_t wrong_samples;         /* -1: not measured */
    uint64_t leaks,
        acne; /* misclassified pixels all of whose 5 x 5 neighbours that are receivers have reference < 0.5, or >= 0.5 */
    struct {
        uint64_t pixels; /* receivers with both reference classes in their 3 x 3 */
        double rmse;     /* over those */
        double edge_shift_mean, edge_shift_p95,
            edge_shift_max; /* 1/32 px; contour at V = 0.5, capped at 8 px; max = symmetric Hausdorff */
    } boundary;
};

/* Which of a pixel's 32 samples have a receiver that faces the light, and which of those it reaches; an entry a pixel. */
struct sample_masks {
    uint32_t *receivers, *lit;
};

/* Samples of `pixels` pixels about which the two disagree: receiver or not, lit or not. */
int64_t metrics_wrong_samples(const struct sample_masks *a, const struct sample_masks *b, size_t pixels);

/* False when memory is out. */
bool metrics_measure(const struct metrics_input *in, struct metrics *out);

/* Sums and re-derives figures over several lights: counts add, rmse pools, shifts take vertex-weighted means and maxima. Keeps what it needs
 * inside; start from metrics_pool_init(). */
struct metrics_pool {
    struct metrics total;
    double square_sum, square_sum_one, boundary_square_sum, shift_sum;
    uint64_t one_receivers, shift_vertices;
    float *shifts; /* owned */
    size_t shift_count;
};
void metrics_pool_init(struct metrics_pool *pool);
bool metrics_pool_add(struct metrics_pool *pool, const struct metrics_input *in, struct metrics *light);
void metrics_pool_finish(struct metrics_pool *pool);
