#include "draw/draw_view.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "blocks.h"
#include "draw/cull.h"
#include "draw/draw_scene.h"
#include "gl/context.h"
#include "gl/program.h"

/* Draws that share state: opaque or with holes, and which faces are hidden. */
enum { BUCKET_HOLES = 1, BUCKET_CULL_BACK = 2, BUCKET_CULL_FRONT = 4, BUCKET_COUNT = 6 };

struct command { /* DrawElementsIndirectCommand */
    uint32_t count, instance_count, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

static bool upload_rows(struct draw_view *v, const struct draw_scene *d, struct error *err)
{
    const struct scene *s = d->scene;
    float(*rows)[3][4] = malloc((s->instance_count + 1) * sizeof *rows);
    if (!rows)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
    double eye[3] = {v->view.eye.x, v->view.eye.y, v->view.eye.z};
    for (size_t i = 0; i < s->instance_count; i++)
        for (int r = 0; r < 3; r++) {
            const struct affine *a = &s->instances[i].to_scene;
            for (int c = 0; c < 3; c++)
                rows[i][r][c] = (float)a->linear[r][c];
            rows[i][r][3] = (float)(a->offset[r] - eye[r]);
        }
    bool ok = gl_buffer_set(&v->rows, d->gl, rows, s->instance_count * sizeof *rows, GL_RGBA32F, err);
    free(rows);
    return ok;
}

/* Rows of the map from relative positions to clip space; row 0 of the picture at the top. */
static void clip_matrix(const struct view *v, double m[4][4])
{
    struct dvec3 r = v->right, u = v->up, f = v->forward;
    double sx = 2 / (v->right_edge - v->left), sy = 2 / (v->top - v->bottom);
    memset(m, 0, 16 * sizeof(double));
    double axes[3][3] = {{r.x, r.y, r.z}, {u.x, u.y, u.z}, {f.x, f.y, f.z}};
    if (v->orthographic) {
        double sz = 1 / (v->far - v->near);
        for (int i = 0; i < 3; i++) {
            m[0][i] = sx * axes[0][i];
            m[1][i] = -sy * axes[1][i];
            m[2][i] = -sz * axes[2][i];
        }
        m[0][3] = -sx * v->left - 1;
        m[1][3] = sy * v->top - 1;
        m[2][3] = sz * v->far;
        m[3][3] = 1;
        return;
    }
    for (int i = 0; i < 3; i++) {
        m[0][i] = sx * (axes[0][i] - v->left * axes[2][i]) - axes[2][i];
        m[1][i] = sy * (v->top * axes[2][i] - axes[1][i]) - axes[2][i];
        m[3][i] = axes[2][i];
    }
    m[2][3] = v->near;
}

static bool upload_block(struct draw_view *v, const struct draw_scene *d, struct error *err)
{
    struct draw_block block = {0};
    double m[4][4];
    clip_matrix(&v->view, m);
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++)
            block.clip_from_relative[column][row] = (float)m[row][column];
    struct dvec3 f = v->view.forward;
    vec4 far = {isinf(v->view.far) ? 0 : (float)v->view.far, (float)f.x, (float)f.y, (float)f.z};
    memcpy(block.draw_far, far, sizeof far);
    return gl_buffer_set(&v->block, d->gl, &block, sizeof block, 0, err);
}

bool draw_view_set(struct draw_view *v, const struct draw_scene *scene, const struct view *view, struct error *err)
{
    v->view = *view;
    return upload_rows(v, scene, err) && upload_block(v, scene, err);
}

bool draw_view_set_edges(struct draw_view *v, const struct draw_scene *scene, const struct view *view, struct error *err)
{
    v->view = *view;
    return upload_block(v, scene, err);
}

void draw_view_finish(struct draw_view *v)
{
    gl_buffer_finish(&v->rows);
    gl_buffer_finish(&v->commands);
    gl_buffer_finish(&v->block);
    memset(v, 0, sizeof *v);
}

static unsigned bucket_of(const struct scene *s, const struct instance *instance, enum draw_what what)
{
    const struct material *m = &s->materials[s->meshes[instance->mesh].material];
    unsigned bucket = material_has_holes(m) ? BUCKET_HOLES : 0;
    if (what == DRAW_IDS && !m->double_sided)
        bucket |= instance->mirrored ? BUCKET_CULL_FRONT : BUCKET_CULL_BACK;
    return bucket;
}

