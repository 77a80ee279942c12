#include "shadow/geometry/light_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/job_pool.h"
#include "trace/hole.h"

enum { CHUNK = 4096 }; /* vertices a job */

static bool out_of_memory(struct error *err)
{
    return error_set(err, ERROR_TRY_AGAIN, "size", "out of memory for a light's triangles");
}

static bool find_parts(struct light_mesh *m, const uint32_t *casters, size_t count, struct error *err)
{
    struct light_part *parts = realloc(m->parts, (count + 1) * sizeof *parts);
    if (!parts)
        return out_of_memory(err);
    m->parts = parts;
    m->part_count = m->vertex_count = m->triangle_count = 0;
    for (size_t k = 0; k < count; k++) {
        const struct instance *instance = &m->scene->instances[casters[k]];
        const struct mesh *mesh = &m->scene->meshes[instance->mesh];
        if (mesh->index_count < 3)
            continue;
        m->parts[m->part_count++] = (struct light_part){.instance = casters[k],
                                                        .first_triangle = instance->first_triangle,
                                                        .triangle_count = mesh->index_count / 3,
                                                        .holes = material_has_holes(&m->scene->materials[mesh->material]),
                                                        .indices = m->scene->indices + mesh->first_index};
        m->vertex_count += mesh->vertex_count;
        m->triangle_count += mesh->index_count / 3;
    }
    return true;
}

static bool reserve_vertices(struct light_mesh *m, struct error *err)
{
    if (m->vertex_room < m->vertex_count) {
        free(m->vertices);
        m->vertex_room = 0;
        m->vertices = malloc(m->vertex_count * sizeof *m->vertices);
        if (!m->vertices)
            return out_of_memory(err);
        m->vertex_room = m->vertex_count;
    }
    size_t first = 0;
    for (size_t k = 0; k < m->part_count; k++) {
        m->parts[k].vertices = m->vertices + first;
        first += m->scene->meshes[m->scene->instances[m->parts[k].instance].mesh].vertex_count;
    }
    return true;
}

/* Rows that take mesh positions to the view's axes. */
struct rows {
    double m[3][4];
};

static struct rows rows_of(const struct light_mesh *m, const struct instance *instance)
{
    const struct dvec3 axes[3] = {m->view.right, m->view.up, m->view.forward};
    const struct affine *a = &instance->to_scene;
    struct dvec3 offset = dvec3_sub(dvec3(a->offset[0], a->offset[1], a->offset[2]), m->view.eye);
    struct rows r;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            r.m[i][j] = dvec3_dot(axes[i], dvec3(a->linear[0][j], a->linear[1][j], a->linear[2][j]));
        r.m[i][3] = dvec3_dot(axes[i], offset);
    }
    return r;
}

static struct light_vertex project(const struct light_mesh *m, double x, double y, double z)
{
    double n = m->view.orthographic ? m->view.far - z : 1 / z, w = m->view.orthographic ? 1 : n;
    double side = m->view.width, u = x * w * m->scale_x + m->offset_x, v = y * w * m->scale_y + m->offset_y;
    bool tame = (m->view.orthographic || z > 0) && fabs(u - side / 2) <= side && fabs(v - side / 2) <= side;
    return (struct light_vertex){tame ? (float)u : NAN, (float)v, (float)n, 0};
}

struct project_job {
    const struct light_mesh *mesh;
    const struct light_part *part;
    struct rows rows;
    const float (*positions)[3];
    uint32_t count;
};

static void project_chunk(void *context, size_t index, unsigned worker)
{
    (void)worker;
    const struct project_job *job = context;
    const double(*r)[4] = job->rows.m;
    size_t first = index * CHUNK, end = first + CHUNK < job->count ? first + CHUNK : job->count;
    for (size_t i = first; i < end; i++) {
        const float *p = job->positions[i];
        double q[3];
        for (int k = 0; k < 3; k++)
            q[k] = r[k][0] * p[0] + r[k][1] * p[1] + r[k][2] * p[2] + r[k][3];
        job->part->vertices[i] = project(job->mesh, q[0], q[1], q[2]);
    }
}

bool light_mesh_project(struct light_mesh *m, const struct scene *scene, const struct view *view, const uint32_t *casters,
                        size_t caster_count, struct job_pool *pool, struct error *err)
{
    m->scene = scene;
    m->view = *view;
    m->scale_x = view->width / (view->right_edge - view->left);
    m->scale_y = -(view->height / (view->top - view->bottom));
    m->offset_x = -view->left * m->scale_x;
    m->offset_y = -view->top * m->scale_y;
    m->nearest = (float)(view->orthographic ? view->far - view->near : 1 / view->near);
    m->rounding = view->orthographic ? (float)((view->far - view->near + fabs(view->far)) * 0x1p-20) : 0;
    if (!find_parts(m, casters, caster_count, err) || !reserve_vertices(m, err))
        return false;
    for (size_t k = 0; k < m->part_count; k++) {
        const struct instance *instance = &scene->instances[m->parts[k].instance];
        const struct mesh *mesh = &scene->meshes[instance->mesh];
        struct project_job job = {m, &m->parts[k], rows_of(m, instance), (const float(*)[3])scene->positions + mesh->first_vertex,
                                  mesh->vertex_count};
        job_pool_for(pool, (mesh->vertex_count + CHUNK - 1) / CHUNK, project_chunk, &job);
    }
    return true;
}

void light_mesh_finish(struct light_mesh *m)
{
    free(m->parts);
    free(m->vertices);
    memset(m, 0, sizeof *m);
}

