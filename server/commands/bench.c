#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "bench/interruption.h"
#include "bench/run.h"
#include "bench/write.h"
#include "command.h"
#include "common_options.h"
#include "numbers.h"
#include "options.h"
#include "output.h"
#include "progress.h"

enum { FRAMES_MAX = 1000 };

struct bench_command {
    struct common_options common; /* only what set_common() lets through */
    struct bench_options bench;
    const char *json, *csv, *html; /* NULL: none */
};

static bool set_suite(void *target, const char *value, struct error *err)
{
    struct bench_command *c = target;
    const char *names[8] = {NULL};
    char list[100];
    c->bench.suite = bench_suite_find(value);
    if (c->bench.suite)
        return true;
    for (size_t i = 0; bench_suites[i] && i + 1 < sizeof names / sizeof names[0]; i++)
        names[i] = bench_suites[i]->name;
    name_list(names, list, sizeof list);
    return error_set(err, ERROR_USAGE, "suite", "%s are accepted", list);
}

static bool set_json(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct bench_command *)target)->json = value;
    return true;
}

static bool set_csv(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct bench_command *)target)->csv = value;
    return true;
}

static bool set_html(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct bench_command *)target)->html = value;
    return true;
}

static bool set_pictures(void *target, const char *value, struct error *err)
{
    static const char *const names[] = {"models", "builtin", "none", NULL};
    struct bench_command *c = target;
    int index = name_index(names, value);
    c->bench.pictures = index != 2;
    c->bench.builtin_pictures = index == 1;
    return index >= 0 || error_set(err, ERROR_USAGE, "pictures", "models, builtin or none are accepted");
}

static bool set_models(void *target, const char *value, struct error *err)
{
    ((struct bench_command *)target)->bench.models = value;
    if (!*value || access(value, R_OK | X_OK) == 0)
        return true;
    return error_set(err, ERROR_USAGE, "models", "a readable folder is accepted, or '' for built-in scenes only");
}

static bool set_filter(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct bench_command *)target)->bench.filter = value;
    return true;
}

static bool set_tables(void *target, const char *value, struct error *err)
{
    (void)err;
    ((struct bench_command *)target)->bench.tables = value;
    return true;
}

static bool set_frames(void *target, const char *value, struct error *err)
{
    unsigned long n;
    if (!number_parse_unsigned(value, 1, FRAMES_MAX, &n))
        return error_set(err, ERROR_USAGE, "frames", "1 to %d frames are accepted", FRAMES_MAX);
    ((struct bench_command *)target)->bench.frames = (unsigned)n;
    return true;
}

static bool set_quick(void *target, const char *value, struct error *err)
{
    (void)value, (void)err;
    ((struct bench_command *)target)->bench.quick = true;
    return true;
}

static bool set_size(void *target, const char *value, struct error *err)
{
    struct bench_command *c = target;
    return number_parse_size(value, RENDERER_SIZE_MAX, &c->bench.width, &c->bench.height, err);
}

/* The few common options that make sense here keep their parsers. */
static bool set_common(const char *name, void *target, const char *value, struct error *err)
{
    for (const struct option *o = common_option_table; o->name; o++)
        if (!strcmp(o->name, name))
            return o->set(&((struct bench_command *)target)->common, value, err);
    return error_set(err, ERROR_BUG, name, "is no common option; please report this");
}

static bool set_threads(void *target, const char *value, struct error *err) { return set_common("threads", target, value, err); }
static bool set_device(void *target, const char *value, struct error *err) { return set_common("device", target, value, err); }
static bool set_quiet(void *target, const char *value, struct error *err) { return set_common("quiet", target, value, err); }
static bool set_log_level(void *target, const char *value, struct error *err)
{
    return set_common("log-level", target, value, err);
}

#define MODELS_DEFAULT "../shared/scenes"

static const struct option option_table[] = {
    {"suite", "NAME", "smoke, paper, hard or full (default smoke)", set_suite},
    {"json", "FILE", "every figure as JSON; - is standard output", set_json},
    {"csv", "FILE", "a line for each cell; - is standard output", set_csv},
    {"html", "FILE", "the report: one page that needs nothing else; - is standard output", set_html},
    {"filter", "WORDS", "only what has each of the words (separated by commas) in its scene's or algorithm's name", set_filter},
    {"tables", "NAMES", "only these tables of the suite (as its JSON names them), separated by commas", set_tables},
    {"frames", "N", "timed frames of each cell, 1 to 1000; slow ones get fewer (default: the suite's)", set_frames},
    {"size", "WxH", "picture size (default: the suite's)", set_size},
    {"quick", NULL, "small pictures, few frames, light models, no maps over 2048: a first look", set_quick},
    {"models", "DIR", "folder of the models of the paper (default " MODELS_DEFAULT " where it exists, else built-in ones)",
     set_models},
    {"pictures", "OF", "the suite's figures of the models (default), of built-in scenes only (builtin), or none", set_pictures},
    {"threads", "N", "1 to 256 (default: SLURM_CPUS_PER_TASK, else the cores allowed)", set_threads},
    {"device", "DEVICE", "index of gnomon list devices, DRM node, or software", set_device},
    {"quiet", NULL, "no progress bar", set_quiet},
    {"log-level", "LEVEL", "error, warning (default), info or debug", set_log_level},
    {0},
};

