#include "draw/draw_scene.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/pack_material.h"
#include "draw/pack_texels.h"
#include "gl/context.h"

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for the scene's buffers");
}

static uint32_t snorm16(float x)
{
    float clamped = x < -1 ? -1 : x > 1 ? 1 : x;
    return (uint16_t)(int16_t)lrintf(clamped * 32767.0f);
}

/* Octahedral map of the unit sphere: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors". */
static uint32_t pack_normal(const float n[3])
{
    float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    if (!(sum > 0 && sum < INFINITY))
        return 0;
    float x = n[0] / sum, y = n[1] / sum;
    if (n[2] < 0) {
        float folded = (1 - fabsf(y)) * (x >= 0 ? 1.0f : -1.0f);
        y = (1 - fabsf(x)) * (y >= 0 ? 1.0f : -1.0f);
        x = folded;
    }
    return snorm16(x) | snorm16(y) << 16;
}

static bool upload_vertices(struct draw_scene *d, struct error *err)
{
    const struct scene *s = d->scene;
    struct vertex {
        float position[3];
        uint32_t normal;
    } *packed = malloc((s->vertex_count + 1) * sizeof *packed);
    if (!packed)
        return out_of_memory(err);
    for (size_t i = 0; i < s->vertex_count; i++) {
        memcpy(packed[i].position, s->positions[i], sizeof packed[i].position);
        packed[i].normal = pack_normal(s->normals[i]);
    }
    bool ok = gl_buffer_set(&d->vertices, d->gl, packed, s->vertex_count * sizeof *packed, GL_RGBA32UI, err);
    free(packed);
    return ok;
}

static bool upload_triangles(struct draw_scene *d, struct error *err)
{
    const struct scene *s = d->scene;
    uint32_t(*packed)[4] = calloc(s->index_count / 3 + 1, sizeof *packed);
    if (!packed)
        return out_of_memory(err);
    for (size_t m = 0; m < s->mesh_count; m++) {
        const struct mesh *mesh = &s->meshes[m];
        for (uint32_t i = 0; i < mesh->index_count; i++) {
            size_t at = mesh->first_index + i;
            packed[at / 3][at % 3] = mesh->first_vertex + s->indices[at];
        }
    }
    bool ok = gl_buffer_set(&d->triangles, d->gl, packed, s->index_count / 3 * sizeof *packed, GL_RGBA32UI, err);
    free(packed);
    return ok;
}

static bool upload_instances(struct draw_scene *d, struct error *err)
{
    const struct scene *s = d->scene;
    uint32_t(*packed)[4] = calloc(s->instance_count + 1, sizeof *packed);
    uint32_t *numbers = calloc(s->instance_count + 1, sizeof *numbers);
    bool ok = packed && numbers;
    for (uint32_t i = 0; ok && i < s->instance_count; i++) {
        const struct instance *instance = &s->instances[i];
        const struct mesh *mesh = &s->meshes[instance->mesh];
        packed[i][0] = instance->first_triangle;
        packed[i][1] = mesh->first_index / 3;
        packed[i][2] = mesh->material;
        packed[i][3] = instance->mirrored ? INSTANCE_MIRRORED : 0;
        numbers[i] = i;
    }
    ok = ok ? gl_buffer_set(&d->instances, d->gl, packed, s->instance_count * sizeof *packed, GL_RGBA32UI, err) &&
                  gl_buffer_set(&d->instance_numbers, d->gl, numbers, s->instance_count * sizeof *numbers, 0, err)
            : out_of_memory(err);
    free(packed);
    free(numbers);
    return ok;
}

/* Attributes that only some meshes have get a row for every vertex once one mesh has them: a shader asks by vertex number. */
static bool upload_attribute(struct draw_scene *d, struct gl_buffer *buffer, bool colors, struct error *err)
{
    const struct scene *s = d->scene;
    float(*rows)[4] = calloc(s->vertex_count + 1, sizeof *rows);
    if (!rows)
        return out_of_memory(err);
    for (size_t m = 0; m < s->mesh_count; m++) {
        const struct mesh *mesh = &s->meshes[m];
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            float *row = rows[mesh->first_vertex + v];
            if (colors) {
                static const float white[4] = {1, 1, 1, 1};
                memcpy(row, mesh->first_color == SCENE_NONE ? white : s->colors[mesh->first_color + v], sizeof white);
            } else {
                for (int set = 0; set < 2; set++)
                    if (mesh->first_texcoord[set] != SCENE_NONE)
                        memcpy(row + 2 * set, s->texcoords[mesh->first_texcoord[set] + v], 2 * sizeof(float));
            }
        }
    }
    bool ok = gl_buffer_set(buffer, d->gl, rows, s->vertex_count * sizeof *rows, GL_RGBA32F, err);
    free(rows);
    return ok;
}

