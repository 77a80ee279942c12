#include "renderer.h"
#include "shadow/shadow.h"
static const char *name = "sm";