size_t light_mesh_bytes(const struct light_mesh *m)
{
    return m->vertex_room * sizeof *m->vertices + m->part_count * sizeof *m->parts;
}

struct dvec3 light_part_corner(const struct light_mesh *m, const struct light_part *part, uint32_t id, unsigned k)
{
    struct dvec3 p = instance_vertex(m->scene, &m->scene->instances[part->instance], id - part->first_triangle, k);
    struct dvec3 d = dvec3_sub(p, m->view.eye);
    return dvec3(dvec3_dot(d, m->view.right), dvec3_dot(d, m->view.up), dvec3_dot(d, m->view.forward));
}

bool light_corners_miss(const struct light_mesh *m, const struct dvec3 corners[3], double left, double top, double right,
                        double bottom)
{
    bool beyond[4] = {true, true, true, true}, behind = !m->view.orthographic;
    for (int k = 0; k < 3; k++) {
        double w = m->view.orthographic ? 1 : corners[k].z;
        double x = corners[k].x * m->scale_x + m->offset_x * w, y = corners[k].y * m->scale_y + m->offset_y * w;
        beyond[0] &= x < (left - 1) * w;
        beyond[1] &= x > (right + 1) * w;
        beyond[2] &= y < (top - 1) * w;
        beyond[3] &= y > (bottom + 1) * w;
        behind &= corners[k].z <= 0;
    }
    return behind || beyond[0] || beyond[1] || beyond[2] || beyond[3];
}

/* Of a wild triangle, by the volumes that the direction through (x, y) spans with each edge: right for corners behind the light too (Olano and
 * Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates"). e[k] belongs to corner k. */
static void wild_volumes(const struct light_mesh *m, const struct dvec3 c[3], float x, float y, double e[3])
{
    double px = (x - m->offset_x) / m->scale_x, py = (y - m->offset_y) / m->scale_y;
    for (int k = 0; k < 3; k++) {
        struct dvec3 a = c[(k + 1) % 3], b = c[(k + 2) % 3];
        if (m->view.orthographic)
            e[k] = (a.x - px) * (b.y - py) - (a.y - py) * (b.x - px);
        else
            e[k] = dvec3_dot(dvec3_cross(a, b), dvec3(px, py, 1));
    }
}

static void wild_corners(const struct light_mesh *m, const struct light_part *part, uint32_t id, struct dvec3 c[3])
{
    for (unsigned k = 0; k < 3; k++)
        c[k] = light_part_corner(m, part, id, k);
}

bool light_wild_hit(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y,
                    struct light_hit *out)
{
    struct dvec3 c[3];
    double e[3];
    wild_corners(m, part, id, c);
    wild_volumes(m, c, x, y, e);
    double sum = e[0] + e[1] + e[2], depth = (e[0] * c[0].z + e[1] * c[1].z + e[2] * c[2].z) / sum;
    bool inside = (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
    if (!inside || sum == 0 || (!m->view.orthographic && !(depth > 0)))
        return false;
    out->n = (float)(m->view.orthographic ? m->view.far - depth : 1 / depth);
    for (int k = 0; k < 3; k++)
        out->weight[k] = (float)(e[k] / sum);
    return true;
}

static struct light_sides wild_sides(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y)
{
    struct dvec3 c[3];
    double e[3];
    wild_corners(m, part, id, c);
    wild_volumes(m, c, x, y, e);
    /* A map mirrors y: what turns one way in space turns the other way there. */
    double volume = m->view.orthographic ? e[0] + e[1] + e[2] : dvec3_dot(c[0], dvec3_cross(c[1], c[2]));
    struct light_sides s = {.area = -volume};
    for (int k = 0; k < 3; k++)
        s.edge[k] = volume < 0 ? -e[(k + 2) % 3] : e[(k + 2) % 3];
    return s;
}

struct light_sides light_triangle_sides(const struct light_mesh *m, const struct light_part *part, uint32_t id, float px,
                                        float py)
{
    struct light_triangle t = light_part_triangle(part, id);
    if (light_triangle_wild(&t))
        return wild_sides(m, part, id, px, py);
    struct light_sides s;
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = (double)t.corner[k]->x - px;
        y[k] = (double)t.corner[k]->y - py;
    }
    s.area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    for (int k = 0; k < 3; k++) {
        int j = k == 2 ? 0 : k + 1;
        double edge = x[k] * y[j] - x[j] * y[k];
        s.edge[k] = s.area < 0 ? -edge : edge;
    }
    return s;
}

bool light_triangle_solid_hit(const struct light_mesh *m, const struct light_part *part, uint32_t id, float x, float y,
                              struct light_hit *out)
{
    return light_triangle_hit(m, part, id, x, y, out) &&
           (!part->holes || hole_is_solid(m->scene, part->instance, id - part->first_triangle, out->weight[1], out->weight[2]));
}

/* Products of differences of floats fit a double, so equality of products is exact; differences too unless their exponents lie far apart. */
bool light_part_degenerate(const struct scene *scene, const struct light_part *part, uint32_t id)
{
    const uint32_t *index = part->indices + 3 * (size_t)(id - part->first_triangle);
    const float(*p)[3] = (const float(*)[3])scene->positions + scene->meshes[scene->instances[part->instance].mesh].first_vertex;
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)p[index[1]][k] - p[index[0]][k];
        v[k] = (double)p[index[2]][k] - p[index[0]][k];
    }
    for (int k = 0; k < 3; k++)
        if (!isfinite(u[k]) || !isfinite(v[k]))
            return true;
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}
