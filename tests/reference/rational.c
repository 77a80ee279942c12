#include "rational.h"

#include <gmp.h>
#include <stdlib.h>

struct qvec {
    mpq_t x[3];
};

static void qvec_init(struct qvec *v)
{
    for (int i = 0; i < 3; i++)
        mpq_init(v->x[i]);
}

static void qvec_clear(struct qvec *v)
{
    for (int i = 0; i < 3; i++)
        mpq_clear(v->x[i]);
}

static void qvec_set(struct qvec *v, struct dvec3 d)
{
    mpq_set_d(v->x[0], d.x);
    mpq_set_d(v->x[1], d.y);
    mpq_set_d(v->x[2], d.z);
}

static void qvec_minus(struct qvec *r, const struct qvec *a, const struct qvec *b)
{
    for (int i = 0; i < 3; i++)
        mpq_sub(r->x[i], a->x[i], b->x[i]);
}

/* Numbers that functions may use without making their own: allocating is what costs most. */
struct scratch {
    mpq_t left, right, value;
    struct qvec to, edge, m, from;
};

static void qvec_times(struct scratch *s, struct qvec *r, const struct qvec *a, const struct qvec *b)
{
    for (int i = 0; i < 3; i++) {
        mpq_mul(s->left, a->x[(i + 1) % 3], b->x[(i + 2) % 3]);
        mpq_mul(s->right, a->x[(i + 2) % 3], b->x[(i + 1) % 3]);
        mpq_sub(r->x[i], s->left, s->right);
    }
}

static void qvec_inner(struct scratch *s, mpq_t r, const struct qvec *a, const struct qvec *b)
{
    mpq_set_si(r, 0, 1);
    for (int i = 0; i < 3; i++) {
        mpq_mul(s->left, a->x[i], b->x[i]);
        mpq_add(r, r, s->left);
    }
}

/* A drawn triangle. */
struct face {
    uint32_t id, instance, index;
    struct dvec3 corner[3];
    struct qvec q[3], normal;
};

static bool counts(double x) { return x >= -1e18 && x <= 1e18; }

struct rational {
    const struct scene *scene;
    struct face *faces; /* in the order of ids, without those to be ignored */
    size_t count;
    struct scratch scratch;
    struct qvec o, d, apex, point;
    mpq_t t, best;
};

/* False when the triangle is to be ignored. */
static bool face_init(struct scratch *s, struct face *f, const struct scene *scene, uint32_t instance, uint32_t index)
{
    f->id = scene->instances[instance].first_triangle + index;
    f->instance = instance;
    f->index = index;
    for (unsigned k = 0; k < 3; k++) {
        f->corner[k] = instance_vertex(scene, &scene->instances[instance], index, k);
        if (!counts(f->corner[k].x) || !counts(f->corner[k].y) || !counts(f->corner[k].z))
            return false;
    }
    for (int k = 0; k < 3; k++) {
        qvec_init(&f->q[k]);
        qvec_set(&f->q[k], f->corner[k]);
    }
    qvec_init(&f->normal);
    qvec_minus(&s->to, &f->q[1], &f->q[0]);
    qvec_minus(&s->edge, &f->q[2], &f->q[0]);
    qvec_times(s, &f->normal, &s->to, &s->edge);
    return true;
}

struct rational *rational_create(const struct scene *scene)
{
    struct rational *r = calloc(1, sizeof *r);
    struct scratch *s = &r->scratch;
    r->scene = scene;
    r->faces = calloc(scene->drawn_triangle_count + 1, sizeof *r->faces);
    mpq_inits(s->left, s->right, s->value, r->t, r->best, NULL);
    struct qvec *vectors[] = {&s->to, &s->edge, &s->m, &s->from, &r->o, &r->d, &r->apex, &r->point};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        qvec_init(vectors[i]);
    for (uint32_t i = 0; i < scene->instance_count; i++)
        for (uint32_t k = 0; k < scene->meshes[scene->instances[i].mesh].index_count / 3; k++)
            r->count += face_init(s, &r->faces[r->count], scene, i, k);
    return r;
}

void rational_destroy(struct rational *r)
{
    struct scratch *s = &r->scratch;
    for (size_t i = 0; i < r->count; i++) {
        for (int k = 0; k < 3; k++)
            qvec_clear(&r->faces[i].q[k]);
        qvec_clear(&r->faces[i].normal);
    }
    struct qvec *vectors[] = {&s->to, &s->edge, &s->m, &s->from, &r->o, &r->d, &r->apex, &r->point};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        qvec_clear(vectors[i]);
    mpq_clears(s->left, s->right, s->value, r->t, r->best, NULL);
    free(r->faces);
    free(r);
}

static const struct material *face_material(const struct scene *scene, const struct face *f)
{
    return &scene->materials[scene->meshes[scene->instances[f->instance].mesh].material];
}

