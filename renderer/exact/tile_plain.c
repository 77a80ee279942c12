#include "exact/tile_code.h"

const struct tile_kernel tile_plain = {tile_samples32, tile_point};