/* Fills `commands` bucket after bucket; starts[b] .. starts[b + 1] are bucket b's. */
static void fill_commands(const struct draw_view *v, const struct scene *s, enum draw_what what, const uint32_t *instances,
                          size_t count, struct command *commands, size_t starts[BUCKET_COUNT + 1])
{
    size_t n = 0;
    for (unsigned bucket = 0; bucket < BUCKET_COUNT; bucket++) {
        starts[bucket] = n;
        for (size_t k = 0; k < count; k++) {
            uint32_t i = instances ? instances[k] : (uint32_t)k;
            const struct instance *instance = &s->instances[i];
            const struct mesh *mesh = &s->meshes[instance->mesh];
            if (bucket_of(s, instance, what) == bucket && mesh->index_count > 0 &&
                cull_box_visible(&v->view, &instance->bounds, what != DRAW_IDS))
                commands[n++] = (struct command){mesh->index_count, 1, mesh->first_index, (int32_t)mesh->first_vertex, i};
        }
    }
    starts[BUCKET_COUNT] = n;
}

static bool draw_bucket(const struct draw_view *v, const struct draw_scene *d, enum draw_what what, unsigned bucket, size_t first,
                        size_t count, struct error *err)
{
    char defines[128];
    snprintf(defines, sizeof defines, "%s%s%sHAS_TEXCOORDS %d\nHAS_COLORS %d\n", what != DRAW_DEPTH ? "IDS\n" : "",
             bucket & BUCKET_HOLES ? "HOLES\n" : "", !v->view.orthographic && !isinf(v->view.far) ? "FAR\n" : "",
             d->scene->texcoord_count > 0, d->scene->color_count > 0);
    struct gl_program *program = gl_programs_get(d->gl->programs, "scene_draw.vert", "scene_draw.frag", defines, err);
    if (!program)
        return false;
    gl_program_use(program);
    /* Row 0 at the top mirrors the picture: counter-clockwise faces arrive clockwise. */
    glFrontFace(GL_CW);
    glCullFace(bucket & BUCKET_CULL_FRONT ? GL_FRONT : GL_BACK);
    (bucket & (BUCKET_CULL_FRONT | BUCKET_CULL_BACK) ? glEnable : glDisable)(GL_CULL_FACE);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(first * sizeof(struct command)), (GLsizei)count, 0);
    return true;
}

static bool draw_buckets(struct draw_view *v, struct draw_scene *d, enum draw_what what, const size_t starts[], struct error *err)
{
    bool ok = true;
    bool far = !v->view.orthographic && !isinf(v->view.far);
    glBindVertexArray(d->vertex_array);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, v->commands.id);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, v->block.id);
    draw_scene_bind(d);
    gl_buffer_bind_texture(&v->rows, UNIT_ROWS);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    (what != DRAW_IDS ? glEnable : glDisable)(GL_DEPTH_CLAMP);
    (far ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
    for (unsigned bucket = 0; ok && bucket < BUCKET_COUNT; bucket++)
        if (starts[bucket + 1] > starts[bucket])
            ok = draw_bucket(v, d, what, bucket, starts[bucket], starts[bucket + 1] - starts[bucket], err);
    glDisable(GL_CLIP_DISTANCE0);
    glDisable(GL_DEPTH_CLAMP);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    return ok && gl_check(d->gl, err);
}

bool draw_view_rasterize(struct draw_view *v, struct draw_scene *d, enum draw_what what, const uint32_t *instances,
                         size_t instance_count, struct error *err)
{
    size_t count = instances ? instance_count : d->scene->instance_count, starts[BUCKET_COUNT + 1];
    struct command *commands = malloc((count + 1) * sizeof *commands);
    if (!commands)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory");
    fill_commands(v, d->scene, what, instances, count, commands, starts);
    bool ok = draw_scene_need_indices(d, err) &&
              gl_buffer_set(&v->commands, d->gl, commands, starts[BUCKET_COUNT] * sizeof *commands, 0, err) &&
              draw_buckets(v, d, what, starts, err);
    free(commands);
    return ok;
}
