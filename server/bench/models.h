/* The four kinds of model of the coverage paper (its table 2) by a name of ours: real ones where a folder of models is given and holds
 * them, else the built-in ones. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* "@dense", "@butterfly", "@tree", "@ball" to what scene_load() takes; any other name to itself. `folder` may be NULL. False when the name
 * begins with @ and is none of them, or the path does not fit. */
bool model_resolve(const char *name, const char *folder, bool quick, char *out, size_t size);

/* What a report calls a scene: a path's last part, with the built-in ones as they are. */
const char *model_label(const char *scene);

/* Whether `scene` is what some folder's or the built-in model of that name would resolve to. */
bool model_is(const char *name, const char *scene);
