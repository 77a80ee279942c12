/* PARAM(i): value i of the shadow system at work, in the order of its descriptors. */
#define PARAM(i) params[(i) / 4][(i) % 4]
