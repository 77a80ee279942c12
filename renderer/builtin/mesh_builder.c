#include "builtin/mesh_builder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

#define PI 3.14159265358979323846

_Static_assert(sizeof(struct builder_float3) == sizeof(float[3]), "moved into the scene as float[3]");
_Static_assert(sizeof(struct builder_float2) == sizeof(float[2]), "moved into the scene as float[2]");
_Static_assert(sizeof(struct builder_float4) == sizeof(float[4]), "moved into the scene as float[4]");

static struct builder_float3 to_float3(struct dvec3 p) { return (struct builder_float3){{(float)p.x, (float)p.y, (float)p.z}}; }

static struct dvec3 from_float3(struct builder_float3 p) { return dvec3_from_float(p.v); }

static struct mesh *current_mesh(struct mesh_builder *b) { return &b->meshes.data[b->meshes.count - 1]; }

static void release(struct mesh_builder *b)
{
    array_finish(&b->positions);
    array_finish(&b->normals);
    array_finish(&b->colors);
    array_finish(&b->indices);
    array_finish(&b->meshes);
    array_finish(&b->instances);
    array_finish(&b->texcoords);
    array_finish(&b->materials);
    array_finish(&b->textures);
    for (size_t i = 0; i < b->images.count; i++)
        free(b->images.data[i].rgba);
    array_finish(&b->images);
    array_finish(&b->lights);
    array_finish(&b->cameras);
    *b = (struct mesh_builder){0};
}

static void move_arrays(struct scene *scene, struct mesh_builder *b)
{
    scene->positions = (float(*)[3])b->positions.data;
    scene->normals = (float(*)[3])b->normals.data;
    scene->vertex_count = b->positions.count;
    scene->colors = (float(*)[4])b->colors.data;
    scene->color_count = b->colors.count;
    scene->texcoords = (float(*)[2])b->texcoords.data;
    scene->texcoord_count = b->texcoords.count;
    scene->textures = b->textures.data;
    scene->texture_count = b->textures.count;
    scene->images = b->images.data;
    scene->image_count = b->images.count;
    scene->indices = b->indices.data;
    scene->index_count = b->indices.count;
    scene->meshes = b->meshes.data;
    scene->mesh_count = b->meshes.count;
    scene->instances = b->instances.data;
    scene->instance_count = b->instances.count;
    scene->materials = b->materials.data;
    scene->material_count = b->materials.count;
    scene->lights = b->lights.data;
    scene->light_count = b->lights.count;
    scene->cameras = b->cameras.data;
    scene->camera_count = b->cameras.count;
    *b = (struct mesh_builder){0};
}

struct scene *mesh_builder_finish(struct mesh_builder *b, const char *name, struct error *err)
{
    struct scene *scene = b->failed ? NULL : calloc(1, sizeof *scene);
    if (!scene) {
        release(b);
        error_set(err, ERROR_TRY_AGAIN, NULL, "not enough memory for the scene '%s'; ask for fewer triangles", name);
        return NULL;
    }
    move_arrays(scene, b);
    snprintf(scene->name, sizeof scene->name, "%s", name);
    if (!scene_finish(scene, err)) {
        scene_destroy(scene);
        return NULL;
    }
    return scene;
}

uint32_t mesh_builder_material(struct mesh_builder *b, const char *name, const float rgb[3], float roughness, bool double_sided)
{
    struct texture_use none = {SCENE_NONE, 0, {{1, 0, 0}, {0, 1, 0}}};
    struct material m = {
        .base_color = {rgb[0], rgb[1], rgb[2], 1},
        .roughness = roughness,
        .normal_scale = 1,
        .occlusion_strength = 1,
        .alpha_mode = ALPHA_OPAQUE,
        .alpha_cutoff = 0.5f,
        .double_sided = double_sided,
        .base_color_texture = none,
        .metallic_roughness_texture = none,
        .normal_texture = none,
        .occlusion_texture = none,
        .emissive_texture = none,
    };
    snprintf(m.name, sizeof m.name, "%s", name);
    if (!array_push(&b->materials, m))
        b->failed = true;
    return (uint32_t)b->materials.count - 1;
}

