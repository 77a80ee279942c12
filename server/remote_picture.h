/* `gnomon render --server`: the options of the command line as a body of POST /v1/render, and the picture that comes back. */
#pragma once

#include <stdbool.h>

#include "import/import.h"
#include "remote.h"

struct common_options;

/* Lets the server render `scene` (a name of its list) with those common options that were given; what was not is the server's. `out` holds
 * the picture's file as it came, which the caller frees. ERROR_USAGE for an option that a server cannot be sent. */
bool remote_picture(const struct remote *remote, const char *scene, const struct common_options *options,
                    enum image_format format, int quality, struct remote_answer *out, struct error *err);
