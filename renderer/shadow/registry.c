#include <string.h>

#include "shadow/shadow.h"

#define SHADOW_SYSTEM(name) extern const struct shadow_system shadow_##name;
#define SHADOW_DEFAULT(name)
#include "shadow/algorithms.def"
#undef SHADOW_SYSTEM
#undef SHADOW_DEFAULT

const struct shadow_system *const shadow_systems[] = {
#define SHADOW_SYSTEM(name) &shadow_##name,
#define SHADOW_DEFAULT(name)
#include "shadow/algorithms.def"
#undef SHADOW_SYSTEM
#undef SHADOW_DEFAULT
};

const size_t shadow_system_count = sizeof shadow_systems / sizeof *shadow_systems;

const struct shadow_system *shadow_default(void)
{
#define SHADOW_SYSTEM(name)
#define SHADOW_DEFAULT(name) return &shadow_##name;
#include "shadow/algorithms.def"
#undef SHADOW_SYSTEM
#undef SHADOW_DEFAULT
}

const struct shadow_system *shadow_find(const char *name, size_t length)
{
    for (size_t i = 0; i < shadow_system_count; i++)
        if (strlen(shadow_systems[i]->name) == length && memcmp(shadow_systems[i]->name, name, length) == 0)
            return shadow_systems[i];
    return NULL;
}