void mesh_builder_cut_out(struct mesh_builder *b, uint32_t material, uint32_t side, uint8_t *rgba)
{
    struct image image = {.width = side, .height = side, .rgba = rgba, .name = "cut-out"};
    struct texture texture = {(uint32_t)b->images.count, WRAP_CLAMP_TO_EDGE, WRAP_CLAMP_TO_EDGE, true};
    if (!rgba || b->failed || !array_push(&b->images, image)) {
        free(rgba);
        b->failed = true;
        return;
    }
    b->materials.data[material].alpha_mode = ALPHA_MASK;
    b->materials.data[material].base_color_texture.texture = (uint32_t)b->textures.count;
    if (!array_push(&b->textures, texture))
        b->failed = true;
}

static void begin(struct mesh_builder *b, const char *name, uint32_t material, bool colored, bool textured)
{
    struct mesh m = {
        .first_vertex = (uint32_t)b->positions.count,
        .first_index = (uint32_t)b->indices.count,
        .first_texcoord = {textured ? (uint32_t)b->texcoords.count : SCENE_NONE, SCENE_NONE},
        .first_color = colored ? (uint32_t)b->colors.count : SCENE_NONE,
        .material = material,
    };
    snprintf(m.name, sizeof m.name, "%s", name);
    b->colored = colored;
    b->textured = textured;
    mesh_builder_color(b, 1, 1, 1);
    if (!array_push(&b->meshes, m))
        b->failed = true;
}

void mesh_builder_begin(struct mesh_builder *b, const char *name, uint32_t material) { begin(b, name, material, false, false); }

void mesh_builder_begin_colored(struct mesh_builder *b, const char *name, uint32_t material)
{
    begin(b, name, material, true, false);
}

void mesh_builder_begin_textured(struct mesh_builder *b, const char *name, uint32_t material)
{
    begin(b, name, material, false, true);
}

void mesh_builder_texcoord(struct mesh_builder *b, double u, double v)
{
    b->texcoord[0] = (float)u;
    b->texcoord[1] = (float)v;
}

void mesh_builder_color(struct mesh_builder *b, double red, double green, double blue)
{
    b->color[0] = (float)red;
    b->color[1] = (float)green;
    b->color[2] = (float)blue;
    b->color[3] = 1;
}

uint32_t mesh_builder_vertices(const struct mesh_builder *b)
{
    return b->failed ? 0 : (uint32_t)(b->positions.count - b->meshes.data[b->meshes.count - 1].first_vertex);
}

uint32_t mesh_builder_triangles(const struct mesh_builder *b)
{
    return b->failed ? 0 : (uint32_t)((b->indices.count - b->meshes.data[b->meshes.count - 1].first_index) / 3);
}

void mesh_builder_end(struct mesh_builder *b)
{
    if (b->failed)
        return;
    struct mesh *m = current_mesh(b);
    m->vertex_count = mesh_builder_vertices(b);
    m->index_count = 3 * mesh_builder_triangles(b);
    struct instance placed = {.mesh = (uint32_t)b->meshes.count - 1, .to_scene = affine_identity()};
    if (!array_push(&b->instances, placed))
        b->failed = true;
}

uint32_t mesh_builder_vertex(struct mesh_builder *b, struct dvec3 position, struct dvec3 normal)
{
    uint32_t number = mesh_builder_vertices(b);
    struct builder_float4 color = {{b->color[0], b->color[1], b->color[2], b->color[3]}};
    struct builder_float2 texcoord = {{b->texcoord[0], b->texcoord[1]}};
    if (b->failed || b->positions.count >= UINT32_MAX - 1 || !array_push(&b->positions, to_float3(position)) ||
        !array_push(&b->normals, to_float3(normal)) || (b->colored && !array_push(&b->colors, color)) ||
        (b->textured && !array_push(&b->texcoords, texcoord)))
        b->failed = true;
    return number;
}

void mesh_builder_triangle(struct mesh_builder *b, uint32_t i, uint32_t j, uint32_t k)
{
    if (b->failed || b->indices.count > UINT32_MAX - 3 || !array_extend(&b->indices, 3)) {
        b->failed = true;
        return;
    }
    uint32_t *corner = &b->indices.data[b->indices.count - 3];
    corner[0] = i;
    corner[1] = j;
    corner[2] = k;
}

