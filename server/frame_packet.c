#include "frame_packet.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct packet *packet_create(size_t size, bool binary)
{
    if (size > SIZE_MAX - sizeof(struct packet) - PACKET_HEADROOM)
        return NULL;
    struct packet *packet = malloc(sizeof *packet + PACKET_HEADROOM + size);
    if (!packet)
        return NULL;
    atomic_init(&packet->refs, 1);
    packet->binary = binary;
    packet->size = size;
    packet->data = (uint8_t *)(packet + 1) + PACKET_HEADROOM;
    return packet;
}

struct packet *packet_from_text(const char *text, size_t size)
{
    struct packet *packet = packet_create(size, false);
    if (packet)
        memcpy(packet->data, text, size);
    return packet;
}

struct packet *packet_ref(struct packet *packet)
{
    atomic_fetch_add(&packet->refs, 1);
    return packet;
}

void packet_unref(struct packet *packet)
{
    if (!packet)
        return;
    unsigned before = atomic_fetch_sub(&packet->refs, 1);
    assert(before > 0);
    if (before == 1)
        free(packet);
}

static void put(uint8_t *out, uint64_t value, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++)
        out[i] = (uint8_t)(value >> (8 * i));
}

void frame_header_write(const struct frame_header *header, uint8_t out[GNMF_HEADER_SIZE])
{
    memset(out, 0, GNMF_HEADER_SIZE);
    memcpy(out + GNMF_AT_MAGIC, GNMF_MAGIC, 4);
    put(out + GNMF_AT_VERSION, GNMF_VERSION, 1);
    put(out + GNMF_AT_HEADER_LEN, GNMF_HEADER_SIZE, 1);
    put(out + GNMF_AT_KIND, header->kind, 1);
    put(out + GNMF_AT_CODEC, header->codec, 1);
    put(out + GNMF_AT_FLAGS, header->flags, 2);
    put(out + GNMF_AT_ALGORITHM, header->algorithm, 2);
    put(out + GNMF_AT_VIEW, header->view, 4);
    put(out + GNMF_AT_FRAME, header->frame, 8);
    put(out + GNMF_AT_INPUT_TIME_US, header->input_time_us, 8);
    put(out + GNMF_AT_INPUT_SEQ, header->input_seq, 4);
    put(out + GNMF_AT_WIDTH, header->width, 2);
    put(out + GNMF_AT_HEIGHT, header->height, 2);
    put(out + GNMF_AT_RENDER_US, header->render_us, 4);
    put(out + GNMF_AT_ENCODE_US, header->encode_us, 4);
    put(out + GNMF_AT_REQUEST_ID, header->request_id, 4);
}

uint32_t frame_microseconds(double milliseconds)
{
    double us = milliseconds * 1000;
    if (!(us > 0))
        return 0;
    return us < UINT32_MAX ? (uint32_t)us : UINT32_MAX;
}
