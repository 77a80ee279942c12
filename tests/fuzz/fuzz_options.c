/* The command line: words separated by newlines, through the table that render and compare use. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "common_options.h"

enum { WORDS_MAX = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct option none[] = {{0}};
    static const struct syntax syntax = {
        .command = "fuzz", .usage = "SCENE", .operand = "SCENE", .operand_optional = true, .common = true, .options = none};
    char *text = malloc(size + 1), *argv[WORDS_MAX] = {"fuzz"}, *rest;
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = 0;
    int argc = 1;
    for (char *word = strtok_r(text, "\n", &rest); word && argc < WORDS_MAX - 1; word = strtok_r(NULL, "\n", &rest))
        argv[argc++] = word;
    struct common_options common;
    struct error err = {0};
    const char *operand = NULL;
    common_options_init(&common);
    switch (options_parse(&syntax, argc, argv, NULL, &common, &operand, &err)) {
    case PARSED_BAD: assert(err.code == ERROR_USAGE && err.message[0] && !strchr(err.message, '\n')); break;
    case PARSED_RUN:
        assert(common.width >= 1 && common.width <= RENDERER_SIZE_MAX && common.light_count <= RENDERER_LIGHTS_MAX);
        assert(common.ambient >= 0 && common.threads >= 1 && common.threads <= THREADS_MAX);
        break;
    case PARSED_HELP: break;
    }
    free(text);
    return 0;
}
