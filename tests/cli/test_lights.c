#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "lights.h"

static struct light parse(const char *text)
{
    struct light light;
    struct error err = {0};
    if (!light_parse(text, &light, &err))
        fail_msg("%s: %s", text, err.message);
    return light;
}

static void reads_every_key(void **state)
{
    (void)state;
    struct light l =
        parse("spot position=1,2,3 direction=0,-2,0 color=1,0.5,0.25 intensity=100 radius=0.1 inner=10 outer=30 range=50");
    assert_int_equal(l.kind, LIGHT_SPOT);
    assert_true(l.position.x == 1 && l.position.y == 2 && l.position.z == 3);
    assert_true(l.direction.x == 0 && l.direction.y == -1 && l.direction.z == 0);
    assert_true(l.color[0] == 1 && l.color[1] == 0.5f && l.color[2] == 0.25f);
    assert_true(l.intensity == 100 && l.radius == 0.1 && l.range == 50);
    assert_true(fabs(l.inner - M_PI / 18) < 1e-15 && fabs(l.outer - M_PI / 6) < 1e-15);
}

static void takes_the_extensions_defaults(void **state)
{
    (void)state;
    struct light l = parse("  directional\t");
    assert_int_equal(l.kind, LIGHT_DIRECTIONAL);
    assert_true(l.intensity == 1 && l.color[2] == 1 && l.direction.z == -1);
    l = parse("spot");
    assert_true(l.inner == 0 && l.outer == M_PI / 4);
}

static void normalizes_any_direction(void **state)
{
    (void)state;
    static const char *const directions[] = {"directional direction=3,4,0", "directional direction=1e-200,1e-200,0",
                                             "directional direction=1e17,-1e17,1e17"};
    for (size_t i = 0; i < 3; i++)
        assert_true(fabs(dvec3_length(parse(directions[i]).direction) - 1) < 1e-15);
}

struct refusal {
    const char *text, *says; /* part of the message */
};

static void refuses_and_says_what_it_takes(void **state)
{
    (void)state;
    static const struct refusal bad[] = {
        {"", "point, spot or directional"},
        {"lamp", "point, spot or directional"},
        {"Point", "point, spot or directional"},
        {"position=1,2,3", "point, spot or directional"},
        {"point position", "not key=value"},
        {"point direction=1,0,0", "position, color, intensity, radius or range"},
        {"directional position=1,0,0", "direction, color, intensity or radius"},
        {"point position=1,2", "three finite numbers"},
        {"point position=1,2,3,4", "three finite numbers"},
        {"point position=1,2,nan", "three finite numbers"},
        {"point position=", "three finite numbers"},
        {"point intensity=", "one finite number"},
        {"point intensity=1x", "one finite number"},
        {"point intensity=-1", "0 to 1e+24"},
        {"point intensity=1e25", "0 to 1e+24"},
        {"point color=1,1,-0.1", "0 to 1e+06"},
        {"spot outer=91", "0 to 90"},
        {"spot inner=-1", "0 to 90"},
        {"spot inner=30 outer=30", "must be less"},
        {"spot inner=50", "must be less"},
        {"spot outer=0", "must be less"},
        {"spot direction=0,0,0", "not all zero"},
        {"point range=-1", "0 to 1e+18"},
        {"point intensity=1 intensity=2", "given twice"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct light l;
        struct error err = {0};
        if (light_parse(bad[i].text, &l, &err))
            fail_msg("'%s' was taken", bad[i].text);
        assert_int_equal(err.code, ERROR_USAGE);
        if (!strstr(err.message, bad[i].says))
            fail_msg("'%s' says: %s", bad[i].text, err.message);
        assert_null(strchr(err.message, '\n'));
    }
}

static void refuses_endless_text(void **state)
{
    (void)state;
    char text[4096];
    memset(text, ' ', sizeof text);
    text[sizeof text - 1] = 0;
    memcpy(text, "point", 5);
    struct light l;
    struct error err = {0};
    assert_false(light_parse(text, &l, &err));
    assert_int_equal(err.code, ERROR_USAGE);
}

static void moves_into_scene_space(void **state)
{
    (void)state;
    struct scene scene = {.origin = {1e7, 0, -5}};
    struct light world = parse("spot position=10000001,2,3 direction=0,-1,0");
    struct light l = light_from_world(&scene, &world);
    assert_true(l.position.x == 1 && l.position.y == 2 && l.position.z == 8);
    assert_true(l.direction.y == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_every_key),          cmocka_unit_test(takes_the_extensions_defaults),
        cmocka_unit_test(normalizes_any_direction), cmocka_unit_test(refuses_and_says_what_it_takes),
        cmocka_unit_test(refuses_endless_text),     cmocka_unit_test(moves_into_scene_space),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
