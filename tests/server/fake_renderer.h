/* renderer.h without GL: gradients whose colour follows the camera, ready after a delay. Linked in the renderer's place. */
#pragma once

#include <stdatomic.h>

struct fake_renderer {
    atomic_uint submitted, collected, scenes; /* counts; scenes: uploaded now */
    atomic_uint delay_us;                     /* from submission to done */
    atomic_uint rounds;                       /* a frame has converged once so many were submitted */
    atomic_bool fail_submit, fail_scene, lose;
};

extern struct fake_renderer fake;
