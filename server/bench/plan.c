#include "plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "builtin/builtin.h"
#include "models.h"

const char *const bench_regime_names[REGIME_COUNT] = {"still", "moving"};
const char *const bench_reference_names[BENCH_REFERENCES] = {"point", "samples32", "arealight"};

enum { MAP_SIZE_DEFAULT = 1024 }; /* what systems without the parameter are timed beside */
enum { QUICK_WIDTH = 480, QUICK_HEIGHT = 270, QUICK_FRAMES = 4, QUICK_MAP_SIZE = 2048 };

/* A pair being added. */
struct builder {
    struct bench_plan *plan;
    const struct bench_options *options;
    uint32_t table, figure; /* one bit in one of them */
    unsigned measures;
    struct error *err;
};

static bool memory_out(struct error *err) { return error_set(err, ERROR_TRY_AGAIN, NULL, "memory is out for the bench's plan"); }

/* Each sentence once. */
static bool leave_out(struct bench_plan *plan, const char *sentence)
{
    for (size_t i = 0; i < plan->left_out.count; i++)
        if (!strcmp(plan->left_out.data[i], sentence))
            return true;
    char *copy = strdup(sentence);
    if (copy && array_push(&plan->left_out, copy))
        return true;
    free(copy);
    return false;
}

static bool matches(const char *filter, const char *scene, const char *algorithm)
{
    while (filter && *filter) {
        size_t length = strcspn(filter, ",");
        char word[80];
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), filter);
        if (!strstr(scene, word) && !strstr(algorithm, word))
            return false;
        filter += length + (filter[length] == ',');
    }
    return true;
}

static bool same_setup(const struct bench_setup *a, const struct bench_setup *b)
{
    return !strcmp(a->scene, b->scene) && a->width == b->width && a->height == b->height && a->lights == b->lights;
}

static bool find_setup(struct builder *b, const struct bench_setup *wanted, size_t *index)
{
    for (size_t i = 0; i < b->plan->setups.count; i++) {
        *index = i;
        if (same_setup(&b->plan->setups.data[i], wanted))
            return true;
    }
    *index = b->plan->setups.count;
    return array_push(&b->plan->setups, *wanted) || memory_out(b->err);
}

static unsigned map_size(const struct shadow_system *system, const struct shadow_params *params)
{
    int index = shadow_param_index(system, "size");
    return index < 0 ? 0 : (unsigned)params->value[index];
}

static bool same_algorithm(const struct bench_cell *cell, const struct shadow_system *system, const struct shadow_params *params)
{
    return cell->system == system && !memcmp(cell->params.value, params->value, system->param_count * sizeof params->value[0]);
}

/* Two tables that ask for the same pair share the cell. */
static bool add_cell(struct builder *b, const struct bench_setup *setup, const char *name, const struct shadow_system *system,
                     const struct shadow_params *params)
{
    size_t index;
    if (!find_setup(b, setup, &index))
        return false;
    for (size_t i = 0; i < b->plan->cells.count; i++) {
        struct bench_cell *cell = &b->plan->cells.data[i];
        if (cell->setup != index || !same_algorithm(cell, system, params))
            continue;
        cell->tables |= b->table;
        cell->figures |= b->figure;
        cell->measures |= b->measures;
        return true;
    }
    struct bench_cell cell = {.setup = index,
                              .tables = b->table,
                              .figures = b->figure,
                              .system = system,
                              .params = *params,
                              .map_size = map_size(system, params),
                              .measures = b->measures};
    snprintf(cell.name, sizeof cell.name, "%s", name);
    return array_push(&b->plan->cells, cell) || memory_out(b->err);
}