static bool upload_materials(struct draw_scene *d, struct error *err)
{
    const struct scene *s = d->scene;
    float(*packed)[MATERIAL_TEXELS][4] = calloc(s->material_count + 1, sizeof *packed);
    if (!packed)
        return out_of_memory(err);
    for (size_t i = 0; i < s->material_count; i++)
        pack_material(&s->materials[i], packed[i]);
    bool ok = gl_buffer_set(&d->materials, d->gl, packed, s->material_count * sizeof *packed, GL_RGBA32F, err);
    free(packed);
    return ok;
}

static bool upload_textures(struct draw_scene *d, struct error *err)
{
    struct packed_texels packed;
    if (!pack_texels(&packed, d->scene, (size_t)d->gl->caps.max_texture_buffer, err))
        return false;
    bool ok = gl_buffer_set(&d->textures, d->gl, packed.textures, d->scene->texture_count * sizeof *packed.textures, GL_RGBA32UI,
                            err) &&
              gl_buffer_set(&d->texels, d->gl, packed.texels, packed.texel_count * sizeof *packed.texels, GL_R32UI, err);
    packed_texels_finish(&packed);
    return ok;
}

static bool emits(const struct material *m)
{
    return m->unlit || m->emissive[0] > 0 || m->emissive[1] > 0 || m->emissive[2] > 0 ||
           m->occlusion_texture.texture != SCENE_NONE;
}

static void classify(struct draw_scene *d)
{
    const struct scene *s = d->scene;
    d->plain = true;
    for (size_t i = 0; i < s->material_count; i++) {
        const struct material *m = &s->materials[i];
        d->has_emission |= emits(m);
        d->plain &= !emits(m) && m->base_color_texture.texture == SCENE_NONE && m->normal_texture.texture == SCENE_NONE &&
                    m->metallic_roughness_texture.texture == SCENE_NONE;
    }
}

static void make_vertex_array(struct draw_scene *d)
{
    glCreateVertexArrays(1, &d->vertex_array);
    glVertexArrayVertexBuffer(d->vertex_array, 0, d->vertices.id, 0, 16);
    glVertexArrayAttribFormat(d->vertex_array, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(d->vertex_array, 0, 0);
    glEnableVertexArrayAttrib(d->vertex_array, 0);
    glVertexArrayVertexBuffer(d->vertex_array, 1, d->instance_numbers.id, 0, 4);
    glVertexArrayAttribIFormat(d->vertex_array, 1, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(d->vertex_array, 1, 1);
    glVertexArrayBindingDivisor(d->vertex_array, 1, 1);
    glEnableVertexArrayAttrib(d->vertex_array, 1);
}

static size_t total_bytes(const struct draw_scene *d)
{
    return d->vertices.size + d->triangles.size + d->instances.size + d->texcoords.size + d->colors.size + d->materials.size +
           d->textures.size + d->texels.size + d->indices.size + d->instance_numbers.size;
}

bool draw_scene_init(struct draw_scene *d, struct gl_context *gl, const struct scene *scene, struct error *err)
{
    memset(d, 0, sizeof *d);
    d->scene = scene;
    d->gl = gl;
    bool ok = upload_vertices(d, err) && upload_triangles(d, err) && upload_instances(d, err) && upload_materials(d, err) &&
              (!scene->texcoord_count || upload_attribute(d, &d->texcoords, false, err)) &&
              (!scene->color_count || upload_attribute(d, &d->colors, true, err)) &&
              (!scene->texture_count || upload_textures(d, err));
    if (!ok) {
        draw_scene_finish(d);
        return false;
    }
    classify(d);
    make_vertex_array(d);
    d->bytes = total_bytes(d);
    return gl_check(gl, err);
}

bool draw_scene_need_indices(struct draw_scene *d, struct error *err)
{
    if (d->indices.id)
        return true;
    if (!gl_buffer_set(&d->indices, d->gl, d->scene->indices, d->scene->index_count * sizeof(uint32_t), 0, err))
        return false;
    glVertexArrayElementBuffer(d->vertex_array, d->indices.id);
    d->bytes = total_bytes(d);
    return true;
}

void draw_scene_finish(struct draw_scene *d)
{
    glDeleteVertexArrays(d->vertex_array != 0, &d->vertex_array);
    struct gl_buffer *buffers[] = {&d->vertices,  &d->triangles, &d->instances, &d->texcoords, &d->colors,
                                   &d->materials, &d->textures,  &d->texels,    &d->indices,   &d->instance_numbers};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        gl_buffer_finish(buffers[i]);
    memset(d, 0, sizeof *d);
}

void draw_scene_bind(const struct draw_scene *d)
{
    gl_buffer_bind_texture(&d->vertices, UNIT_VERTICES);
    gl_buffer_bind_texture(&d->triangles, UNIT_TRIANGLES);
    gl_buffer_bind_texture(&d->instances, UNIT_INSTANCES);
    gl_buffer_bind_texture(&d->texcoords, UNIT_TEXCOORDS);
    gl_buffer_bind_texture(&d->colors, UNIT_COLORS);
    gl_buffer_bind_texture(&d->materials, UNIT_MATERIALS);
    gl_buffer_bind_texture(&d->textures, UNIT_TEXTURES);
    gl_buffer_bind_texture(&d->texels, UNIT_TEXELS);
}
