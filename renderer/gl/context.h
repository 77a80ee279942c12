/* An EGL display and an OpenGL 4.5 core context without a window. The context is current on the thread that created it, and stays there.
 *
 * GL state contract, for every function of the renderer: whoever changes one of these restores it to the value given here -
 * depth test off, blend off, cull off, depth clamp off, scissor off, viewport arbitrary, pixel pack/unpack alignment 4 and buffers unbound,
 * clip control lower-left with depth 0..1. Programs, vertex arrays, framebuffers, textures and buffers may be left bound. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "gl/device.h"

struct error;
struct gl_programs;

struct gl_caps {
    bool software;            /* llvmpipe or another rasterizer on the CPU: shares the cores with everything else */
    bool conservative_raster; /* NV or INTEL extension */
    int max_texture_size;
    long max_texture_buffer; /* texels */
    long max_storage_block;  /* bytes */
};

struct gl_context {
    struct device_info device;
    struct gl_caps caps;
    char cache_key[320];          /* vendor, renderer and version: what a program binary depends on */
    bool failed;                  /* sticky: a GL error or a reset was seen (gl_check) */
    struct gl_programs *programs; /* set by gl_programs_create(): whoever draws finds its programs here */
    void *display, *context;      /* EGLDisplay, EGLContext */
    void *gbm;                    /* struct gbm_device, NULL unless platform gbm */
    int gbm_fd;
};

struct gl_context_options {
    const char *device; /* index, DRM node, "cuda:N", "software", or NULL: first that works */
    unsigned threads;   /* for a software rasterizer: LP_NUM_THREADS, unless the environment sets it */
    bool debug;         /* GL debug messages to the log, synchronously */
};

/* Tries the EGL device platform by index, then surfaceless, then GBM. ERROR_NO_DEVICE tells each attempt and why it failed. */
bool gl_context_init(struct gl_context *gl, const struct gl_context_options *options, struct error *err);
void gl_context_finish(struct gl_context *gl);

/* The one funnel for GL errors: asks GL, logs with the caller's name, sets `failed`. False when there was one. */
bool gl_check_at(struct gl_context *gl, const char *where, struct error *err);
#define gl_check(gl, err) gl_check_at((gl), __func__, (err))