/* A system that is not there, or has not that parameter yet, is said and passed over. */
static bool add_algorithm(struct builder *b, const struct bench_setup *setup, const char *name)
{
    const struct shadow_system *system;
    struct shadow_params params;
    struct error why = {0};
    char sentence[600];
    if (!matches(b->options->filter, setup->scene, name))
        return true;
    if (!shadow_find(name, strcspn(name, ":")))
        snprintf(sentence, sizeof sentence, "%.*s is not built in: its rows are left out", (int)strcspn(name, ":"), name);
    else if (!shadow_parse(name, &system, &params, &why))
        snprintf(sentence, sizeof sentence, "%s is left out: %s", name, why.message);
    else if (b->options->quick && map_size(system, &params) > QUICK_MAP_SIZE)
        snprintf(sentence, sizeof sentence, "--quick leaves out maps of more than %d texels a side", QUICK_MAP_SIZE);
    else
        return add_cell(b, setup, name, system, &params);
    return leave_out(b->plan, sentence) || memory_out(b->err);
}

/* "*" or "*:key=value": every system, with that where it has the parameter. */
static bool add_all_systems(struct builder *b, const struct bench_setup *setup, const char *pattern)
{
    const char *extra = pattern[1] == ':' ? pattern + 2 : "";
    char key[40], name[160];
    snprintf(key, sizeof key, "%.*s", (int)strcspn(extra, "="), extra);
    for (size_t i = 0; i < shadow_system_count; i++) {
        bool has = *key && shadow_param_index(shadow_systems[i], key) >= 0;
        snprintf(name, sizeof name, has ? "%s:%s" : "%s", shadow_systems[i]->name, extra);
        if (!add_algorithm(b, setup, name))
            return false;
    }
    return true;
}

static bool add_algorithms(struct builder *b, const struct bench_setup *setup, const char *const *names)
{
    for (const char *const *name = names; *name; name++)
        if (!((*name)[0] == '*' ? add_all_systems(b, setup, *name) : add_algorithm(b, setup, *name)))
            return false;
    return true;
}

static uint32_t scaled(uint32_t side, double by)
{
    double s = floor(side * by + 0.5);
    return s < 1 ? 1 : s > RENDERER_SIZE_MAX ? RENDERER_SIZE_MAX : (uint32_t)s;
}

static bool add_scene(struct builder *b, const struct bench_table *table, const char *scene)
{
    static const double whole[] = {1, 0};
    static const unsigned own[] = {0, 0};
    const double *sizes = table->sizes ? table->sizes : whole;
    double size = table->size > 0 ? table->size : 1;
    for (; *sizes > 0; sizes++) {
        const unsigned *lights = table->lights ? table->lights : own;
        do {
            struct bench_setup setup = {.lights = *lights};
            setup.width = scaled(b->plan->width, size * *sizes);
            setup.height = scaled(b->plan->height, size * *sizes);
            if (!model_resolve(scene, b->options->models, b->options->quick, setup.scene, sizeof setup.scene))
                return error_set(b->err, ERROR_USAGE, "models", "the path of %.40s in the folder of models is too long", scene);
            if (!add_algorithms(b, &setup, table->algorithms))
                return false;
        } while (*lights && *++lights);
    }
    return true;
}

/* "builtin:hard-*" */
static bool add_builtins(struct builder *b, const struct bench_table *table, const char *pattern)
{
    size_t length = strlen(pattern) - strlen("builtin:") - 1;
    const char *prefix = pattern + strlen("builtin:");
    for (size_t i = 0; i < builtin_count; i++) {
        char name[120];
        snprintf(name, sizeof name, "builtin:%s", builtin_list[i]->name);
        if (!strncmp(builtin_list[i]->name, prefix, length) && !add_scene(b, table, name))
            return false;
    }
    return true;
}

static bool add_table(struct builder *b, const struct bench_table *table)
{
    char sentence[300];
    if (b->options->quick && table->heavy) {
        snprintf(sentence, sizeof sentence, "--quick leaves out \"%s\": %s", table->title, table->heavy);
        return leave_out(b->plan, sentence) || memory_out(b->err);
    }
    for (const char *const *scene = table->scenes; *scene; scene++) {
        bool pattern = (*scene)[strlen(*scene) - 1] == '*';
        if (!(pattern ? add_builtins(b, table, *scene) : add_scene(b, table, *scene)))
            return false;
    }
    return true;
}

