/* A binary WebSocket message is one frame: this header, then the encoded picture. Little-endian, offsets in bytes.
 * docs: proto/README.md. Stands alone: no include but stdint. */
#pragma once

#include <stdint.h>

#define GNMF_MAGIC       "GNMF"
#define GNMF_VERSION     1
#define GNMF_HEADER_SIZE 64

enum gnmf_kind { GNMF_STREAM = 0, GNMF_SNAPSHOT = 1, GNMF_DIFFERENCE = 2 };
enum gnmf_codec { GNMF_JPEG = 0, GNMF_PNG = 1, GNMF_WEBP = 2, GNMF_EXR = 3 };
enum gnmf_flags { GNMF_KEY = 1, GNMF_STILL = 2, GNMF_LOSSLESS = 4 };

enum gnmf_offset {
    GNMF_AT_MAGIC = 0,
    GNMF_AT_VERSION = 4,        /* u8 */
    GNMF_AT_HEADER_LEN = 5,     /* u8, 64 */
    GNMF_AT_KIND = 6,           /* u8, enum gnmf_kind */
    GNMF_AT_CODEC = 7,          /* u8, enum gnmf_codec */
    GNMF_AT_FLAGS = 8,          /* u16, enum gnmf_flags or-ed */
    GNMF_AT_ALGORITHM = 10,     /* u16, index in server.hello's algorithms */
    GNMF_AT_VIEW = 12,          /* u32 */
    GNMF_AT_FRAME = 16,         /* u64, 1 for a view's first, rising */
    GNMF_AT_INPUT_TIME_US = 24, /* u64, as the client sent it with the newest input this frame shows */
    GNMF_AT_INPUT_SEQ = 32,     /* u32, likewise */
    GNMF_AT_WIDTH = 36,         /* u16, pixels */
    GNMF_AT_HEIGHT = 38,        /* u16, pixels */
    GNMF_AT_RENDER_US = 40,     /* u32 */
    GNMF_AT_ENCODE_US = 44,     /* u32 */
    GNMF_AT_REQUEST_ID = 48,    /* u32, snapshots: as given in the request; else 0 */
    GNMF_AT_RESERVED = 52,      /* 12 zero bytes */
};