void mesh_builder_quad(struct mesh_builder *b, uint32_t i, uint32_t j, uint32_t k, uint32_t l)
{
    mesh_builder_triangle(b, i, j, k);
    mesh_builder_triangle(b, i, k, l);
}

/* Upwards where the triangle has no normal. */
static struct dvec3 face_normal(struct dvec3 p, struct dvec3 q, struct dvec3 r)
{
    struct dvec3 n = dvec3_normalize(dvec3_cross(dvec3_sub(q, p), dvec3_sub(r, p)));
    return dvec3_dot(n, n) > 0.5 && dvec3_finite(n) ? n : dvec3(0, 1, 0);
}

void mesh_builder_flat_triangle(struct mesh_builder *b, struct dvec3 p, struct dvec3 q, struct dvec3 r)
{
    struct dvec3 n = face_normal(p, q, r);
    uint32_t i = mesh_builder_vertex(b, p, n);
    uint32_t j = mesh_builder_vertex(b, q, n);
    uint32_t k = mesh_builder_vertex(b, r, n);
    mesh_builder_triangle(b, i, j, k);
}

void mesh_builder_flat_quad(struct mesh_builder *b, struct dvec3 p, struct dvec3 q, struct dvec3 r, struct dvec3 s)
{
    struct dvec3 n = face_normal(p, q, r);
    uint32_t i = mesh_builder_vertex(b, p, n);
    uint32_t j = mesh_builder_vertex(b, q, n);
    uint32_t k = mesh_builder_vertex(b, r, n);
    uint32_t l = mesh_builder_vertex(b, s, n);
    mesh_builder_quad(b, i, j, k, l);
}

void mesh_builder_box(struct mesh_builder *b, struct dvec3 center, struct dvec3 size, double turn)
{
    /* Corner i: bit 0 = +x, bit 1 = +y, bit 2 = +z. */
    static const unsigned char faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    double c = cos(turn), s = sin(turn);
    struct dvec3 corners[8];
    for (unsigned i = 0; i < 8; i++) {
        double x = (i & 1 ? 0.5 : -0.5) * size.x, z = (i & 4 ? 0.5 : -0.5) * size.z;
        corners[i] = dvec3_add(center, dvec3(c * x + s * z, i & 2 ? size.y : 0, c * z - s * x));
    }
    for (unsigned f = 0; f < 6; f++)
        mesh_builder_flat_quad(b, corners[faces[f][0]], corners[faces[f][1]], corners[faces[f][2]], corners[faces[f][3]]);
}

void mesh_builder_smooth(struct mesh_builder *b, uint32_t first)
{
    if (b->failed)
        return;
    const struct mesh *m = current_mesh(b);
    struct builder_float3 *positions = b->positions.data + m->first_vertex;
    struct builder_float3 *normals = b->normals.data + m->first_vertex;
    uint32_t count = mesh_builder_vertices(b);
    memset(normals + first, 0, (count - first) * sizeof *normals);
    for (size_t i = m->first_index; i < b->indices.count; i += 3) {
        const uint32_t *v = &b->indices.data[i];
        if (v[0] < first || v[1] < first || v[2] < first)
            continue;
        struct dvec3 p = from_float3(positions[v[0]]);
        struct dvec3 n = dvec3_cross(dvec3_sub(from_float3(positions[v[1]]), p), dvec3_sub(from_float3(positions[v[2]]), p));
        for (int corner = 0; corner < 3; corner++) {
            float *sum = normals[v[corner]].v;
            sum[0] += (float)n.x;
            sum[1] += (float)n.y;
            sum[2] += (float)n.z;
        }
    }
    for (uint32_t i = first; i < count; i++) {
        struct dvec3 n = dvec3_normalize(from_float3(normals[i]));
        normals[i] = to_float3(dvec3_dot(n, n) > 0.5 ? n : dvec3(0, 1, 0));
    }
}

void mesh_builder_stand(struct mesh_builder *b)
{
    if (b->failed || mesh_builder_vertices(b) == 0)
        return;
    struct builder_float3 *p = b->positions.data + current_mesh(b)->first_vertex;
    float lowest = p[0].v[1];
    for (uint32_t i = 1; i < mesh_builder_vertices(b); i++)
        lowest = fminf(lowest, p[i].v[1]);
    for (uint32_t i = 0; i < mesh_builder_vertices(b); i++)
        p[i].v[1] -= lowest;
}

