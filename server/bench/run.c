#include "run.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "batch.h"
#include "clock.h"
#include "common_options.h"
#include "interruption.h"
#include "pictures.h"
#include "progress.h"
#include "stage.h"

struct run {
    struct bench_report *report;
    const struct common_options *common;
    struct interruption *interruption;
    struct progress *progress;
    struct stage stage; /* one renderer; the scene changes */
    const char *loaded; /* the scene in it, NULL: none */
    struct bench_truth truths[BENCH_REFERENCES];
    size_t truths_of; /* the setup; SIZE_MAX: none */
    struct bench_shots shots;
    double done_s, total_s;
};

static void advance(void *context, double seconds)
{
    struct run *run = context;
    run->done_s += seconds;
    progress_set(run->progress, run->done_s / run->total_s);
}

static void unload(struct run *run)
{
    render_scene_destroy(run->stage.uploaded);
    scene_destroy(run->stage.scene);
    run->stage.uploaded = NULL;
    run->stage.scene = NULL;
    run->loaded = NULL;
}

/* The scene's first light and copies of it, turned evenly about the scene's vertical axis. */
static void turn_lights(const struct scene *scene, unsigned lights, struct render_settings *settings)
{
    struct light first = settings->lights[0];
    for (unsigned i = 0; i < lights && i < RENDERER_LIGHTS_MAX; i++)
        settings->lights[i] = light_turned(scene, &first, 360.0 * i / lights);
    settings->light_count = lights < RENDERER_LIGHTS_MAX ? lights : RENDERER_LIGHTS_MAX;
}

static bool load(struct run *run, const struct bench_setup *setup, struct error *err)
{
    if (run->loaded && !strcmp(run->loaded, setup->scene))
        return true;
    unload(run);
    run->stage.scene = scene_load(setup->scene, err);
    if (!run->stage.scene)
        return false;
    run->loaded = setup->scene;
    return true;
}

/* A fresh upload for each batch: what the last one built on the device goes with the old one. */
static bool set_up(struct run *run, struct bench_setup *setup, struct error *err)
{
    struct common_options options = *run->common;
    if (!load(run, setup, err))
        return false;
    setup->triangles = run->stage.scene->triangle_count;
    setup->drawn_triangles = run->stage.scene->drawn_triangle_count;
    options.width = setup->width;
    options.height = setup->height;
    if (!common_options_settings(&options, run->stage.scene, &run->stage.settings, err))
        return false;
    if (setup->lights)
        turn_lights(run->stage.scene, setup->lights, &run->stage.settings);
    render_scene_destroy(run->stage.uploaded);
    run->stage.uploaded = render_scene_create(run->stage.renderer, run->stage.scene, err);
    return run->stage.uploaded != NULL;
}

static void keep_truths_of(struct run *run, size_t setup)
{
    if (run->truths_of == setup)
        return;
    bench_truths_finish(run->truths);
    run->truths_of = setup;
}

/* False: interrupted. */
static bool run_batch(struct run *run, size_t first, size_t end)
{
    struct bench_plan *plan = &run->report->plan;
    struct bench_batch batch = {
        .plan = plan,
        .cells = plan->cells.data + first,
        .count = end - first,
        .stage = &run->stage,
        .truths = run->truths,
        .shots = &run->shots,
        .interruption = run->interruption,
        .pace = {advance, run},
    };
    struct bench_setup *setup = &plan->setups.data[batch.cells[0].setup];
    struct error err = {0};
    keep_truths_of(run, batch.cells[0].setup);
    if (set_up(run, setup, &err))
        return batch_run(&batch);
    snprintf(setup->failed, sizeof setup->failed, "%s", err.message);
    for (size_t i = 0; i < batch.count; i++) {
        snprintf(batch.cells[i].failed, sizeof batch.cells[i].failed, "%s", err.message);
        batch_advance(&batch, &batch.cells[i], 1);
    }
    return true;
}

static void describe_processor(char *out, size_t size)
{
    char line[300];
    FILE *file = fopen("/proc/cpuinfo", "r");
    out[0] = 0;
    while (file && !out[0] && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (!strncmp(line, "model name", 10) && colon)
            snprintf(out, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
    }
    if (file)
        fclose(file);
}

static bool open_device(struct run *run, struct error *err)
{
    struct renderer_options wanted = common_options_renderer(run->common);
    run->stage.pool = job_pool_create(run->common->threads, err);
    if (!run->stage.pool)
        return false;
    run->stage.renderer = renderer_create(&wanted, run->stage.pool, err);
    if (!run->stage.renderer)
        return false;
    run->report->device = *renderer_device(run->stage.renderer);
    run->report->threads = run->common->threads;
    describe_processor(run->report->processor, sizeof run->report->processor);
    return true;
}

bool bench_run(struct bench_report *report, const struct common_options *common, struct interruption *interruption,
               struct progress *progress, struct error *err)
{
    struct run run = {
        report, common, interruption, progress, .truths_of = SIZE_MAX, .total_s = bench_plan_seconds(&report->plan)};
    uint64_t start = clock_us();
    report->started = time(NULL);
    bool good = open_device(&run, err), go_on = good;
    for (size_t first = 0; go_on && first < report->plan.cells.count;) {
        size_t end = bench_batch_end(&report->plan, first);
        go_on = run_batch(&run, first, end);
        first = end;
    }
    report->interrupted = good && !go_on;
    bench_pictures_make(report, &run.shots);
    bench_shots_finish(&run.shots);
    bench_truths_finish(run.truths);
    report->seconds = 1e-6 * (double)(clock_us() - start);
    stage_finish(&run.stage);
    return good;
}
