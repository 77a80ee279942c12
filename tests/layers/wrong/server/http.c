#include <libwebsockets.h>
#include "net_state.h"
#include <jansson.h>
static const char *example = "sm:size=1024";
static const char *text = "any algorithm, as in sm:size=1024";
