/* Plans and writers without a device: a made-up suite, cells filled in by hand. */
#include <ctype.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "bench/findings.h"
#include "bench/goals.h"
#include "bench/html.h"
#include "bench/pictures.h"
#include "bench/shots.h"
#include "bench/write.h"

#define LIST(...) ((const char *const[]){__VA_ARGS__, NULL})

static const struct bench_table rows = {
    .name = "rows",
    .title = "Rows <&>",
    .note = "A note.",
    .scenes = LIST("builtin:box", "@tree"),
    .algorithms = LIST("sm:size=512", "sm", "sm:slope=2", "pcf", "no_such_system:size=3", "sm:no_such=1"),
    .measures = MEASURE_STILL | MEASURE_MOVING | MEASURE_POINT,
    .baseline = "sm",
};
static const struct bench_table again = {
    .name = "again",
    .title = "Again",
    .note = "The same cells.",
    .shape = SHAPE_MATRIX,
    .scenes = LIST("builtin:box"),
    .algorithms = LIST("pcf"),
    .measures = MEASURE_SAMPLES32,
};
static const struct bench_goal goals[] = {
    {GOAL_ERROR_RATIO, "@tree", "pcf", "sm", 0.5}, {GOAL_MOVING_RATIO, NULL, "pcf", "sm", 1.5}, {0}};
static const struct bench_suite suite = {.name = "made_up",
                                         .summary = "made up",
                                         .tables = (const struct bench_table *const[]){&rows, &again, NULL},
                                         .goals = goals,
                                         .frames = 4,
                                         .width = 64,
                                         .height = 32};

static struct bench_report make_report(const char *filter)
{
    struct error err = {0};
    struct bench_report r = {.threads = 2, .command = "gnomon bench --filter '<b>'"};
    const struct bench_options options = {.suite = &suite, .filter = filter};
    assert_true(bench_plan_init(&r.plan, &options, &err));
    snprintf(r.device.renderer, sizeof r.device.renderer, "a <device> & more");
    return r;
}

/* Times base, 2 base, ...; the moving ones three times that. */
static void fill(struct bench_report *r)
{
    for (size_t i = 0; i < r->plan.cells.count; i++) {
        struct bench_cell *c = &r->plan.cells.data[i];
        bool second = strstr(c->name, "pcf") != NULL;
        c->started = true;
        for (int k = 0; k < REGIME_COUNT; k++) {
            struct bench_times *t = &c->times[k];
            *t = (struct bench_times){.measured = true, .rounds = 4, .passes_measured = true};
            t->frame_ms = malloc(4 * sizeof *t->frame_ms);
            for (int j = 0; j < 4; j++)
                t->frame_ms[j] = (j + 1) * (second ? 2.0 : 1.0) * (k ? 3 : 1);
        }
        struct bench_errors *e = &c->errors[AGAINST_POINT_INDEX];
        e->measured = true;
        e->m = (struct metrics){.receivers = 1000,
                                .misclassified = second                     ? 5
                                                 : strstr(c->name, "slope") ? 20
                                                                            : 40,
                                .wrong_samples = -1};
        e->m.misclassified_fraction = (double)e->m.misclassified / 1000;
    }
}

static const struct bench_cell *find(const struct bench_plan *plan, const char *scene, const char *name)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        if (!strcmp(plan->setups.data[plan->cells.data[i].setup].scene, scene) && !strcmp(plan->cells.data[i].name, name))
            return &plan->cells.data[i];
    fail();
    return NULL;
}

static void a_plan_shares_cells_and_says_what_it_leaves_out(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    const struct bench_cell *pcf = find(&r.plan, "builtin:box", "pcf");
    assert_int_equal(r.plan.cells.count, 8);
    assert_int_equal(r.plan.left_out.count, 2);
    assert_non_null(strstr(r.plan.left_out.data[0], "no_such_system"));
    assert_int_equal(pcf->tables, 3);
    assert_true(pcf->measures & MEASURE_SAMPLES32 && pcf->measures & MEASURE_STILL);
    assert_true(bench_plan_seconds(&r.plan) > 0);
    /* Batches are of one setup and one map size. */
    for (size_t first = 0; first < r.plan.cells.count;) {
        size_t end = bench_batch_end(&r.plan, first);
        for (size_t i = first; i < end; i++) {
            assert_int_equal(r.plan.cells.data[i].setup, r.plan.cells.data[first].setup);
            assert_int_equal(r.plan.cells.data[i].map_size, r.plan.cells.data[first].map_size);
        }
        first = end;
    }
    bench_report_finish(&r);
}

