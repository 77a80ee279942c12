#include "reference/filter.h"

#ifdef __x86_64__
#include <immintrin.h>

/* The same operations in the same order as form_value(): no fused multiply-add, so the same bits. */
__attribute__((target("avx2"))) static void signs_avx2(const struct form *f, const struct lanes *lanes, unsigned *positive,
                                                       unsigned *negative)
{
    const __m256d sign = _mm256_set1_pd(-0.0), rounding = _mm256_set1_pd(FILTER_ROUNDING);
    const double anchor[3] = {f->anchor.x, f->anchor.y, f->anchor.z};
    const double *at[3] = {lanes->x, lanes->y, lanes->z};
    unsigned above = 0, below = 0;
    for (int i = 0; i < LANES; i += 4) {
        const __m256d e = _mm256_load_pd(lanes->error + i);
        __m256d value = _mm256_setzero_pd(), bound = _mm256_set1_pd(FILTER_UNDERFLOW);
        for (int k = 0; k < 3; k++) {
            __m256d d = _mm256_sub_pd(_mm256_load_pd(at[k] + i), _mm256_set1_pd(anchor[k]));
            __m256d slack = _mm256_add_pd(_mm256_mul_pd(rounding, _mm256_andnot_pd(sign, d)), e);
            value = _mm256_add_pd(value, _mm256_mul_pd(_mm256_set1_pd(f->m[k]), d));
            bound = _mm256_add_pd(bound, _mm256_mul_pd(_mm256_set1_pd(f->bound[k]), slack));
        }
        above |= (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(value, bound, _CMP_GT_OQ)) << i;
        below |= (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(value, _mm256_xor_pd(bound, sign), _CMP_LT_OQ)) << i;
    }
    *positive = above;
    *negative = below;
}
#endif

static void signs_plain(const struct form *f, const struct lanes *lanes, unsigned *positive, unsigned *negative)
{
    *positive = *negative = 0;
    for (unsigned i = 0; i < LANES; i++) {
        double bound, value = form_value(f, dvec3(lanes->x[i], lanes->y[i], lanes->z[i]), lanes->error[i], &bound);
        *positive |= (unsigned)(value > bound) << i;
        *negative |= (unsigned)(value < -bound) << i;
    }
}

void filter_signs(const struct form *f, const struct lanes *lanes, unsigned *positive, unsigned *negative)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        signs_avx2(f, lanes, positive, negative);
        return;
    }
#endif
    signs_plain(f, lanes, positive, negative);
}
