/* The project's C headers as C++ sees them. Standard headers come first: they may not be first met inside extern "C". */
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

extern "C" {
#include "base/dmath.h"
#include "base/error.h"
#include "base/log.h"
#include "import/import.h"
#include "scene/scene.h"
}
