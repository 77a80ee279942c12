/* A texel of soft's shadow term: the low ten bits hold the term, [0, 1]; the others, read as a float, what tells surfaces apart: the inverse of
 * the depth in perspective, since that is affine over a plane's picture, and the depth itself in orthographic. 0: no receiver. A texel of
 * radius: packHalf2x16 of the blur's standard deviation along x and y, pixels. */
const uint TERM_BITS = 1023u;

uint term_pack(float term, float guide) { return (floatBitsToUint(guide) & ~TERM_BITS) | uint(term * 1023.0 + 0.5); }
float term_value(uint packed_term) { return float(packed_term & TERM_BITS) * (1.0 / 1023.0); }
float term_guide(uint packed_term) { return uintBitsToFloat(packed_term & ~TERM_BITS); }
