/* The text of --light. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "lights.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = 0;
    struct error err = {0};
    struct light light;
    if (light_parse(text, &light, &err)) {
        assert(dvec3_finite(light.position) && fabs(dvec3_length(light.direction) - 1) < 1e-9);
        assert(light.intensity >= 0 && (light.kind != LIGHT_SPOT || light.inner < light.outer));
    } else {
        assert(err.code == ERROR_USAGE && err.message[0]);
    }
    free(text);
    return 0;
}
