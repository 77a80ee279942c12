/* What travels from an encoder to a socket: one ref-counted run of bytes, immutable once published. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/frame_header.h"

/* Bytes before the data that the socket library may write its own framing into. */
#define PACKET_HEADROOM 32

struct packet {
    _Atomic unsigned refs;
    bool binary; /* else UTF-8 text */
    size_t size;
    uint8_t *data; /* `size` bytes, PACKET_HEADROOM writable bytes before them */
};

/* One reference, `size` uninitialised bytes; NULL when memory is out. */
struct packet *packet_create(size_t size, bool binary);
struct packet *packet_from_text(const char *text, size_t size);
struct packet *packet_ref(struct packet *packet);
void packet_unref(struct packet *packet); /* accepts NULL; any thread */

/* The header's fields; proto/frame_header.h says what they mean. */
struct frame_header {
    enum gnmf_kind kind;
    enum gnmf_codec codec;
    uint16_t flags;
    uint16_t algorithm;
    uint32_t view;
    uint64_t frame;
    uint64_t input_time_us;
    uint32_t input_seq;
    uint16_t width, height;
    uint32_t render_us, encode_us;
    uint32_t request_id;
};

void frame_header_write(const struct frame_header *header, uint8_t out[GNMF_HEADER_SIZE]);

/* Microseconds from milliseconds, saturating; not a number is 0. */
uint32_t frame_microseconds(double milliseconds);
