/* Linked programs on disk, one file each, named by a hash of everything they depend on. A cache: every failure means "not there". */
#pragma once

#include <stdint.h>

/* `second` may be NULL. */
uint64_t binary_cache_key(const char *device, const char *first, const char *second);

/* GL name of a linked program, 0 if not cached or refused by the driver. */
unsigned binary_cache_load(const char *dir, uint64_t key);

/* Written beside and renamed: concurrent processes never see half a file. Makes `dir`. */
void binary_cache_store(const char *dir, uint64_t key, unsigned program);
