#include <gmp.h>
#include "import/shim.hh"
