#include "gl/texture.h"

#include <epoxy/gl.h>
#include <gbm.h>

#include "base/error.h"
#include "blocks.h"
#include "scene/scene.h"

static const char prologue[] = "#version 450\n";