static const struct syntax syntax = {
    .command = "bench",
    .usage = "[--suite smoke|paper|hard|full] [--json FILE] [--csv FILE] [--html FILE] [options]",
    .summary = "Measures what the shadow systems cost and how wrong they are, side by side.",
    .options = option_table,
    .notes =
        "The algorithms of a scene are timed in turns (A B C A B C), so that a machine that slows down slows all of them. Ctrl-C ends a\n"
        "run early: what was measured until then is written. Tables go to standard output unless a file is -.\n",
    .examples = "  gnomon bench\n"
                "  gnomon bench --suite paper --quick --html report.html\n"
                "  gnomon bench --suite full --html report.html --json report.json --csv report.csv\n"
                "  gnomon bench --suite smoke --filter sm --json -\n",
};

static bool check_outputs(const struct bench_command *c, struct error *err)
{
    const char *const files[] = {c->json, c->csv, c->html};
    int on_stdout = 0;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (files[i] && !output_check(files[i], err))
            return false;
        on_stdout += files[i] && !strcmp(files[i], "-");
    }
    if (on_stdout > 1)
        return error_set(err, ERROR_USAGE, "json", "standard output carries one thing: only one FILE may be -");
    return true;
}

static bool is_stdout(const char *path) { return path && !strcmp(path, "-"); }

/* To a file, or to standard output. */
static bool write_with(void (*write)(const struct bench_report *report, FILE *out), const char *path,
                       const struct bench_report *report, struct error *err)
{
    errno = 0;
    FILE *out = is_stdout(path) ? stdout : fopen(path, "w");
    if (out)
        write(report, out);
    bool good = out && fflush(out) == 0 && !ferror(out);
    int why = errno;
    if (out && out != stdout && fclose(out) != 0 && good) {
        good = false;
        why = errno;
    }
    return good || error_set(err, ERROR_IO, NULL, "cannot write %s: %s", path, why ? strerror(why) : "write error");
}

static bool write_all(const struct bench_command *c, const struct bench_report *report, struct error *err)
{
    if (c->json && !output_json(c->json, bench_json(report), err))
        return false;
    if ((c->csv && !write_with(bench_csv, c->csv, report, err)) || (c->html && !write_with(bench_html, c->html, report, err)))
        return false;
    if (is_stdout(c->json) || is_stdout(c->csv) || is_stdout(c->html))
        return true;
    bench_text(report, stdout);
    return output_flush(err);
}

static void join_command(int argc, char **argv, char *out, size_t size)
{
    size_t used = (size_t)snprintf(out, size, "gnomon");
    for (int i = 0; i < argc && used < size; i++)
        used += (size_t)snprintf(out + used, size - used, !*argv[i] || strpbrk(argv[i], " '\"*") ? " '%s'" : " %s", argv[i]);
}

static size_t count_started(const struct bench_plan *plan)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->cells.count; i++)
        n += plan->cells.data[i].started;
    return n;
}

static bool run(const struct bench_command *c, struct bench_report *report, struct error *err)
{
    struct interruption interruption;
    struct progress progress;
    if (!bench_plan_init(&report->plan, &c->bench, err))
        return false;
    if (!c->common.quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "%zu cells, roughly %.0f minutes on two cores; Ctrl-C writes what there is\n", report->plan.cells.count,
                bench_plan_seconds(&report->plan) / 60 + 0.5);
    interruption_init(&interruption);
    progress_init(&progress, "bench", c->common.quiet);
    bool good = bench_run(report, &c->common, &interruption, &progress, err);
    progress_finish(&progress);
    interruption_finish(&interruption);
    if (report->interrupted)
        fprintf(stderr, "interrupted: %zu of %zu cells are in what is written\n", count_started(&report->plan),
                report->plan.cells.count);
    return good && write_all(c, report, err);
}

int command_bench(int argc, char **argv)
{
    struct bench_command command = {.bench = {.suite = bench_suites[0], .pictures = true}};
    struct bench_report report = {0};
    struct error err = {0};
    common_options_init(&command.common);
    command.bench.models = access(MODELS_DEFAULT, R_OK | X_OK) == 0 ? MODELS_DEFAULT : NULL;
    int code = options_start(&syntax, argc, argv, &command, NULL, NULL);
    if (code >= 0)
        return code;
    join_command(argc, argv, report.command, sizeof report.command);
    bool good = check_outputs(&command, &err) && run(&command, &report, &err);
    bench_report_finish(&report);
    return good ? 0 : command_fail(&err);
}