static void a_filter_wants_all_of_its_words(void **state)
{
    (void)state;
    struct bench_report r = make_report("box,size=512");
    assert_int_equal(r.plan.cells.count, 1);
    assert_string_equal(r.plan.cells.data[0].name, "sm:size=512");
    bench_report_finish(&r);
    struct error err = {0};
    const struct bench_options options = {.suite = &suite, .filter = "nowhere"};
    assert_false(bench_plan_init(&r.plan, &options, &err));
    assert_int_equal(err.code, ERROR_USAGE);
    bench_plan_finish(&r.plan);
}

static void a_baseline_is_plain_and_of_the_same_map_size(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    fill(&r);
    const struct bench_cell *pcf = find(&r.plan, "builtin:tree", "pcf");
    const struct bench_cell *base = bench_baseline(&r.plan, pcf, "sm");
    assert_ptr_equal(base, find(&r.plan, "builtin:tree", "sm"));
    assert_null(bench_baseline(&r.plan, base, "sm"));
    assert_null(bench_baseline(&r.plan, pcf, NULL));
    /* The best of any bias, but not of another size. */
    assert_int_equal(bench_best_misclassified(&r.plan, pcf, "sm"), 20);
    assert_int_equal(bench_best_misclassified(&r.plan, find(&r.plan, "builtin:tree", "sm:size=512"), "sm"), 40);
    bench_report_finish(&r);
}

static void goals_are_met_or_missed(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    struct goal_result results[8];
    fill(&r);
    assert_int_equal(bench_goals_check(&r.plan, results, 8), 3);
    assert_true(results[0].met && results[0].value == 0.25);
    assert_false(results[1].met);
    assert_true(results[1].value == 2);
    struct bench_glance glances[8];
    size_t count = bench_glances(&r.plan, glances, 8);
    assert_int_equal(count, 2);
    assert_true(glances[1].still_ratio == 2 && glances[1].error_ratio == 0.25);
    struct bench_findings findings;
    bench_findings_make(&r.plan, &findings);
    assert_true(findings.sentences.count > 1);
    assert_string_equal(findings.sentences.data[0], "Of 3 goals that could be checked 1 are met.");
    bench_findings_finish(&findings);
    bench_report_finish(&r);
}

static char *written(void (*write)(const struct bench_report *r, FILE *out), const struct bench_report *r)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    write(r, out);
    fclose(out);
    return text;
}

/* The next tag's name into `name`, "/name" for an end; NULL after the last. */
static const char *next_tag(const char *at, char name[32])
{
    at = strchr(at, '<');
    if (!at)
        return NULL;
    size_t n = 0;
    for (at++; n < 31 && (isalnum((unsigned char)*at) || *at == '/' || *at == '!'); at++)
        name[n++] = *at;
    name[n] = 0;
    return at;
}

/* Whether each end closes what was opened last. Elements that HTML lets stay open or that close themselves do not count. */
static bool well_formed(const char *html)
{
    static const char *const passed_over[] = {"!doctype", "meta", "img",  "th", "li", "/li", "line",
                                              "circle",   "path", "rect", "p",  "/p", NULL};
    char stack[64][32], name[32];
    size_t depth = 0;
    for (const char *at = html; (at = next_tag(at, name));) {
        bool counts = true;
        for (size_t i = 0; passed_over[i]; i++)
            counts = counts && strcmp(passed_over[i], name);
        if (!counts)
            continue;
        if (name[0] == '/' && (depth == 0 || strcmp(stack[--depth], name + 1)))
            return false;
        if (name[0] == '/')
            continue;
        if (!name[0] || depth == 64)
            return false;
        strcpy(stack[depth++], name);
    }
    return depth == 0;
}

static void the_page_is_well_formed_and_has_every_cell(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    fill(&r);
    snprintf(r.plan.cells.data[2].failed, sizeof r.plan.cells.data[2].failed, "it was <refused>");
    char *html = written(bench_html, &r);
    assert_true(well_formed(html));
    for (size_t i = 0; i < r.plan.cells.count; i++)
        assert_non_null(strstr(html, r.plan.cells.data[i].name));
    assert_non_null(strstr(html, "a &lt;device&gt; &amp; more"));
    assert_non_null(strstr(html, "it was &lt;refused&gt;"));
    assert_non_null(strstr(html, "no_such_system"));
    assert_non_null(strstr(html, "class=front"));
    assert_null(strstr(html, "<script"));
    assert_null(strstr(html, "http"));
    /* The check can fail. */
    assert_false(well_formed("<div><b></div></b>"));
    assert_false(well_formed("<div>"));
    assert_false(well_formed("</div>"));
    free(html);
    bench_report_finish(&r);
}

