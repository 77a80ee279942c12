/* The text of --algorithm, and that what is printed of it reads back as the same. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "shadow/shadow.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct shadow_system *system, const struct shadow_params *params)
{
    char text[1024];
    struct error err = {0};
    const struct shadow_system *again;
    struct shadow_params params_again;
    for (size_t i = 0; i < system->param_count; i++)
        assert(params->value[i] >= system->params[i].min && params->value[i] <= system->params[i].max);
    shadow_format(system, params, text, sizeof text);
    assert(shadow_parse(text, &again, &params_again, &err));
    assert(again == system);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = 0;
    struct error err = {0};
    const struct shadow_system *system;
    struct shadow_params params;
    if (shadow_parse(text, &system, &params, &err))
        check(system, &params);
    else
        assert(err.code == ERROR_USAGE && err.message[0]);
    free(text);
    return 0;
}