/* "Crossing": the line's apex (a position, or with `far_away` a direction) and point. */
static int passes(struct scratch *s, const struct qvec *apex, bool far_away, const struct qvec *point, const struct qvec *u,
                  const struct qvec *v)
{
    qvec_minus(&s->to, apex, u);
    qvec_minus(&s->edge, v, u);
    qvec_times(s, &s->m, far_away ? apex : &s->to, &s->edge);
    qvec_minus(&s->from, point, u);
    qvec_inner(s, s->value, &s->m, &s->from);
    int sign = mpq_sgn(s->value);
    for (int i = 0; sign == 0 && i < 3; i++)
        sign = mpq_sgn(s->m.x[i]);
    return sign;
}

static bool crosses(struct scratch *s, const struct qvec *apex, bool far_away, const struct qvec *point, const struct face *f)
{
    int ab = passes(s, apex, far_away, point, &f->q[0], &f->q[1]);
    int bc = passes(s, apex, far_away, point, &f->q[1], &f->q[2]);
    return ab != 0 && ab == bc && ab == passes(s, apex, far_away, point, &f->q[2], &f->q[0]);
}

static int sign_with(struct scratch *s, const struct qvec *normal, const struct qvec *v)
{
    qvec_inner(s, s->value, normal, v);
    return mpq_sgn(s->value);
}

/* "Holes", written out in plain doubles. */
static bool solid(const struct scene *scene, const struct face *f, struct dvec3 s, struct dvec3 r)
{
    const struct mesh *mesh = &scene->meshes[scene->instances[f->instance].mesh];
    const struct material *material = &scene->materials[mesh->material];
    if (material->alpha_mode == ALPHA_OPAQUE)
        return true;
    const struct dvec3 a = f->corner[0], b = f->corner[1], c = f->corner[2];
    double e1x = b.x - a.x, e1y = b.y - a.y, e1z = b.z - a.z, e2x = c.x - a.x, e2y = c.y - a.y, e2z = c.z - a.z;
    double qx = r.y * e2z - r.z * e2y, qy = r.z * e2x - r.x * e2z, qz = r.x * e2y - r.y * e2x;
    double wx = s.x - a.x, wy = s.y - a.y, wz = s.z - a.z;
    double xx = wy * e1z - wz * e1y, xy = wz * e1x - wx * e1z, xz = wx * e1y - wy * e1x;
    double k = e1x * qx + e1y * qy + e1z * qz;
    double w1 = (wx * qx + wy * qy + wz * qz) / k, w2 = (r.x * xx + r.y * xy + r.z * xz) / k, w0 = 1 - w1 - w2;
    float uv[2] = {0, 0};
    uint32_t first = mesh->first_texcoord[material->base_color_texture.texcoord];
    const uint32_t *index = scene->indices + mesh->first_index + 3 * f->index;
    if (material->base_color_texture.texture != SCENE_NONE && first != SCENE_NONE)
        for (int i = 0; i < 2; i++)
            uv[i] = (float)((w0 * (double)scene->texcoords[first + index[0]][i] +
                             w1 * (double)scene->texcoords[first + index[1]][i]) +
                            w2 * (double)scene->texcoords[first + index[2]][i]);
    float alpha = 1;
    if (mesh->first_color != SCENE_NONE)
        alpha = (float)((w0 * (double)scene->colors[mesh->first_color + index[0]][3] +
                         w1 * (double)scene->colors[mesh->first_color + index[1]][3]) +
                        w2 * (double)scene->colors[mesh->first_color + index[2]][3]);
    return material_alpha(scene, material, uv, alpha) >= material->alpha_cutoff;
}

/* t = N . (a - o) / N . d; false when N . d = 0. */
static bool depth_of(struct scratch *s, mpq_t t, const struct face *f, const struct qvec *o, const struct qvec *d)
{
    qvec_minus(&s->to, &f->q[0], o);
    qvec_inner(s, t, &f->normal, &s->to);
    qvec_inner(s, s->value, &f->normal, d);
    if (mpq_sgn(s->value) == 0)
        return false;
    mpq_div(t, t, s->value);
    return true;
}

static bool within(const mpq_t t, double near, double far)
{
    mpq_t limit;
    mpq_init(limit);
    mpq_set_d(limit, near);
    bool ok = mpq_cmp(t, limit) >= 0;
    if (ok && isfinite(far)) {
        mpq_set_d(limit, far);
        ok = mpq_cmp(t, limit) <= 0;
    }
    mpq_clear(limit);
    return ok;
}

static bool is_hidden(struct rational *r, const struct face *f)
{
    int slope = sign_with(&r->scratch, &f->normal, &r->d);
    return !face_material(r->scene, f)->double_sided && (r->scene->instances[f->instance].mirrored ? slope < 0 : slope > 0);
}