static struct dvec3 any_perpendicular(struct dvec3 v)
{
    struct dvec3 other = fabs(v.y) < 0.9 * dvec3_length(v) ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    return dvec3_normalize(dvec3_cross(other, v));
}

/* Ring `i` of a tube; `side` is carried along the path so that the tube does not twist. */
static void tube_ring(struct mesh_builder *b, struct dvec3 center, struct dvec3 along, struct dvec3 *side, double radius,
                      unsigned sides)
{
    along = dvec3_normalize(along);
    *side = dvec3_normalize(dvec3_mad(*side, along, -dvec3_dot(*side, along)));
    struct dvec3 other = dvec3_cross(along, *side);
    for (unsigned k = 0; k < sides; k++) {
        double angle = 2 * PI * k / sides;
        struct dvec3 out = dvec3_mad(dvec3_scale(*side, cos(angle)), other, sin(angle));
        mesh_builder_vertex(b, dvec3_mad(center, out, radius), out);
    }
}

static void tube_cap(struct mesh_builder *b, struct dvec3 center, struct dvec3 outward, uint32_t ring, unsigned sides,
                     bool reverse)
{
    uint32_t middle = mesh_builder_vertex(b, center, dvec3_normalize(outward));
    for (unsigned k = 0; k < sides; k++) {
        uint32_t here = ring + k, next = ring + (k + 1) % sides;
        mesh_builder_triangle(b, middle, reverse ? next : here, reverse ? here : next);
    }
}

void mesh_builder_tube(struct mesh_builder *b, const struct dvec3 *points, const double *radii, unsigned count, unsigned sides,
                       bool capped)
{
    uint32_t first = mesh_builder_vertices(b);
    struct dvec3 side = any_perpendicular(dvec3_sub(points[1], points[0]));
    for (unsigned i = 0; i < count; i++) {
        struct dvec3 along = dvec3_sub(points[i + 1 < count ? i + 1 : i], points[i > 0 ? i - 1 : 0]);
        tube_ring(b, points[i], along, &side, radii[i], sides);
    }
    for (unsigned i = 0; i + 1 < count; i++)
        for (unsigned k = 0; k < sides; k++) {
            uint32_t here = first + i * sides + k, next = first + i * sides + (k + 1) % sides;
            mesh_builder_quad(b, here, next, next + sides, here + sides);
        }
    if (!capped)
        return;
    tube_cap(b, points[0], dvec3_sub(points[0], points[1]), first, sides, true);
    tube_cap(b, points[count - 1], dvec3_sub(points[count - 1], points[count - 2]), first + (count - 1) * sides, sides, false);
}

static uint32_t ellipsoid_vertex(struct mesh_builder *b, struct dvec3 center, const struct dvec3 axes[3], const double radii[3],
                                 struct dvec3 unit)
{
    const double local[3] = {unit.x, unit.y, unit.z};
    struct dvec3 p = center, n = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        p = dvec3_mad(p, axes[i], radii[i] * local[i]);
        n = dvec3_mad(n, axes[i], local[i] / radii[i]);
    }
    return mesh_builder_vertex(b, p, dvec3_normalize(n));
}

void mesh_builder_ellipsoid(struct mesh_builder *b, struct dvec3 center, const struct dvec3 axes[3], const double radii[3],
                            unsigned rings, unsigned sides)
{
    uint32_t top = ellipsoid_vertex(b, center, axes, radii, dvec3(0, 1, 0));
    uint32_t first = top + 1;
    for (unsigned i = 1; i < rings; i++)
        for (unsigned k = 0; k < sides; k++) {
            double polar = PI * i / rings, around = 2 * PI * k / sides;
            ellipsoid_vertex(b, center, axes, radii, dvec3(sin(polar) * sin(around), cos(polar), sin(polar) * cos(around)));
        }
    uint32_t bottom = ellipsoid_vertex(b, center, axes, radii, dvec3(0, -1, 0));
    for (unsigned k = 0; k < sides; k++) {
        uint32_t next = (k + 1) % sides, last = first + (rings - 2) * sides;
        mesh_builder_triangle(b, top, first + k, first + next);
        for (unsigned i = 0; i + 2 < rings; i++) {
            uint32_t ring = first + i * sides;
            mesh_builder_quad(b, ring + k, ring + sides + k, ring + sides + next, ring + next);
        }
        mesh_builder_triangle(b, bottom, last + next, last + k);
    }
}

