/* The GL devices of this machine. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct device_info {
    int index;                                    /* what --device takes; -1: a platform without an index */
    char platform[16];                            /* "device", "surfaceless", "gbm" */
    char node[64];                                /* DRM node, "" if none */
    char vendor[64], renderer[128], version[128]; /* as GL says; "" when no context could be made */
    char why_not[160];                            /* "" when usable */
    int cuda;                                     /* CUDA ordinal (EGL_NV_device_cuda), -1 if none: it need not equal the index */
    bool software;
};

/* Tries every device; returns how many were written to `out` (at most `max`). Makes and destroys a context for each, and ends
 * their displays: not to be called while a renderer lives. */
size_t gl_device_list(struct device_info *out, size_t max);
