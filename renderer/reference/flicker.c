#include "reference/flicker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool flicker_init(struct flicker *f, size_t pixels)
{
    bool good = true;
    *f = (struct flicker){.pixels = pixels};
    for (int i = 0; i < 3; i++) {
        f->tested[i] = malloc(pixels * sizeof *f->tested[i]);
        f->truth[i] = malloc(pixels * sizeof *f->truth[i]);
        f->receiver[i] = malloc(pixels);
        good = good && f->tested[i] && f->truth[i] && f->receiver[i];
    }
    return good;
}

void flicker_finish(struct flicker *f)
{
    for (int i = 0; i < 3; i++) {
        free(f->tested[i]);
        free(f->truth[i]);
        free(f->receiver[i]);
        f->tested[i] = f->truth[i] = NULL;
        f->receiver[i] = NULL;
    }
}

static double second_difference(float *const v[3], unsigned newest, size_t at)
{
    double after = (double)v[newest % 3][at], now = (double)v[(newest + 2) % 3][at], before = (double)v[(newest + 1) % 3][at];
    return fabs(after - 2 * now + before);
}

void flicker_add(struct flicker *f, const float *tested, const float *truth, const uint8_t *receiver)
{
    unsigned newest = f->frames++, slot = newest % 3;
    memcpy(f->tested[slot], tested, f->pixels * sizeof *tested);
    memcpy(f->truth[slot], truth, f->pixels * sizeof *truth);
    memcpy(f->receiver[slot], receiver, f->pixels);
    if (f->frames < 3)
        return;
    for (size_t i = 0; i < f->pixels; i++) {
        if (!f->receiver[0][i] || !f->receiver[1][i] || !f->receiver[2][i])
            continue;
        f->tested_sum += second_difference(f->tested, newest, i);
        f->truth_sum += second_difference(f->truth, newest, i);
        f->count++;
    }
}