void mesh_builder_ground(struct mesh_builder *b, double width, double depth, const float rgb[3])
{
    double x = width / 2, z = depth / 2;
    mesh_builder_begin(b, "ground", mesh_builder_material(b, "ground", rgb, 0.9f, false));
    mesh_builder_flat_quad(b, dvec3(-x, 0, z), dvec3(x, 0, z), dvec3(x, 0, -z), dvec3(-x, 0, -z));
    mesh_builder_end(b);
}

static void add_light(struct mesh_builder *b, struct light light)
{
    snprintf(light.name, sizeof light.name, "key");
    light.color[0] = light.color[1] = light.color[2] = 1;
    if (!array_push(&b->lights, light))
        b->failed = true;
}

void mesh_builder_point_light(struct mesh_builder *b, struct dvec3 position, float intensity)
{
    add_light(b, (struct light){.kind = LIGHT_POINT, .position = position, .direction = {0, -1, 0}, .intensity = intensity});
}

void mesh_builder_directional_light(struct mesh_builder *b, struct dvec3 direction, float intensity)
{
    add_light(b, (struct light){.kind = LIGHT_DIRECTIONAL, .direction = direction, .intensity = intensity});
}

void mesh_builder_spot_light(struct mesh_builder *b, struct dvec3 position, struct dvec3 direction, double inner, double outer,
                             float intensity)
{
    add_light(b, (struct light){.kind = LIGHT_SPOT,
                                .position = position,
                                .direction = direction,
                                .inner = inner,
                                .outer = outer,
                                .intensity = intensity});
}

static void add_camera(struct mesh_builder *b, struct camera camera)
{
    snprintf(camera.name, sizeof camera.name, "camera");
    if (!array_push(&b->cameras, camera))
        b->failed = true;
}

void mesh_builder_camera(struct mesh_builder *b, struct dvec3 eye, struct dvec3 target, double yfov)
{
    struct dvec3 away = dvec3_sub(eye, target), back = dvec3_normalize(away);
    struct dvec3 right = dvec3_normalize(dvec3_cross(dvec3(0, 1, 0), back));
    double near = 0.01 * dvec3_length(away);
    add_camera(b, (struct camera){.eye = eye,
                                  .right = right,
                                  .up = dvec3_cross(back, right),
                                  .back = back,
                                  .yfov = yfov,
                                  .near = near,
                                  .far = INFINITY});
}

void mesh_builder_name_camera(struct mesh_builder *b, const char *name)
{
    if (b->cameras.count)
        snprintf(b->cameras.data[b->cameras.count - 1].name, sizeof b->cameras.data->name, "%s", name);
}

void mesh_builder_camera_above(struct mesh_builder *b, double height, double half_height)
{
    add_camera(b, (struct camera){.orthographic = true,
                                  .eye = dvec3(0, height, 0),
                                  .right = dvec3(1, 0, 0),
                                  .up = dvec3(0, 0, -1),
                                  .back = dvec3(0, 1, 0),
                                  .ymag = half_height,
                                  .near = 0,
                                  .far = 2 * height});
}

void mesh_builder_stage(struct mesh_builder *b)
{
    mesh_builder_ground(b, 12, 12, (const float[]){0.76f, 0.74f, 0.70f});
    mesh_builder_point_light(b, dvec3(2.5, 5, 3), 400);
    mesh_builder_camera(b, dvec3(0, 2.2, 4.8), dvec3(0, 0.8, 0), 0.7);
}

/* The finishing steps of MurmurHash3 (Austin Appleby, public domain). */
uint32_t hash_uint32(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ x >> 16;
}

double hash_unit(uint32_t x) { return hash_uint32(x + 0x9e3779b9u) * (1.0 / 4294967296.0); }
