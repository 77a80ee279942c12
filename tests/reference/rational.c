#include "rational.h"

#include <gmp.h>
#include <string.h>

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

static void qvec_times(struct qvec *r, const struct qvec *a, const struct qvec *b)
{
    mpq_t left, right;
    mpq_inits(left, right, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_mul(left, a->x[(i + 1) % 3], b->x[(i + 2) % 3]);
        mpq_mul(right, a->x[(i + 2) % 3], b->x[(i + 1) % 3]);
        mpq_sub(r->x[i], left, right);
    }
    mpq_clears(left, right, NULL);
}

static void qvec_inner(mpq_t r, const struct qvec *a, const struct qvec *b)
{
    mpq_t product;
    mpq_init(product);
    mpq_set_si(r, 0, 1);
    for (int i = 0; i < 3; i++) {
        mpq_mul(product, a->x[i], b->x[i]);
        mpq_add(r, r, product);
    }
    mpq_clear(product);
}

/* A drawn triangle. */
struct face {
    uint32_t id, instance, index;
    struct dvec3 corner[3];
    struct qvec q[3], normal;
};

static bool counts(double x) { return x >= -1e18 && x <= 1e18; }

/* False (and nothing to clear) for ids past the end and for triangles that are ignored. */
static bool face_init(struct face *f, const struct scene *scene, uint32_t id)
{
    struct qvec u, v;
    f->id = id;
    f->instance = 0;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        uint32_t first = scene->instances[i].first_triangle;
        if (id >= first && id - first < scene->meshes[scene->instances[i].mesh].index_count / 3)
            f->instance = i;
    }
    f->index = id - scene->instances[f->instance].first_triangle;
    for (unsigned k = 0; k < 3; k++) {
        f->corner[k] = instance_vertex(scene, &scene->instances[f->instance], f->index, k);
        if (!counts(f->corner[k].x) || !counts(f->corner[k].y) || !counts(f->corner[k].z))
            return false;
    }
    for (int k = 0; k < 3; k++) {
        qvec_init(&f->q[k]);
        qvec_set(&f->q[k], f->corner[k]);
    }
    qvec_init(&f->normal);
    qvec_init(&u);
    qvec_init(&v);
    qvec_minus(&u, &f->q[1], &f->q[0]);
    qvec_minus(&v, &f->q[2], &f->q[0]);
    qvec_times(&f->normal, &u, &v);
    qvec_clear(&u);
    qvec_clear(&v);
    return true;
}

static void face_clear(struct face *f)
{
    for (int k = 0; k < 3; k++)
        qvec_clear(&f->q[k]);
    qvec_clear(&f->normal);
}

static const struct material *face_material(const struct scene *scene, const struct face *f)
{
    return &scene->materials[scene->meshes[scene->instances[f->instance].mesh].material];
}

/* "Crossing": the line's apex (a position, or with `far_away` a direction) and point. */
static int passes(const struct qvec *apex, bool far_away, const struct qvec *point, const struct qvec *u, const struct qvec *v)
{
    struct qvec to, edge, m, from;
    mpq_t value;
    qvec_init(&to);
    qvec_init(&edge);
    qvec_init(&m);
    qvec_init(&from);
    mpq_init(value);
    qvec_minus(&to, apex, u);
    qvec_minus(&edge, v, u);
    qvec_times(&m, far_away ? apex : &to, &edge);
    qvec_minus(&from, point, u);
    qvec_inner(value, &m, &from);
    int sign = mpq_sgn(value);
    for (int i = 0; sign == 0 && i < 3; i++)
        sign = mpq_sgn(m.x[i]);
    mpq_clear(value);
    qvec_clear(&from);
    qvec_clear(&m);
    qvec_clear(&edge);
    qvec_clear(&to);
    return sign;
}

static bool crosses(const struct qvec *apex, bool far_away, const struct qvec *point, const struct face *f)
{
    int ab = passes(apex, far_away, point, &f->q[0], &f->q[1]);
    int bc = passes(apex, far_away, point, &f->q[1], &f->q[2]);
    int ca = passes(apex, far_away, point, &f->q[2], &f->q[0]);
    return ab != 0 && ab == bc && bc == ca;
}

static int sign_with(const struct qvec *normal, const struct qvec *v)
{
    mpq_t value;
    mpq_init(value);
    qvec_inner(value, normal, v);
    int sign = mpq_sgn(value);
    mpq_clear(value);
    return sign;
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
            uv[i] = (float)((w0 * (double)scene->texcoords[first + index[0]][i] + w1 * (double)scene->texcoords[first + index[1]][i]) +
                            w2 * (double)scene->texcoords[first + index[2]][i]);
    float alpha = 1;
    if (mesh->first_color != SCENE_NONE)
        alpha = (float)((w0 * (double)scene->colors[mesh->first_color + index[0]][3] +
                         w1 * (double)scene->colors[mesh->first_color + index[1]][3]) +
                        w2 * (double)scene->colors[mesh->first_color + index[2]][3]);
    return material_alpha(scene, material, uv, alpha) >= material->alpha_cutoff;
}

