/* Listings as people read them: made of the JSON of listings.h, this program's or another server's. What is missing or of another type is
 * printed as nothing. */
#pragma once

#include <stdio.h>

#include <jansson.h>

void listing_print_scenes(const json_t *listing, FILE *out);
void listing_print_algorithms(const json_t *listing, FILE *out);
void listing_print_devices(const json_t *listing, FILE *out);
