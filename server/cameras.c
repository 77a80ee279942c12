#include "cameras.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "numbers.h"

struct camera_choice camera_choice_default(void)
{
    return (struct camera_choice){.source = CAMERA_FIRST, .up = {0, 1, 0}, .fov_deg = FOV_DEFAULT_DEG};
}

/* Sine of the angle between view and up below which the picture's roll would be noise. */
static const double LEAST_UP_SINE = 1e-6;

bool camera_check_look_at(const struct camera_choice *c, struct error *err)
{
    if (!dvec3_finite(c->eye) || !dvec3_finite(c->target) || !dvec3_finite(c->up))
        return error_set(err, ERROR_USAGE, "eye", "eye, target and up must be finite numbers");
    struct dvec3 view = dvec3_sub(c->target, c->eye);
    double distance = dvec3_length(view);
    if (!(distance > 0) || !isfinite(distance))
        return error_set(err, ERROR_USAGE, "target", "eye and target must be two different points, at a finite distance");
    struct dvec3 up = dvec3_normalize(c->up);
    double sine = dvec3_length(dvec3_cross(dvec3_normalize(view), up));
    if (!(sine > LEAST_UP_SINE))
        return error_set(err, ERROR_USAGE, "up", "up must not be zero nor lie along the line from eye to target");
    if (!(c->fov_deg >= FOV_MIN_DEG && c->fov_deg <= FOV_MAX_DEG))
        return error_set(err, ERROR_USAGE, "fov", "fov must be %g to %g degrees (the full vertical angle)", FOV_MIN_DEG,
                         FOV_MAX_DEG);
    if (c->height != 0 && !(c->height >= ORTHO_MIN && c->height <= ORTHO_MAX))
        return error_set(err, ERROR_USAGE, "height", "height must be %g to %g scene units (of an orthographic picture)",
                         ORTHO_MIN, ORTHO_MAX);
    return true;
}

/* The near plane: a ten-thousandth of the distance looked at. Reversed-Z float depth has precision to spare at that ratio. */
static const double NEAR_OF_DISTANCE = 1e-4;

/* Parallel rays need a far end. From the eye on, everything there is. */
static double far_of_scene(const struct scene *scene, const struct camera *c, double distance)
{
    if (dbox_is_empty(&scene->bounds))
        return 2 * distance;
    double center = dvec3_dot(dvec3_sub(c->eye, dbox_center(&scene->bounds)), c->back);
    return fmax(2 * distance, center + 1.01 * dbox_radius(&scene->bounds));
}

static bool look_at(const struct scene *scene, const struct camera_choice *c, struct camera *out, struct error *err)
{
    if (!camera_check_look_at(c, err))
        return false;
    struct dvec3 back = dvec3_sub(c->eye, c->target);
    double distance = dvec3_length(back);
    *out = (struct camera){.name = "look-at", .eye = dvec3_sub(c->eye, scene->origin)};
    out->back = dvec3_normalize(back);
    out->right = dvec3_normalize(dvec3_cross(dvec3_normalize(c->up), out->back));
    out->up = dvec3_cross(out->back, out->right);
    out->yfov = c->fov_deg * (M_PI / 180);
    out->near = distance * NEAR_OF_DISTANCE;
    out->far = INFINITY;
    if (c->height > 0) {
        out->orthographic = true;
        out->ymag = c->height / 2;
        out->near = 0;
        out->far = far_of_scene(scene, out, distance);
    }
    return true;
}

static bool no_such_camera(const struct scene *scene, const char *name, struct error *err)
{
    if (scene->camera_count == 0)
        return error_set(err, ERROR_USAGE, "camera", "there is no camera '%.60s': the scene has none; auto is accepted", name);
    char list[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < scene->camera_count && used + 40 < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%.30s", i ? ", " : "",
                                 scene->cameras[i].name[0] ? scene->cameras[i].name : "(unnamed)");
    return error_set(err, ERROR_USAGE, "camera",
                     "there is no camera '%.60s'; auto, an index 0 to %zu or a name (%s) are accepted", name,
                     scene->camera_count - 1, list);
}

/* A name wins over an index, so that a camera called "2" can be chosen; "auto" is reserved. */
static bool find_camera(const struct scene *scene, const char *name, double aspect, struct camera *out, struct error *err)
{
    unsigned long index = scene->camera_count;
    if (!strcmp(name, "auto")) {
        *out = scene_default_camera(scene, aspect);
        return true;
    }
    for (size_t i = scene->camera_count; name[0] && i-- > 0;)
        if (!strcmp(scene->cameras[i].name, name))
            index = i;
    if (index == scene->camera_count &&
        (scene->camera_count == 0 || !number_parse_unsigned(name, 0, scene->camera_count - 1, &index)))
        return no_such_camera(scene, name, err);
    *out = scene->cameras[index];
    return true;
}

bool camera_choose(const struct scene *scene, const struct camera_choice *choice, double aspect, struct camera *out,
                   struct error *err)
{
    switch (choice->source) {
    case CAMERA_NAMED: return find_camera(scene, choice->name, aspect, out, err);
    case CAMERA_LOOK_AT: return look_at(scene, choice, out, err);
    case CAMERA_FIRST: break;
    }
    *out = scene->camera_count ? scene->cameras[0] : scene_default_camera(scene, aspect);
    return true;
}
