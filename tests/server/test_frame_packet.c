#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "frame_packet.h"

/* Every field at its place, each byte different: proto/README.md's table, written out by hand. */
static void test_header_bytes(void **state)
{
    (void)state;
    static const uint8_t wanted[GNMF_HEADER_SIZE] = {
        'G',  'N',  'M',  'F',  1,    64,   2,    3,    0x02, 0x01, 0x04, 0x03, 0x08, 0x07, 0x06, 0x05, 0x18, 0x17,
        0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0x28, 0x27, 0x26, 0x25, 0x24, 0x23, 0x22, 0x21, 0x34, 0x33, 0x32, 0x31,
        0x36, 0x35, 0x38, 0x37, 0x44, 0x43, 0x42, 0x41, 0x54, 0x53, 0x52, 0x51, 0x64, 0x63, 0x62, 0x61,
    };
    struct frame_header header = {.kind = GNMF_DIFFERENCE,
                                  .codec = GNMF_EXR,
                                  .flags = 0x0102,
                                  .algorithm = 0x0304,
                                  .view = 0x05060708,
                                  .frame = 0x1112131415161718,
                                  .input_time_us = 0x2122232425262728,
                                  .input_seq = 0x31323334,
                                  .width = 0x3536,
                                  .height = 0x3738,
                                  .render_us = 0x41424344,
                                  .encode_us = 0x51525354,
                                  .request_id = 0x61626364};
    uint8_t bytes[GNMF_HEADER_SIZE];
    memset(bytes, 0xff, sizeof bytes);
    frame_header_write(&header, bytes);
    assert_memory_equal(bytes, wanted, sizeof wanted);
}

static void test_microseconds(void **state)
{
    (void)state;
    assert_int_equal(frame_microseconds(1.5), 1500);
    assert_int_equal(frame_microseconds(-1), 0);
    assert_int_equal(frame_microseconds(0.0 / 0.0), 0);
    assert_int_equal(frame_microseconds(1e300), UINT32_MAX);
}

static void test_references(void **state)
{
    (void)state;
    struct packet *packet = packet_from_text("text", 4);
    assert_non_null(packet);
    assert_false(packet->binary);
    assert_int_equal(packet->size, 4);
    memset(packet->data - PACKET_HEADROOM, 0, PACKET_HEADROOM); /* ASan watches */
    assert_ptr_equal(packet_ref(packet), packet);
    packet_unref(packet);
    assert_memory_equal(packet->data, "text", 4);
    packet_unref(packet);
    packet_unref(NULL);
    assert_null(packet_create(SIZE_MAX - 8, true));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_header_bytes),
        cmocka_unit_test(test_microseconds),
        cmocka_unit_test(test_references),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
