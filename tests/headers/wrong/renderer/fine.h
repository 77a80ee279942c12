#pragma once
#include <stddef.h>
size_t fine_size(void);
