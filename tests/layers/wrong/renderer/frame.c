#include "renderer.h"
#include "session.h"
static const char *fallback = "sm";
static const char *tonemap = "none";
