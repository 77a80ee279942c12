#include <stdio.h>

#include "scene/scene.h"

struct light scene_default_light(const struct scene *scene)
{
    (void)scene;
    struct light light = {.kind = LIGHT_DIRECTIONAL, .color = {1, 1, 1}, .intensity = 3};
    snprintf(light.name, sizeof light.name, "default");
    /* From above, a little from the right and from behind the default camera. */
    light.direction = dvec3_normalize(dvec3(-0.5, -1, -0.6));
    return light;
}

struct camera scene_default_camera(const struct scene *scene, double aspect)
{
    struct camera camera = {.yfov = 45 * (M_PI / 180), .ymag = 1, .far = INFINITY};
    double radius = dbox_radius(&scene->bounds);
    struct dvec3 center = dbox_is_empty(&scene->bounds) ? dvec3(0, 0, 0) : dbox_center(&scene->bounds);
    if (!(radius > 0))
        radius = 1;
    snprintf(camera.name, sizeof camera.name, "default");
    camera.back = dvec3_normalize(dvec3(0.45, 0.4, 1));
    camera.right = dvec3_normalize(dvec3_cross(dvec3(0, 1, 0), camera.back));
    camera.up = dvec3_cross(camera.back, camera.right);
    /* The bounding sphere touches the frustum's narrower pair of planes. */
    double half = camera.yfov / 2;
    if (aspect > 0 && aspect < 1)
        half = atan(tan(half) * aspect);
    double distance = radius / sin(half);
    camera.eye = dvec3_mad(center, camera.back, distance);
    camera.near = (distance - radius) / 2;
    return camera;
}
