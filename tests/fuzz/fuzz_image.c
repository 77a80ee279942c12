/* The bytes of a texture: PNG, JPEG, WebP. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/error.h"
#include "import/import.h"
#include "scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct error err = {0};
    struct image image = {0};
    if (image_decode(data, size, "the input", &image, &err)) {
        assert(image.width >= 1 && image.height >= 1 && image.width <= 16384 && image.height <= 16384);
        /* The far corner: a decoder that gave less than it said is seen here. */
        volatile uint8_t last = image.rgba[(size_t)image.width * image.height * 4 - 1];
        (void)last;
        free(image.rgba);
    } else {
        assert(err.code == ERROR_DATA && err.message[0]);
    }
    return 0;
}
