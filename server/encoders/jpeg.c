#include "encoders/jpeg.h"

#include <stdlib.h>
#include <turbojpeg.h>

#include "base/error.h"

/* From here on the picture is meant to be looked at, not to move: full colour resolution keeps thin shadow edges from smearing. */
#define FULL_COLOUR_QUALITY 85

struct jpeg_encoder {
    tjhandle handle;
    unsigned char *scratch;
    unsigned long capacity;
};

struct jpeg_encoder *jpeg_encoder_create(struct error *err)
{
    struct jpeg_encoder *encoder = calloc(1, sizeof *encoder);
    if (encoder && (encoder->handle = tjInitCompress()))
        return encoder;
    error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for a JPEG encoder");
    free(encoder);
    return NULL;
}

void jpeg_encoder_destroy(struct jpeg_encoder *encoder)
{
    if (!encoder)
        return;
    tjDestroy(encoder->handle);
    free(encoder->scratch);
    free(encoder);
}

static bool reserve(struct jpeg_encoder *encoder, unsigned long wanted, struct error *err)
{
    if (wanted == (unsigned long)-1)
        return error_set(err, ERROR_USAGE, "size",
                         "a picture of this size cannot be encoded as JPEG; a side may have at most 65500 pixels");
    if (wanted <= encoder->capacity)
        return true;
    unsigned char *grown = realloc(encoder->scratch, wanted);
    if (!grown)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for %lu bytes of JPEG", wanted);
    encoder->scratch = grown;
    encoder->capacity = wanted;
    return true;
}

bool jpeg_encode(struct jpeg_encoder *encoder, const uint8_t *rgba, uint32_t width, uint32_t height, int quality,
                 const uint8_t **out, size_t *size, struct error *err)
{
    int sampling = quality >= FULL_COLOUR_QUALITY ? TJSAMP_444 : TJSAMP_420;
    if (!reserve(encoder, tjBufSize((int)width, (int)height, sampling), err))
        return false;
    unsigned long written = encoder->capacity;
    if (tjCompress2(encoder->handle, rgba, (int)width, 0, (int)height, TJPF_RGBX, &encoder->scratch, &written, sampling, quality,
                    TJFLAG_NOREALLOC) != 0)
        return error_set(err, ERROR_BUG, NULL, "JPEG encoding failed: %s", tjGetErrorStr2(encoder->handle));
    *out = encoder->scratch;
    *size = written;
    return true;
}