/* t = N . (a - o) / N . d; false when N . d = 0. */
static bool depth_of(mpq_t t, const struct face *f, const struct qvec *o, const struct qvec *d)
{
    struct qvec to;
    mpq_t slope;
    qvec_init(&to);
    mpq_init(slope);
    qvec_minus(&to, &f->q[0], o);
    qvec_inner(t, &f->normal, &to);
    qvec_inner(slope, &f->normal, d);
    bool ok = mpq_sgn(slope) != 0;
    if (ok)
        mpq_div(t, t, slope);
    mpq_clear(slope);
    qvec_clear(&to);
    return ok;
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

static bool is_hidden(const struct scene *scene, const struct face *f, const struct qvec *d)
{
    int slope = sign_with(&f->normal, d);
    return !face_material(scene, f)->double_sided && (scene->instances[f->instance].mirrored ? slope < 0 : slope > 0);
}

uint32_t rational_visible(const struct scene *scene, const struct view *view, double x, double y)
{
    struct dvec3 origin, direction;
    struct qvec o, d, point;
    mpq_t t, best;
    uint32_t found = SCENE_NONE;
    view_ray(view, x, y, &origin, &direction);
    qvec_init(&o);
    qvec_init(&d);
    qvec_init(&point);
    mpq_inits(t, best, NULL);
    qvec_set(&o, origin);
    qvec_set(&d, direction);
    for (int i = 0; i < 3; i++)
        mpq_add(point.x[i], o.x[i], d.x[i]);
    for (uint32_t id = 0; id < scene->drawn_triangle_count; id++) {
        struct face f;
        if (!face_init(&f, scene, id))
            continue;
        bool meets = view->orthographic ? crosses(&d, true, &o, &f) : crosses(&o, false, &point, &f);
        if (meets && depth_of(t, &f, &o, &d) && within(t, view->near, view->far) && !is_hidden(scene, &f, &d) &&
            solid(scene, &f, origin, direction) && (found == SCENE_NONE || mpq_cmp(t, best) < 0)) {
            mpq_set(best, t);
            found = id;
        }
        face_clear(&f);
    }
    mpq_clears(t, best, NULL);
    qvec_clear(&point);
    qvec_clear(&d);
    qvec_clear(&o);
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
static int light_sign(const struct face *f, const struct qvec *light, bool far_away)
{
    struct qvec to;
    qvec_init(&to);
    qvec_minus(&to, light, &f->q[0]);
    int sign = sign_with(&f->normal, far_away ? light : &to);
    qvec_clear(&to);
    return sign;
}

static bool shadowed(const struct scene *scene, uint32_t own, const struct qvec *point, struct dvec3 rounded, const struct light *light,
                     const struct qvec *apex)
{
    bool far_away = light->kind == LIGHT_DIRECTIONAL, dark = false;
    struct dvec3 to = far_away ? dvec3(-light->direction.x, -light->direction.y, -light->direction.z)
                               : dvec3(light->position.x - rounded.x, light->position.y - rounded.y, light->position.z - rounded.z);
    struct qvec from;
    qvec_init(&from);
    for (uint32_t id = 0; id < scene->drawn_triangle_count && !dark; id++) {
        struct face f;
        if (id == own || !face_init(&f, scene, id))
            continue;
        qvec_minus(&from, point, &f.q[0]);
        dark = sign_with(&f.normal, &from) * light_sign(&f, apex, far_away) < 0 && crosses(apex, far_away, point, &f) &&
               solid(scene, &f, rounded, to);
        face_clear(&f);
    }
    qvec_clear(&from);
    return dark;
}

enum rational_answer rational_light(const struct scene *scene, const struct view *view, const struct light *light, uint32_t id, double x,
                                    double y)
{
    struct face f;
    if (id == SCENE_NONE || !face_init(&f, scene, id))
        return RATIONAL_NO_RECEIVER;
    struct dvec3 origin, direction;
    struct qvec o, d, apex, point;
    mpq_t t;
    enum rational_answer answer = RATIONAL_NO_RECEIVER;
    bool far_away = light->kind == LIGHT_DIRECTIONAL;
    view_ray(view, x, y, &origin, &direction);
    qvec_init(&o);
    qvec_init(&d);
    qvec_init(&apex);
    qvec_init(&point);
    mpq_init(t);
    qvec_set(&o, origin);
    qvec_set(&d, direction);
    qvec_set(&apex, far_away ? dvec3(-light->direction.x, -light->direction.y, -light->direction.z) : light->position);
    struct dvec3 rounded = rounded_point(&f, origin, direction);
    if (depth_of(t, &f, &o, &d) && sign_with(&f.normal, &d) * light_sign(&f, &apex, far_away) < 0 && reached(light, rounded)) {
        for (int i = 0; i < 3; i++) {
            mpq_mul(point.x[i], d.x[i], t);
            mpq_add(point.x[i], point.x[i], o.x[i]);
        }
        answer = shadowed(scene, id, &point, rounded, light, &apex) ? RATIONAL_SHADOWED : RATIONAL_LIT;
    }
    mpq_clear(t);
    qvec_clear(&point);
    qvec_clear(&apex);
    qvec_clear(&d);
    qvec_clear(&o);
    face_clear(&f);
    return answer;
}
