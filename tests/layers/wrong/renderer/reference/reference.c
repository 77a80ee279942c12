#include <embree3/rtcore.h>
#include <gmp.h>
#include <OpenImageIO/imageio.h>
