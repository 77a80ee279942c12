#include "shadow/asm/analysis_lanes.h"

const struct asm_kernel asm_plain = {resolve_rows, analyse_rows};
