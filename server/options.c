#include "options.h"

#include <string.h>

#include "base/error.h"
#include "command.h"
#include "common_options.h"

/* "-o" or "--size". */
struct option_spelling {
    char text[40];
};

static struct option_spelling spell(const struct option *option)
{
    struct option_spelling s;
    snprintf(s.text, sizeof s.text, "%s%s", option->name[1] ? "--" : "-", option->name);
    return s;
}

static const struct option *find_in(const struct option *table, const char *name, size_t length)
{
    for (const struct option *o = table; o && o->name; o++)
        if (strlen(o->name) == length && !strncmp(o->name, name, length))
            return o;
    return NULL;
}

static size_t append_names(const struct option *table, char *out, size_t used, size_t size)
{
    for (const struct option *o = table; o && o->name && used < size; o++) {
        if (!o->set)
            continue;
        int n = snprintf(out + used, size - used, "%s%s", used ? " " : "", spell(o).text);
        used += n > 0 ? (size_t)n : 0;
    }
    return used;
}

static bool unknown_option(const struct syntax *syntax, const char *word, struct error *err)
{
    char names[400] = "";
    size_t used = append_names(syntax->options, names, 0, sizeof names);
    if (syntax->common)
        append_names(common_option_table, names, used, sizeof names);
    return error_set(err, ERROR_USAGE, "option", "%s has no option %.30s; accepted: %s --help", syntax->command, word, names);
}

/* One word of the command line that begins with '-', taken apart. */
struct written_option {
    const char *name;
    size_t length;
    const char *value; /* after '='; NULL: none */
};

static struct written_option take_apart(const char *word)
{
    struct written_option w = {0};
    if (word[1] != '-') {
        w.name = word + 1;
        w.length = strlen(w.name);
        return w;
    }
    w.name = word + 2;
    w.length = strcspn(w.name, "=");
    w.value = w.name[w.length] ? w.name + w.length + 1 : NULL;
    return w;
}

/* Where options go while they are read. */
struct parse_state {
    const struct syntax *syntax;
    void *own;
    struct common_options *common;
    struct error *err;
};

static bool set(struct parse_state *state, const struct option *option, bool own, const char *value)
{
    if (!option->set(own ? state->own : state->common, value, state->err))
        return false;
    if (!own)
        common_options_note(state->common, option, value);
    return true;
}

/* `next` is the following word or NULL; *used says whether it was taken as the value. */
static bool parse_option(struct parse_state *state, const char *word, const char *next, bool *used)
{
    struct written_option w = take_apart(word);
    struct error *err = state->err;
    const struct option *option = find_in(state->syntax->options, w.name, w.length);
    bool own = option;
    if (!option && state->syntax->common)
        option = find_in(common_option_table, w.name, w.length);
    if (!option || (option->name[1] == 0) != (word[1] != '-'))
        return unknown_option(state->syntax, word, err);
    if (!option->set)
        return error_set(err, ERROR_USAGE, option->name, "%s %s is not built yet; leave it out", state->syntax->command,
                         spell(option).text);
    if (!option->value) {
        if (w.value)
            return error_set(err, ERROR_USAGE, option->name, "%s takes no value, but was given '%.60s'", spell(option).text,
                             w.value);
        return set(state, option, own, NULL);
    }
    const char *value = w.value;
    if (!value) {
        if (!next || !strncmp(next, "--", 2))
            return error_set(err, ERROR_USAGE, option->name, "%s needs a value: %s %s", spell(option).text, spell(option).text,
                             option->value);
        value = next;
        *used = true;
    }
    if (set(state, option, own, value))
        return true;
    return error_prefix(err, "%s '%.60s'", spell(option).text, value);
}

static bool wants_help(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--"); i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h"))
            return true;
    return false;
}

static bool take_operand(const struct syntax *syntax, const char *word, const char **operand, struct error *err)
{
    if (!syntax->operand)
        return error_set(err, ERROR_USAGE, "arguments", "%s takes no argument besides its options, but was given '%.60s'",
                         syntax->command, word);
    if (*operand)
        return error_set(err, ERROR_USAGE, "arguments", "%s takes one %s, but was given '%.60s' and '%.60s'", syntax->command,
                         syntax->operand, *operand, word);
    if (!*word)
        return error_set(err, ERROR_USAGE, "arguments", "%s is empty; see gnomon %s --help", syntax->operand, syntax->command);
    *operand = word;
    return true;
}

static bool parse_all(struct parse_state *state, int argc, char **argv, const char **operand)
{
    bool options_ended = false;
    for (int i = 1; i < argc; i++) {
        if (!options_ended && !strcmp(argv[i], "--")) {
            options_ended = true;
        } else if (options_ended || argv[i][0] != '-' || !argv[i][1]) {
            if (!take_operand(state->syntax, argv[i], operand, state->err))
                return false;
        } else {
            bool used = false;
            if (!parse_option(state, argv[i], i + 1 < argc ? argv[i + 1] : NULL, &used))
                return false;
            i += used;
        }
    }
    return true;
}

enum parsed options_parse(const struct syntax *syntax, int argc, char **argv, void *own, struct common_options *common,
                          const char **operand, struct error *err)
{
    if (wants_help(argc, argv))
        return PARSED_HELP;
    const char *found = NULL;
    struct parse_state state = {syntax, own, common, err};
    if (!parse_all(&state, argc, argv, &found))
        return PARSED_BAD;
    if (syntax->operand && !found && !syntax->operand_optional) {
        error_set(err, ERROR_USAGE, "arguments", "%s needs an argument: gnomon %s %s", syntax->command, syntax->command,
                  syntax->usage);
        return PARSED_BAD;
    }
    if (syntax->common && !common_options_check(common, err))
        return PARSED_BAD;
    if (operand)
        *operand = found;
    return PARSED_RUN;
}

int options_start(const struct syntax *syntax, int argc, char **argv, void *own, struct common_options *common,
                  const char **operand)
{
    struct error err = {0};
    switch (options_parse(syntax, argc, argv, own, common, operand, &err)) {
    case PARSED_HELP: options_print_help(syntax, stdout); return 0;
    case PARSED_BAD: return command_fail(&err);
    case PARSED_RUN: break;
    }
    return -1;
}

/* Help is laid out for 100 columns; a left column that is too long gets a line of its own. */
enum { HELP_COLUMN = 30 };

static void print_option(const struct option *option, FILE *out)
{
    char left[120];
    int n =
        snprintf(left, sizeof left, "  %s%s%s", spell(option).text, option->value ? " " : "", option->value ? option->value : "");
    fprintf(out, "%-*s", HELP_COLUMN, left);
    if (n >= HELP_COLUMN)
        fprintf(out, "\n%*s", HELP_COLUMN, "");
    fprintf(out, "%s%s\n", option->help, option->set ? "" : " (not built yet)");
}

static void print_table(const char *title, const struct option *table, FILE *out)
{
    fprintf(out, "\n%s\n", title);
    for (const struct option *o = table; o && o->name; o++)
        print_option(o, out);
}

void options_print_help(const struct syntax *syntax, FILE *out)
{
    fprintf(out, "Usage: gnomon %s %s\n\n%s\n", syntax->command, syntax->usage, syntax->summary);
    if (syntax->options && syntax->options->name)
        print_table("Options:", syntax->options, out);
    if (syntax->common)
        print_table("Common options:", common_option_table, out);
    if (syntax->notes)
        fprintf(out, "\n%s", syntax->notes);
    fprintf(out, "\nExamples:\n%s", syntax->examples);
}