static bool add_figure(struct builder *b, const struct bench_figure *figure)
{
    struct bench_setup setup = {.width = b->plan->width, .height = b->plan->height};
    const char *models = b->options->builtin_pictures ? NULL : b->options->models;
    if (!model_resolve(figure->scene, models, b->options->quick, setup.scene, sizeof setup.scene))
        return error_set(b->err, ERROR_USAGE, "models", "the path of %.40s in the folder of models is too long", figure->scene);
    return add_algorithms(b, &setup, figure->algorithms);
}

/* Whether the comma-separated `list` has `name`; NULL has all. */
static bool listed(const char *list, const char *name)
{
    size_t length = strlen(name);
    while (list && *list) {
        size_t word = strcspn(list, ",");
        if (word == length && !strncmp(list, name, length))
            return true;
        list += word + (list[word] == ',');
    }
    return !list;
}

static bool add_everything(struct bench_plan *plan, const struct bench_options *options, struct error *err)
{
    const struct bench_suite *suite = options->suite;
    for (unsigned i = 0; suite->tables[i]; i++) {
        struct builder b = {.plan = plan, .options = options, .err = err};
        b.table = 1u << i;
        b.measures = suite->tables[i]->measures;
        if (listed(options->tables, suite->tables[i]->name) && !add_table(&b, suite->tables[i]))
            return false;
    }
    for (unsigned i = 0; options->pictures && !options->tables && suite->figures && suite->figures[i]; i++) {
        struct builder b = {.plan = plan, .options = options, .err = err};
        b.figure = 1u << i;
        b.measures = MEASURE_POINT;
        if (!add_figure(&b, suite->figures[i]))
            return false;
    }
    return true;
}

/* Where each is to be found in the order of the run. */
struct place {
    size_t index, scene, setup;
    unsigned map_size;
};