uint32_t rational_visible(struct rational *r, const struct view *view, double x, double y)
{
    struct scratch *s = &r->scratch;
    struct dvec3 origin, direction;
    uint32_t found = SCENE_NONE;
    view_ray(view, x, y, &origin, &direction);
    qvec_set(&r->o, origin);
    qvec_set(&r->d, direction);
    for (int i = 0; i < 3; i++)
        mpq_add(r->point.x[i], r->o.x[i], r->d.x[i]);
    for (size_t i = 0; i < r->count; i++) {
        const struct face *f = &r->faces[i];
        bool meets = view->orthographic ? crosses(s, &r->d, true, &r->o, f) : crosses(s, &r->o, false, &r->point, f);
        if (meets && depth_of(s, r->t, f, &r->o, &r->d) && within(r->t, view->near, view->far) && !is_hidden(r, f) &&
            solid(r->scene, f, origin, direction) && (found == SCENE_NONE || mpq_cmp(r->t, r->best) < 0)) {
            mpq_set(r->best, r->t);
            found = f->id;
        }
    }
    return found;
}

/* "Points in double". */
static struct dvec3 rounded_point(const struct face *f, struct dvec3 o, struct dvec3 d)
{
    const struct dvec3 a = f->corner[0], b = f->corner[1], c = f->corner[2];
    double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    double t = (nx * (a.x - o.x) + ny * (a.y - o.y) + nz * (a.z - o.z)) / (nx * d.x + ny * d.y + nz * d.z);
    return dvec3(o.x + d.x * t, o.y + d.y * t, o.z + d.z * t);
}

static bool reached(const struct light *light, struct dvec3 p)
{
    if (light->kind == LIGHT_DIRECTIONAL)
        return true;
    double x = p.x - light->position.x, y = p.y - light->position.y, z = p.z - light->position.z;
    double distance = sqrt(x * x + y * y + z * z);
    if (light->range > 0 && !(distance <= light->range))
        return false;
    return light->kind != LIGHT_SPOT ||
           x * light->direction.x + y * light->direction.y + z * light->direction.z >= cos(light->outer) * distance;
}

/* Sign of N . (light - a) or N . (-l). */
static int light_sign(struct rational *r, const struct face *f, bool far_away)
{
    qvec_minus(&r->scratch.to, &r->apex, &f->q[0]);
    return sign_with(&r->scratch, &f->normal, far_away ? &r->apex : &r->scratch.to);
}

static bool shadowed(struct rational *r, uint32_t own, struct dvec3 rounded, const struct light *light)
{
    struct scratch *s = &r->scratch;
    bool far_away = light->kind == LIGHT_DIRECTIONAL;
    struct dvec3 to = far_away
                          ? dvec3(-light->direction.x, -light->direction.y, -light->direction.z)
                          : dvec3(light->position.x - rounded.x, light->position.y - rounded.y, light->position.z - rounded.z);
    for (size_t i = 0; i < r->count; i++) {
        const struct face *f = &r->faces[i];
        if (f->id == own)
            continue;
        qvec_minus(&s->from, &r->point, &f->q[0]);
        if (sign_with(s, &f->normal, &s->from) * light_sign(r, f, far_away) < 0 && crosses(s, &r->apex, far_away, &r->point, f) &&
            solid(r->scene, f, rounded, to))
            return true;
    }
    return false;
}

enum rational_answer rational_light(struct rational *r, const struct view *view, const struct light *light, uint32_t id, double x,
                                    double y)
{
    const struct face *f = NULL;
    for (size_t i = 0; i < r->count; i++)
        if (r->faces[i].id == id)
            f = &r->faces[i];
    if (!f)
        return RATIONAL_NO_RECEIVER;
    struct dvec3 origin, direction;
    bool far_away = light->kind == LIGHT_DIRECTIONAL;
    view_ray(view, x, y, &origin, &direction);
    qvec_set(&r->o, origin);
    qvec_set(&r->d, direction);
    qvec_set(&r->apex, far_away ? dvec3(-light->direction.x, -light->direction.y, -light->direction.z) : light->position);
    struct dvec3 rounded = rounded_point(f, origin, direction);
    if (!depth_of(&r->scratch, r->t, f, &r->o, &r->d) ||
        sign_with(&r->scratch, &f->normal, &r->d) * light_sign(r, f, far_away) >= 0 || !reached(light, rounded))
        return RATIONAL_NO_RECEIVER;
    for (int i = 0; i < 3; i++) {
        mpq_mul(r->point.x[i], r->d.x[i], r->t);
        mpq_add(r->point.x[i], r->point.x[i], r->o.x[i]);
    }
    return shadowed(r, id, rounded, light) ? RATIONAL_SHADOWED : RATIONAL_LIT;
}
