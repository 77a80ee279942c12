#include "shots.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "comparison.h"

static void shot_finish(struct bench_shot *s)
{
    free(s->rgba);
    free(s->tested);
    free(s->truth);
    free(s->receiver);
}

static void *copy(const void *from, size_t bytes)
{
    void *to = malloc(bytes);
    if (to)
        memcpy(to, from, bytes);
    return to;
}

void bench_shots_take(struct bench_shots *shots, const struct bench_cell *cell, const struct comparison *c)
{
    size_t pixels = (size_t)c->width * c->height;
    if (c->light_count == 0)
        return;
    struct bench_shot s = {
        .cell = cell,
        .width = c->width,
        .height = c->height,
        .rgba = copy(c->picture, pixels * 4),
        .tested = copy(c->tested[0], pixels * sizeof(float)),
        .truth = copy(c->truth[0], pixels * sizeof(float)),
        .receiver = copy(c->receiver[0], pixels),
    };
    if (!s.rgba || !s.tested || !s.truth || !s.receiver || !array_push(&shots->list, s))
        shot_finish(&s);
}

void bench_shots_finish(struct bench_shots *shots)
{
    for (size_t i = 0; i < shots->list.count; i++)
        shot_finish(&shots->list.data[i]);
    array_finish(&shots->list);
}
