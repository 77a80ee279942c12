#include "passes/lighting_lanes.h"

void lighting_row_plain(const struct lighting_pixels *job, uint32_t y, uint32_t background) { light_row(job, y, background); }
