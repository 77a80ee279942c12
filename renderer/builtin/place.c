/* Placing what a builder holds somewhere else in the world, in doubles. */
#include "builtin/mesh_builder.h"

void mesh_builder_move(struct mesh_builder *b, struct dvec3 by)
{
    for (size_t i = 0; i < b->instances.count; i++) {
        double *offset = b->instances.data[i].to_scene.offset;
        offset[0] += by.x;
        offset[1] += by.y;
        offset[2] += by.z;
    }
    for (size_t i = 0; i < b->lights.count; i++)
        b->lights.data[i].position = dvec3_add(b->lights.data[i].position, by);
    for (size_t i = 0; i < b->cameras.count; i++)
        b->cameras.data[i].eye = dvec3_add(b->cameras.data[i].eye, by);
}

static void scale_light(struct light *light, double factor)
{
    light->position = dvec3_scale(light->position, factor);
    light->radius *= factor;
    light->range *= factor;
    if (light->kind != LIGHT_DIRECTIONAL)
        light->intensity *= (float)(factor * factor);
}

static void scale_camera(struct camera *camera, double factor)
{
    camera->eye = dvec3_scale(camera->eye, factor);
    camera->ymag *= factor;
    camera->near *= factor;
    camera->far *= factor;
}

void mesh_builder_scale(struct mesh_builder *b, double factor)
{
    const struct affine scale = {{{factor, 0, 0}, {0, factor, 0}, {0, 0, factor}}, {0, 0, 0}};
    for (size_t i = 0; i < b->instances.count; i++)
        b->instances.data[i].to_scene = affine_multiply(&scale, &b->instances.data[i].to_scene);
    for (size_t i = 0; i < b->lights.count; i++)
        scale_light(&b->lights.data[i], factor);
    for (size_t i = 0; i < b->cameras.count; i++)
        scale_camera(&b->cameras.data[i], factor);
}
