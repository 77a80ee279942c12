#pragma once
size_t wrong_size(void);
