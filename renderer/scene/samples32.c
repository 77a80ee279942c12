#include "scene/view.h"

/* Found by simulated annealing over permutations of the 32 rows, minimising a repulsion on the torus, so that the pattern stays well spread
 * across pixel borders: no two samples, here or in neighbouring pixels, are nearer than sqrt(26)/32 of a pixel. */
const float view_samples32[32][2] = {
    {1 / 64.0f, 39 / 64.0f},  {3 / 64.0f, 29 / 64.0f},  {5 / 64.0f, 7 / 64.0f},   {7 / 64.0f, 17 / 64.0f},
    {9 / 64.0f, 49 / 64.0f},  {11 / 64.0f, 59 / 64.0f}, {13 / 64.0f, 27 / 64.0f}, {15 / 64.0f, 37 / 64.0f},
    {17 / 64.0f, 13 / 64.0f}, {19 / 64.0f, 3 / 64.0f},  {21 / 64.0f, 47 / 64.0f}, {23 / 64.0f, 23 / 64.0f},
    {25 / 64.0f, 57 / 64.0f}, {27 / 64.0f, 35 / 64.0f}, {29 / 64.0f, 5 / 64.0f},  {31 / 64.0f, 45 / 64.0f},
    {33 / 64.0f, 15 / 64.0f}, {35 / 64.0f, 25 / 64.0f}, {37 / 64.0f, 55 / 64.0f}, {39 / 64.0f, 1 / 64.0f},
    {41 / 64.0f, 43 / 64.0f}, {43 / 64.0f, 33 / 64.0f}, {45 / 64.0f, 11 / 64.0f}, {47 / 64.0f, 21 / 64.0f},
    {49 / 64.0f, 53 / 64.0f}, {51 / 64.0f, 63 / 64.0f}, {53 / 64.0f, 41 / 64.0f}, {55 / 64.0f, 31 / 64.0f},
    {57 / 64.0f, 9 / 64.0f},  {59 / 64.0f, 19 / 64.0f}, {61 / 64.0f, 51 / 64.0f}, {63 / 64.0f, 61 / 64.0f},
};
