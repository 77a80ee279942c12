#include <string.h>

#include "scene/finish.h"

/* Multiply and fold, 64 x 64 -> 128 bits, as in wyhash (Wang Yi, 2019). Guards against mix-ups, not against forgers. */
static uint64_t fold(uint64_t a, uint64_t b)
{
    __uint128_t product = (__uint128_t)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static void add_word(uint64_t *hash, uint64_t word)
{
    *hash = fold(*hash ^ word ^ 0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u) + 0x2545f4914f6cdd1du;
}

static void add_bytes(uint64_t *hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    add_word(hash, size);
    for (; size >= 8; size -= 8, bytes += 8) {
        uint64_t word;
        memcpy(&word, bytes, 8);
        add_word(hash, word);
    }
    uint64_t rest = 0;
    if (size) {
        memcpy(&rest, bytes, size);
        add_word(hash, rest);
    }
}

static void add_double(uint64_t *hash, double value)
{
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    add_word(hash, word);
}

static void add_floats(uint64_t *hash, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_double(hash, (double)values[i]);
}

static void add_vector(uint64_t *hash, struct dvec3 v)
{
    add_double(hash, v.x);
    add_double(hash, v.y);
    add_double(hash, v.z);
}

static void add_texture_use(uint64_t *hash, const struct texture_use *use)
{
    add_word(hash, (uint64_t)use->texture << 32 | use->texcoord);
    add_floats(hash, &use->transform[0][0], 6);
}

static void add_material(uint64_t *hash, const struct material *m)
{
    add_floats(hash, m->base_color, 4);
    add_floats(hash, m->emissive, 3);
    add_floats(hash, (const float[]){m->metallic, m->roughness, m->normal_scale, m->occlusion_strength, m->alpha_cutoff}, 5);
    add_word(hash, (uint64_t)m->alpha_mode << 2 | (uint64_t)m->double_sided << 1 | m->unlit);
    add_texture_use(hash, &m->base_color_texture);
    add_texture_use(hash, &m->metallic_roughness_texture);
    add_texture_use(hash, &m->normal_texture);
    add_texture_use(hash, &m->occlusion_texture);
    add_texture_use(hash, &m->emissive_texture);
}

static void add_mesh(uint64_t *hash, const struct mesh *m)
{
    add_word(hash, (uint64_t)m->first_vertex << 32 | m->vertex_count);
    add_word(hash, (uint64_t)m->first_index << 32 | m->index_count);
    add_word(hash, (uint64_t)m->first_texcoord[0] << 32 | m->first_texcoord[1]);
    add_word(hash, (uint64_t)m->first_color << 32 | m->material);
}

static void add_instance(uint64_t *hash, const struct instance *i)
{
    add_word(hash, i->mesh);
    add_bytes(hash, i->to_scene.linear, sizeof i->to_scene.linear);
    add_bytes(hash, i->to_scene.offset, sizeof i->to_scene.offset);
}

static void add_light(uint64_t *hash, const struct light *l)
{
    add_word(hash, l->kind);
    add_vector(hash, l->position);
    add_vector(hash, l->direction);
    add_floats(hash, l->color, 3);
    add_double(hash, (double)l->intensity);
    add_vector(hash, dvec3(l->inner, l->outer, l->range));
    add_double(hash, l->radius);
}

static void add_camera(uint64_t *hash, const struct camera *c)
{
    add_word(hash, c->orthographic);
    add_vector(hash, c->eye);
    add_vector(hash, c->right);
    add_vector(hash, c->up);
    add_vector(hash, c->back);
    add_vector(hash, dvec3(c->yfov, c->ymag, c->near));
    add_double(hash, c->far);
}

static void add_pixels(uint64_t *hash, const struct scene *scene)
{
    for (size_t i = 0; i < scene->texture_count; i++) {
        const struct texture *t = &scene->textures[i];
        add_word(hash, (uint64_t)t->image << 32 | (uint64_t)t->wrap_s << 16 | (uint64_t)t->wrap_t << 8 | t->nearest);
    }
    for (size_t i = 0; i < scene->image_count; i++) {
        const struct image *image = &scene->images[i];
        add_word(hash, (uint64_t)image->width << 32 | image->height);
        add_bytes(hash, image->rgba, (size_t)image->width * image->height * 4);
    }
}

uint64_t scene_hash(const struct scene *scene)
{
    uint64_t hash = 1;
    add_bytes(&hash, scene->positions, scene->vertex_count * sizeof *scene->positions);
    add_bytes(&hash, scene->normals, scene->vertex_count * sizeof *scene->normals);
    add_bytes(&hash, scene->indices, scene->index_count * sizeof *scene->indices);
    add_bytes(&hash, scene->texcoords, scene->texcoord_count * sizeof *scene->texcoords);
    add_bytes(&hash, scene->colors, scene->color_count * sizeof *scene->colors);
    for (size_t i = 0; i < scene->mesh_count; i++)
        add_mesh(&hash, &scene->meshes[i]);
    for (size_t i = 0; i < scene->instance_count; i++)
        add_instance(&hash, &scene->instances[i]);
    for (size_t i = 0; i < scene->material_count; i++)
        add_material(&hash, &scene->materials[i]);
    add_pixels(&hash, scene);
    for (size_t i = 0; i < scene->light_count; i++)
        add_light(&hash, &scene->lights[i]);
    for (size_t i = 0; i < scene->camera_count; i++)
        add_camera(&hash, &scene->cameras[i]);
    return hash;
}