static void a_page_of_nothing(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    r.interrupted = true;
    char *html = written(bench_html, &r);
    assert_true(well_formed(html));
    assert_non_null(strstr(html, "ended early"));
    free(html);
    bench_report_finish(&r);
}

static size_t count_of(const char *text, char c)
{
    size_t n = 0;
    for (; *text; text++)
        n += *text == c;
    return n;
}

static void csv_has_a_line_a_cell_of_as_many_fields(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    fill(&r);
    char *csv = written(bench_csv, &r), *rest = NULL;
    size_t lines = 0, fields = 0;
    for (char *line = strtok_r(csv, "\r\n", &rest); line; line = strtok_r(NULL, "\r\n", &rest)) {
        size_t commas = count_of(line, ',');
        fields = lines ? fields : commas;
        assert_int_equal(commas, fields);
        lines++;
    }
    assert_int_equal(lines, r.plan.cells.count + 1);
    free(csv);
    bench_report_finish(&r);
}

static void json_reads_back(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    fill(&r);
    json_t *root = bench_json(&r);
    assert_non_null(root);
    json_t *cells = json_object_get(root, "cells");
    assert_int_equal(json_array_size(cells), r.plan.cells.count);
    for (size_t i = 0; i < json_array_size(cells); i++) {
        json_t *still = json_object_get(json_object_get(json_array_get(cells, i), "still"), "frame_ms");
        assert_true(json_number_value(json_object_get(still, "median")) > 0);
    }
    json_decref(root);
    bench_report_finish(&r);
}

static void text_has_every_cell(void **state)
{
    (void)state;
    struct bench_report r = make_report(NULL);
    fill(&r);
    char *text = written(bench_text, &r);
    for (size_t i = 0; i < r.plan.cells.count; i++)
        assert_non_null(strstr(text, r.plan.cells.data[i].name));
    free(text);
    bench_report_finish(&r);
}

static void base64_as_in_rfc_4648(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        char *text = NULL, expected[40];
        size_t size;
        FILE *out = open_memstream(&text, &size);
        html_put_data(out, "x/y", (const uint8_t *)pairs[i][0], strlen(pairs[i][0]));
        fclose(out);
        snprintf(expected, sizeof expected, "data:x/y;base64,%s", pairs[i][1]);
        assert_string_equal(text, expected);
        free(text);
    }
}

static void short_names(void **state)
{
    (void)state;
    char name[40];
    html_short_name("sm:size=1024,slope=2", name, sizeof name);
    assert_string_equal(name, "sm 1024 slope=2");
    html_short_name("sm:size=1024,slope=2", name, 6);
    assert_string_equal(name, "sm 10");
}

static void a_crop_lies_where_most_is_wrong(void **state)
{
    (void)state;
    enum { WIDTH = 20, HEIGHT = 12, PIXELS = WIDTH * HEIGHT };
    float tested[PIXELS] = {0}, truth[PIXELS] = {0};
    uint8_t receiver[PIXELS];
    memset(receiver, 1, sizeof receiver);
    const struct bench_shot shot = {.width = WIDTH, .height = HEIGHT, .tested = tested, .truth = truth, .receiver = receiver};
    tested[1 * WIDTH + 1] = 1;
    tested[8 * WIDTH + 15] = tested[9 * WIDTH + 16] = 1;
    struct crop c = crop_most_wrong(&shot, 4, 4);
    assert_true(c.x <= 15 && c.x + c.width > 16 && c.y <= 8 && c.y + c.height > 9);
    receiver[8 * WIDTH + 15] = receiver[9 * WIDTH + 16] = 0;
    c = crop_most_wrong(&shot, 4, 4);
    assert_true(c.x <= 1 && c.y <= 1);
    c = crop_most_wrong(&shot, 100, 100);
    assert_true(c.width == WIDTH && c.height == HEIGHT && c.x == 0 && c.y == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_shares_cells_and_says_what_it_leaves_out),
        cmocka_unit_test(a_filter_wants_all_of_its_words),
        cmocka_unit_test(a_baseline_is_plain_and_of_the_same_map_size),
        cmocka_unit_test(goals_are_met_or_missed),
        cmocka_unit_test(the_page_is_well_formed_and_has_every_cell),
        cmocka_unit_test(a_page_of_nothing),
        cmocka_unit_test(csv_has_a_line_a_cell_of_as_many_fields),
        cmocka_unit_test(json_reads_back),
        cmocka_unit_test(text_has_every_cell),
        cmocka_unit_test(base64_as_in_rfc_4648),
        cmocka_unit_test(short_names),
        cmocka_unit_test(a_crop_lies_where_most_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
