#include "made_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

static void *grown(void *old, size_t count, size_t more, size_t size)
{
    void *data = realloc(old, (count + more) * size);
    if (!data)
        abort();
    memset((char *)data + count * size, 0, more * size);
    return data;
}

#define GROW(scene, array, count, more) ((scene)->array = grown((scene)->array, (scene)->count, (more), sizeof *(scene)->array))

struct scene *made_scene(void) { return grown(NULL, 0, 1, sizeof(struct scene)); }

uint32_t made_material(struct scene *scene, bool double_sided)
{
    GROW(scene, materials, material_count, 1);
    struct material *m = &scene->materials[scene->material_count];
    for (int i = 0; i < 4; i++)
        m->base_color[i] = 1;
    m->roughness = 1;
    m->normal_scale = m->occlusion_strength = 1;
    m->alpha_cutoff = 0.5f;
    m->double_sided = double_sided;
    struct texture_use *uses[] = {&m->base_color_texture, &m->metallic_roughness_texture, &m->normal_texture,
                                  &m->occlusion_texture, &m->emissive_texture};
    for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++)
        *uses[i] = (struct texture_use){SCENE_NONE, 0, {{1, 0, 0}, {0, 1, 0}}};
    return (uint32_t)scene->material_count++;
}

uint32_t made_mesh(struct scene *scene, const float (*points)[3], const float (*uv)[2], uint32_t point_count,
                   const uint32_t *indices, uint32_t index_count, uint32_t material)
{
    GROW(scene, meshes, mesh_count, 1);
    struct mesh *mesh = &scene->meshes[scene->mesh_count];
    *mesh = (struct mesh){.first_vertex = (uint32_t)scene->vertex_count,
                          .vertex_count = point_count,
                          .first_index = (uint32_t)scene->index_count,
                          .index_count = index_count,
                          .first_texcoord = {SCENE_NONE, SCENE_NONE},
                          .first_color = SCENE_NONE,
                          .material = material};
    GROW(scene, positions, vertex_count, point_count);
    GROW(scene, normals, vertex_count, point_count);
    memcpy(scene->positions + scene->vertex_count, points, point_count * sizeof *points);
    scene->vertex_count += point_count;
    GROW(scene, indices, index_count, index_count);
    memcpy(scene->indices + scene->index_count, indices, index_count * sizeof *indices);
    scene->index_count += index_count;
    if (uv) {
        mesh->first_texcoord[0] = (uint32_t)scene->texcoord_count;
        GROW(scene, texcoords, texcoord_count, point_count);
        memcpy(scene->texcoords + scene->texcoord_count, uv, point_count * sizeof *uv);
        scene->texcoord_count += point_count;
    }
    return (uint32_t)scene->mesh_count++;
}

void made_instance(struct scene *scene, uint32_t mesh, struct affine to_world)
{
    GROW(scene, instances, instance_count, 1);
    scene->instances[scene->instance_count++] = (struct instance){.mesh = mesh, .to_scene = to_world};
}

void made_triangles(struct scene *scene, const float (*points)[3], uint32_t point_count, uint32_t material)
{
    uint32_t *indices = grown(NULL, 0, point_count, sizeof *indices);
    for (uint32_t i = 0; i < point_count; i++)
        indices[i] = i;
    made_instance(scene, made_mesh(scene, points, NULL, point_count, indices, point_count, material), affine_identity());
    free(indices);
}

void made_mask(struct scene *scene, uint32_t material, uint32_t size, const uint8_t *solid)
{
    GROW(scene, images, image_count, 1);
    struct image *image = &scene->images[scene->image_count];
    *image = (struct image){.width = size, .height = size, .rgba = grown(NULL, 0, (size_t)size * size, 4)};
    for (size_t i = 0; i < (size_t)size * size; i++)
        image->rgba[4 * i + 3] = solid[i] ? 255 : 0;
    GROW(scene, textures, texture_count, 1);
    scene->textures[scene->texture_count] = (struct texture){.image = (uint32_t)scene->image_count++, .nearest = true};
    scene->materials[material].alpha_mode = ALPHA_MASK;
    scene->materials[material].base_color_texture.texture = (uint32_t)scene->texture_count++;
}

void made_finish(struct scene *scene)
{
    struct error err = {0};
    if (!scene_finish(scene, &err)) {
        fprintf(stderr, "%s\n", err.message);
        abort();
    }
}

struct camera made_camera(struct dvec3 eye, struct dvec3 target, double yfov)
{
    struct dvec3 back = dvec3_normalize(dvec3_sub(eye, target));
    struct dvec3 up = fabs(back.y) > 0.99 ? dvec3(0, 0, -1) : dvec3(0, 1, 0);
    struct dvec3 right = dvec3_normalize(dvec3_cross(up, back));
    return (struct camera){.eye = eye,
                           .right = right,
                           .up = dvec3_cross(back, right),
                           .back = back,
                           .yfov = yfov,
                           .ymag = 1,
                           .near = 0.01,
                           .far = INFINITY};
}

struct light made_light(enum light_kind kind, struct dvec3 position, struct dvec3 towards)
{
    return (struct light){.kind = kind,
                          .position = position,
                          .direction = dvec3_normalize(dvec3_sub(towards, position)),
                          .color = {1, 1, 1},
                          .intensity = 100,
                          .inner = 0,
                          .outer = M_PI / 4};
}
