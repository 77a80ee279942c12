#include "gl/timer.h"

#include <epoxy/gl.h>
#include <string.h>
#include <time.h>

double clock_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

void gl_timer_init(struct gl_timer *t)
{
    memset(t, 0, sizeof *t);
    for (unsigned f = 0; f < GL_TIMER_FRAMES; f++)
        glCreateQueries(GL_TIMESTAMP, GL_TIMER_PASSES + 1, t->queries[f]);
}

void gl_timer_finish(struct gl_timer *t)
{
    for (unsigned f = 0; f < GL_TIMER_FRAMES; f++)
        glDeleteQueries(GL_TIMER_PASSES + 1, t->queries[f]);
    memset(t, 0, sizeof *t);
}

static void stamp(struct gl_timer *t, unsigned slot)
{
    glQueryCounter(t->queries[t->frame][slot], GL_TIMESTAMP);
    t->used[t->frame][slot] = true;
}

void gl_timer_begin(struct gl_timer *t, bool finish)
{
    t->finish = finish;
    t->frame = (t->frame + 1) % GL_TIMER_FRAMES;
    memset(t->used[t->frame], 0, sizeof t->used[t->frame]);
    if (finish) {
        glFinish();
        t->start_ms = clock_ms();
    } else {
        stamp(t, 0);
    }
}

double gl_timer_mark(struct gl_timer *t, unsigned pass)
{
    if (!t->finish) {
        stamp(t, pass + 1);
        return 0;
    }
    glFinish();
    double now = clock_ms(), took = now - t->start_ms;
    t->start_ms = now;
    return took;
}

void gl_timer_read(struct gl_timer *t, unsigned age, double *pass_ms, unsigned pass_count)
{
    unsigned frame = (t->frame + GL_TIMER_FRAMES - age) % GL_TIMER_FRAMES;
    GLuint64 last = 0;
    bool have_last = false;
    for (unsigned slot = 0; slot <= pass_count; slot++) {
        if (slot > 0)
            pass_ms[slot - 1] = 0;
        if (!t->used[frame][slot])
            continue;
        GLint ready = 0;
        GLuint64 value = 0;
        glGetQueryObjectiv(t->queries[frame][slot], GL_QUERY_RESULT_AVAILABLE, &ready);
        if (!ready)
            return;
        glGetQueryObjectui64v(t->queries[frame][slot], GL_QUERY_RESULT, &value);
        if (slot > 0 && have_last)
            pass_ms[slot - 1] = (double)(value - last) * 1e-6;
        last = value;
        have_last = true;
    }
}
