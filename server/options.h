/* The command line as data: a command is a table of options, and that one table drives parsing, --help and the sentences that say
 * what would have been accepted. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct error;
struct common_options;

struct option {
    const char *name;  /* without dashes; one letter is written -o, more --name; NULL ends a table */
    const char *value; /* what help calls its value; NULL: takes none */
    const char *help;  /* one sentence, no full stop */
    /* Puts `value` (NULL when it takes none) into the command's struct. An error says what is wrong and what is accepted; the
     * parser puts the option in front of it. NULL: part of the contract, not built yet. */
    bool (*set)(void *target, const char *value, struct error *err);
};

/* A command's arguments. */
struct syntax {
    const char *command; /* "render" */
    const char *usage;   /* what follows the command's name */
    const char *summary; /* one sentence */
    const char *operand; /* "SCENE"; NULL: takes none */
    bool operand_optional;
    bool common;                  /* takes the common options too */
    const struct option *options; /* its own; target: `own` */
    const char *notes;            /* paragraphs printed after the options; may be NULL */
    const char *examples;         /* lines, each ended by a newline */
};

enum parsed { PARSED_RUN, PARSED_HELP, PARSED_BAD };

/* argv[0] is the command's name. `value` and `operand` strings are borrowed from argv. `common` may be NULL when the syntax
 * takes none, `operand` likewise. PARSED_BAD: ERROR_USAGE. */
enum parsed options_parse(const struct syntax *syntax, int argc, char **argv, void *own, struct common_options *common,
                          const char **operand, struct error *err);

/* options_parse() for the front of a command: prints help to standard output or the error. -1: go on; else the exit code. */
int options_start(const struct syntax *syntax, int argc, char **argv, void *own, struct common_options *common,
                  const char **operand);

void options_print_help(const struct syntax *syntax, FILE *out);
