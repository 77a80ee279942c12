#include "base/error.h"
#include <pthread.h>

#include "scene/scene.h"
