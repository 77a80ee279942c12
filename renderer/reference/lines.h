/* Sixteen lines against the scene, certainly. Camera lines start at the eye (or on an orthographic camera's plane), shadow lines run from
 * receivers to the light; the lines of a packet share an apex (filter.h). */
#pragma once

#include "reference/candidates.h"
#include "reference/filter.h"

/* What a sample sees, and where. */
struct receiver {
    uint32_t id;                    /* SCENE_NONE: nothing */
    struct dvec3 origin, direction; /* the sample's ray, view_ray() */
};

struct line_packet {
    struct RTCIntersectContext base; /* first: callbacks get at the rest through it */
    const struct reference *reference;
    struct exact_apex apex;
    bool directions; /* perspective camera: lanes hold directions */
    struct lanes lanes;
    struct receiver receiver[LANES];         /* camera: found so far; shadow: where the lines start */
    double near, far;                        /* camera */
    double depth[LANES], depth_error[LANES]; /* camera: of what was found */
    double start[LANES], length[LANES];      /* distance along the line at Embree's t = 0; length of `direction` */
    struct dvec3 point[LANES];               /* shadow: the receiver's point in double (docs/truth.md, "Points in double") */
    uint64_t rays, tests, exact;
};

/* What all shadow lines of a light go through. */
static inline struct exact_apex light_apex(const struct light *light)
{
    return light->kind == LIGHT_DIRECTIONAL ? (struct exact_apex){true, dvec3_neg(light->direction)}
                                            : (struct exact_apex){false, light->position};
}

/* Certain sign of N . (apex - a), or N . direction. */
int lines_apex_side(struct line_packet *p, const struct exact_apex *apex, const struct dvec3 corners[3],
                    const struct form *plane);

/* Nearest visible triangle of each ray in `active` (bit a lane): fills receiver[].id. origin and direction must be set. */
void lines_find_visible(struct line_packet *p, const struct view *view, unsigned active);

/* Puts the point of receiver[lane] and the line to the light in place; false when it is no receiver for that light. */
bool lines_aim_at_light(struct line_packet *p, const struct light *light, unsigned lane);

/* Bit a lane: shadowed, of those in `active`, which lines_aim_at_light() set. */
unsigned lines_find_shadowed(struct line_packet *p, const struct light *light, unsigned active);

void lines_meet_triangle(const struct RTCIntersectFunctionNArguments *args);
void lines_blocked_by_triangle(const struct RTCOccludedFunctionNArguments *args);