static int compare_places(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    if (x->scene != y->scene)
        return x->scene < y->scene ? -1 : 1;
    if (x->setup != y->setup)
        return x->setup < y->setup ? -1 : 1;
    if (x->map_size != y->map_size)
        return x->map_size < y->map_size ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

static unsigned batch_size(const struct bench_cell *cell) { return cell->map_size ? cell->map_size : MAP_SIZE_DEFAULT; }

static size_t first_setup_of_scene(const struct bench_plan *plan, size_t setup)
{
    for (size_t i = 0; i < setup; i++)
        if (!strcmp(plan->setups.data[i].scene, plan->setups.data[setup].scene))
            return i;
    return setup;
}

/* A scene is loaded once, and cells of one map size lie side by side. */
static bool sort_cells(struct bench_plan *plan, struct error *err)
{
    size_t count = plan->cells.count;
    struct place *places = calloc(count + 1, sizeof *places);
    struct bench_cell *sorted = calloc(count + 1, sizeof *sorted);
    bool good = places && sorted;
    for (size_t i = 0; good && i < count; i++) {
        const struct bench_cell *cell = &plan->cells.data[i];
        places[i] = (struct place){i, first_setup_of_scene(plan, cell->setup), cell->setup, batch_size(cell)};
    }
    if (good) {
        qsort(places, count, sizeof *places, compare_places);
        for (size_t i = 0; i < count; i++)
            sorted[i] = plan->cells.data[places[i].index];
        memcpy(plan->cells.data, sorted, count * sizeof *sorted);
    }
    free(sorted);
    free(places);
    return good || memory_out(err);
}

bool bench_plan_init(struct bench_plan *plan, const struct bench_options *options, struct error *err)
{
    const struct bench_suite *suite = options->suite;
    unsigned frames = options->quick && suite->frames > QUICK_FRAMES ? QUICK_FRAMES : suite->frames;
    bool small = options->quick && suite->width > QUICK_WIDTH;
    *plan = (struct bench_plan){.suite = suite};
    plan->width = options->width ? options->width : small ? QUICK_WIDTH : suite->width;
    plan->height = options->height ? options->height : small ? QUICK_HEIGHT : suite->height;
    plan->frames = options->frames ? options->frames : frames;
    if (!add_everything(plan, options, err))
        return false;
    if (plan->cells.count == 0)
        return error_set(
            err, ERROR_USAGE, "filter",
            "nothing of the suite is left: no such table, scene or algorithm; without --filter and --tables all is run");
    return sort_cells(plan, err);
}

void bench_plan_finish(struct bench_plan *plan)
{
    for (size_t i = 0; i < plan->cells.count; i++)
        for (int r = 0; r < REGIME_COUNT; r++)
            free(plan->cells.data[i].times[r].frame_ms);
    for (size_t i = 0; i < plan->left_out.count; i++)
        free(plan->left_out.data[i]);
    array_finish(&plan->left_out);
    array_finish(&plan->cells);
    array_finish(&plan->setups);
}

size_t bench_batch_end(const struct bench_plan *plan, size_t first)
{
    const struct bench_cell *cells = plan->cells.data;
    size_t end = first + 1;
    while (end < plan->cells.count && cells[end].setup == cells[first].setup &&
           batch_size(&cells[end]) == batch_size(&cells[first]))
        end++;
    return end;
}

/* At its defaults but for the map size. */
static bool is_plain(const struct bench_cell *cell)
{
    struct shadow_params defaults = shadow_defaults(cell->system);
    int size = shadow_param_index(cell->system, "size");
    for (size_t i = 0; i < cell->system->param_count; i++)
        if ((int)i != size && cell->params.value[i] != defaults.value[i])
            return false;
    return true;
}

const char *bench_cell_baseline_name(const struct bench_plan *plan, const struct bench_cell *cell)
{
    for (unsigned i = 0; plan->suite->tables[i]; i++)
        if (cell->tables & 1u << i && plan->suite->tables[i]->baseline)
            return plan->suite->tables[i]->baseline;
    return NULL;
}

const struct bench_cell *bench_baseline(const struct bench_plan *plan, const struct bench_cell *cell, const char *system)
{
    for (size_t i = 0; system && i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        if (c != cell && c->setup == cell->setup && batch_size(c) == batch_size(cell) && !strcmp(c->system->name, system) &&
            is_plain(c))
            return c;
    }
    return NULL;
}

double bench_identified_fraction(const struct bench_cell *cell)
{
    return cell->has_lists && cell->lists.texels ? cell->lists.fractions / (double)cell->lists.texels : NAN;
}

int64_t bench_best_misclassified(const struct bench_plan *plan, const struct bench_cell *cell, const char *system)
{
    int64_t best = -1;
    for (size_t i = 0; system && i < plan->cells.count; i++) {
        const struct bench_cell *c = &plan->cells.data[i];
        const struct bench_errors *e = &c->errors[AGAINST_POINT_INDEX];
        if (c->setup != cell->setup || batch_size(c) != batch_size(cell) || strcmp(c->system->name, system) || !e->measured)
            continue;
        if (best < 0 || (int64_t)e->m.misclassified < best)
            best = (int64_t)e->m.misclassified;
    }
    return best;
}

/* Medians over the systems of this project on two cores, 1280 x 720; rough on purpose. */
static const double STILL_S = 0.04, MOVING_S = 0.08, POINT_S = 0.25, SAMPLES32_S = 0.3;
static const double PICTURE_PIXELS = 1280 * 720;

double bench_cell_seconds(const struct bench_plan *plan, const struct bench_cell *cell)
{
    const struct bench_setup *setup = &plan->setups.data[cell->setup];
    double pixels = 0.15 + 0.85 * setup->width * setup->height / PICTURE_PIXELS, seconds = 0.05;
    double frames = plan->frames * (cell->measures & MEASURE_PASSES ? 1.5 : 1) + 3;
    double texels = cell->map_size / 1024.0;
    if (cell->measures & MEASURE_STILL)
        seconds += frames * STILL_S * pixels;
    if (cell->measures & MEASURE_MOVING)
        seconds += frames * (STILL_S * pixels + (MOVING_S - STILL_S) * (1 + texels * texels) / 2);
    if (cell->measures & MEASURE_POINT)
        seconds += POINT_S * pixels;
    if (cell->measures & MEASURE_SAMPLES32)
        seconds += SAMPLES32_S * pixels;
    return seconds;
}

double bench_plan_seconds(const struct bench_plan *plan)
{
    double seconds = 0;
    for (size_t i = 0; i < plan->cells.count; i++)
        seconds += bench_cell_seconds(plan, &plan->cells.data[i]);
    return seconds;
}
