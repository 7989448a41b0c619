/* SPDX-License-Identifier: Apache-2.0 */
#include "reference.h"

#include <complex.h>
#include <math.h>

typedef long double real;
typedef struct vec {
  real x, y, z;
} vec;

static const real pi = 3.14159265358979323846264338327950288L;

static real dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec scale(vec a, real s) {
  return (vec){a.x * s, a.y * s, a.z * s};
}
static vec minus(vec a, vec b) {
  return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static vec plus(vec a, vec b) {
  return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
static real length(vec a) {
  return hypotl(hypotl(a.x, a.y), a.z);
}
static vec unit(vec a) {
  return scale(a, 1 / length(a));
}

/* 1 when v can be made unit. */
static int usable(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) &&
         (v[0] != 0 || v[1] != 0 || v[2] != 0);
}

static vec direction(const double v[3]) {
  return unit((vec){v[0], v[1], v[2]});
}

/* The perturbed normal; below the horizon it is lifted to z = 1e-4. */
static vec normal(const double v[3]) {
  vec n = direction(v);
  if (n.z <= 0) {
    n.z = 1e-4L;
    n = unit(n);
  }
  return n;
}

static real within(real x, real low, real high) {
  return x < low ? low : x > high ? high : x;
}

static vec in_frame(vec x, vec y, vec z, vec h) {
  return (vec){dot(x, h), dot(y, h), dot(z, h)};
}

static int grooves_along_y(const shade_params *p) {
  if (p->groove != SHADE_GROOVE_AUTO)
    return p->groove == SHADE_GROOVE_Y;
  return p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? p->ey > p->ex : p->ay < p->ax;
}

/* What `auto` stands for. */
static shade_detail method_of(const shade_params *p) {
  if (p->detail != SHADE_DETAIL_AUTO)
    return p->detail;
  int round = p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? p->ex == p->ey : p->ax == p->ay;
  return round ? SHADE_DETAIL_PERTURB : SHADE_DETAIL_ROTATE;
}

static int conserves(shade_detail detail) {
  return detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING ||
         detail == SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING;
}

static int is_warp(shade_detail detail) {
  return detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_SMOOTH ||
         conserves(detail);
}

/*
 * The warp of the unit disc; z = 0 stands for outside. With delta and p' the projections
 * of n and h, w = |R - p'|/|R - C'| where R is the rim point on the ray from C' = delta
 * through p'.
 */
static vec warped(shade_detail detail, vec n, vec h) {
  vec delta = {n.x, n.y, 0}, away = {h.x - n.x, h.y - n.y, 0};
  real a = dot(away, away), b = dot(delta, away), c = n.z * n.z;
  real w = 1 - (b + sqrtl(b * b + a * c)) / c;
  if (w < 0)
    w = 0;
  int linear =
      detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING;
  real shift = linear ? w : sqrtl(w);
  vec p = {h.x - shift * n.x, h.y - shift * n.y, 0};
  real zz = 1 - dot(p, p);
  if (h.z <= 0 || zz <= 0 || w <= 0)
    return p;
  p.z = sqrtl(zz);
  return p;
}

/* T^-1 h: h as the unmoved distribution sees it. */
static vec carried_by(shade_detail detail, const shade_params *p, vec n, vec h) {
  const vec ex = {1, 0, 0}, ey = {0, 1, 0}, ez = {0, 0, 1};
  switch (detail) {
  case SHADE_DETAIL_NONE:
    return in_frame(ex, ey, ez, h);
  case SHADE_DETAIL_PERTURB: {
    /* the angle to n from its sine and cosine: acos would lose digits near 0 */
    real theta = atan2l(length(cross(n, h)), dot(n, h));
    real phi = h.x == 0 && h.y == 0 ? pi / 4 : atan2l(h.y, h.x);
    return (vec){sinl(theta) * cosl(phi), sinl(theta) * sinl(phi), cosl(theta)};
  }
  case SHADE_DETAIL_GRAM_SCHMIDT: {
    vec x = unit(minus(ex, scale(n, n.x)));
    return in_frame(x, cross(n, x), n, h);
  }
  case SHADE_DETAIL_SHORTEST_ARC: { /* the rotation from z to n is that about z x n */
    vec axis = cross(ez, n);
    real s = length(axis);
    if (s == 0)
      return h;
    vec u = scale(axis, 1 / s), v = cross(ez, u); /* u, v, z turn into u, n x u, n */
    vec turned = in_frame(u, cross(n, u), n, h);
    return plus(plus(scale(u, turned.x), scale(v, turned.y)), scale(ez, turned.z));
  }
  case SHADE_DETAIL_ROTATE_APPROXIMATE:
    if (grooves_along_y(p))
      return (vec){h.x - n.x * dot(n, h), n.z * h.y - n.y * h.z, dot(n, h)};
    return (vec){n.z * h.x - n.x * h.z, h.y - n.y * dot(n, h), dot(n, h)};
  case SHADE_DETAIL_DEFORM_LINEAR:
  case SHADE_DETAIL_DEFORM_SMOOTH:
  case SHADE_DETAIL_DEFORM_LINEAR_CONSERVING:
  case SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING:
    return warped(detail, n, h);
  case SHADE_DETAIL_ROTATE:
  default: {
    if (grooves_along_y(p)) { /* y' = dP/dv of the height field */
      vec y = unit((vec){0, n.z, -n.y});
      return in_frame(cross(y, n), y, n, h);
    }
    vec x = unit((vec){n.z, 0, -n.x}); /* x' = dP/du */
    return in_frame(x, cross(n, x), n, h);
  }
  }
}

static vec carried(const shade_params *p, vec n, vec h) {
  return carried_by(method_of(p), p, n, h);
}

static real square(real x) {
  return x * x;
}

/*
 * How much the warp stretches areas of the disc at h, by complex steps: moving x (or y) by i
 * times an amount that no sum notices leaves the derivative, to the last digit, in the
 * imaginary part of every analytic expression; nothing is subtracted.
 */
static real stretch(shade_detail detail, vec n, vec h) {
  const real step = 1e-40L;
  int linear =
      detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING;
  real slope[2][2];
  for (int along = 0; along < 2; along++) {
    long double complex x = h.x, y = h.y;
    if (along == 0)
      x += I * step;
    else
      y += I * step;
    long double complex awayx = x - n.x, awayy = y - n.y;
    long double complex a = awayx * awayx + awayy * awayy, b = n.x * awayx + n.y * awayy;
    long double complex w = 1 - (b + csqrtl(b * b + a * n.z * n.z)) / (n.z * n.z);
    long double complex shift = linear ? w : csqrtl(w);
    slope[along][0] = cimagl(x - shift * n.x) / step;
    slope[along][1] = cimagl(y - shift * n.y) / step;
  }
  return slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
}

static real unconserved(const shade_params *p, vec n, vec h);

static real distribution(const shade_params *p, vec n, vec h) {
  real d = unconserved(p, n, h);
  if (!conserves(p->detail) || d == 0)
    return d;
  int projected = p->mdf == SHADE_MDF_BECKMANN || p->mdf == SHADE_MDF_GGX;
  real cosine = projected ? dot(n, h) : warped(p->detail, n, h).z;
  if (h.x == n.x && h.y == n.y)
    return d * h.z / cosine;
  return cosine > 0 ? d * stretch(p->detail, n, h) * h.z / cosine : 0;
}

static real unconserved(const shade_params *p, vec n, vec h) {
  real ex = within(p->ex, 0, 1e6L), ey = within(p->ey, 0, 1e6L);
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  vec m = carried(p, n, h);
  if (m.z <= 0)
    return 0;
  real ward_peak = 1 / (pi * ax * ay);
  switch (p->mdf) {
  case SHADE_MDF_WARD:
    return ward_peak * expl(-(square(m.x / ax) + square(m.y / ay)) / square(m.z));
  case SHADE_MDF_WARD_HALF:
    return ward_peak * expl(-2 * (square(m.x / ax) + square(m.y / ay)) / (1 + m.z));
  case SHADE_MDF_BECKMANN:
    return ward_peak * expl(-(square(m.x / ax) + square(m.y / ay)) / square(m.z)) /
           square(square(m.z));
  case SHADE_MDF_GGX:
    return ward_peak / square(square(m.x / ax) + square(m.y / ay) + square(m.z));
  case SHADE_MDF_ASHIKHMIN_SHIRLEY:
  default: {
    real sin2 = square(m.x) + square(m.y);
    real exponent = sin2 > 0 ? (ex * square(m.x) + ey * square(m.y)) / sin2 : 0;
    return sqrtl((ex + 1) * (ey + 1)) / (2 * pi) * powl(m.z, exponent);
  }
  }
}

/* Smith's Lambda of w, whose theta and phi are those of the carried frame. */
static real lambda(const shade_params *p, vec n, vec w) {
  shade_detail detail = method_of(p);
  vec m = carried_by(is_warp(detail) ? SHADE_DETAIL_PERTURB : detail, p, n, w);
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  if (p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    ax = sqrtl(2 / (within(p->ex, 0, 1e6L) + 2));
    ay = sqrtl(2 / (within(p->ey, 0, 1e6L) + 2));
  }
  real slope = hypotl(ax * m.x, ay * m.y); /* alpha(phi) sin theta */
  if (slope == 0)
    return 0;
  real a = m.z / slope;
  if (p->mdf == SHADE_MDF_GGX)
    return (sqrtl(1 + 1 / (a * a)) - 1) / 2;
  return expl(-a * a) / (2 * a * sqrtl(pi)) - erfcl(a) / 2;
}

static real at_least(real x) {
  return x > 1e-20L ? x : 1e-20L;
}

static real brdf(const shade_params *p, vec n, vec wi, vec wo, real cosi, real coso, real d) {
  vec sum = plus(wi, wo);
  real hwo = dot(unit(sum), wo);
  switch (p->brdf) {
  case SHADE_BRDF_WARD_1992:
    return d / at_least(4 * sqrtl(cosi * coso));
  case SHADE_BRDF_WARD_DUR:
    return d / at_least(4 * cosi * coso);
  case SHADE_BRDF_WARD_BOUNDED:
    return d * dot(sum, sum) / at_least(powl(cosi + coso, 4));
  case SHADE_BRDF_MICROFACET: {
    real shadowing = 1 / (1 + lambda(p, n, wi) + lambda(p, n, wo));
    return d * shadowing / at_least(4 * cosi * coso);
  }
  case SHADE_BRDF_ASHIKHMIN_SHIRLEY:
  default:
    return d / at_least(4 * hwo * (cosi > coso ? cosi : coso));
  }
}

/* The warps take directions as they are where these are nearly unit. */
static vec as_given(const shade_params *p, const double v[3], vec made_unit) {
  vec raw = {v[0], v[1], v[2]};
  return is_warp(p->detail) && fabsl(dot(raw, raw) - 1) < 1e-3L && v[2] > 0 ? raw : made_unit;
}

double shade_ref_mdf(const shade_params *p, const double n[3], const double h[3]) {
  if (!usable(n) || !usable(h))
    return 0;
  return (double)distribution(p, as_given(p, n, normal(n)), as_given(p, h, direction(h)));
}

void shade_ref_carried(const shade_params *p, const double n[3], const double h[3], double m[3]) {
  vec v = carried(p, as_given(p, n, normal(n)), as_given(p, h, direction(h)));
  m[0] = (double)v.x;
  m[1] = (double)v.y;
  m[2] = (double)v.z;
}

/* Channel c of Fresnel's reflectance; the conductor's from its complex amplitudes. */
static real fresnel(const shade_params *p, int c, real cosine) {
  real f0 = within(p->f0[c], 0, 1), f = f0 + (1 - f0) * powl(1 - cosine, 5);
  switch (p->fresnel) {
  case SHADE_FRESNEL_SCHLICK:
    return f;
  case SHADE_FRESNEL_F82: {
    real at = 1 / 7.0L, here = f0 + (1 - f0) * powl(1 - at, 5);
    real b = here * (1 - within(p->f82[c], 0, 1)) / (at * powl(1 - at, 6));
    f -= b * cosine * powl(1 - cosine, 6);
    return f > 0 ? f : 0;
  }
  case SHADE_FRESNEL_CONDUCTOR: {
    long double complex m = within(p->eta[c], 1e-3L, 100) + I * within(p->k[c], 0, 100);
    long double complex inside = csqrtl(1 - (1 - cosine * cosine) / (m * m)); /* cos within */
    real s = cabsl((cosine - m * inside) / (cosine + m * inside));
    real q = cabsl((m * cosine - inside) / (m * cosine + inside));
    return (s * s + q * q) / 2;
  }
  case SHADE_FRESNEL_NONE:
  default:
    return f0;
  }
}

/* ---- fibres: x along, y across, z the normal; theta from z towards y ------------- */

typedef struct arc {
  real from, to;
} arc;

static arc both(arc a, arc b) {
  return (arc){a.from > b.from ? a.from : b.from, a.to < b.to ? a.to : b.to};
}

/* What faces w of a fibre of unit radius, upper half only. */
static arc facing(vec w) {
  real at = atan2l(w.y, w.z);
  return both((arc){at - pi / 2, at + pi / 2}, (arc){-pi / 2, pi / 2});
}

/*
 * What faces w and sees past the touching neighbours: the line from theta towards w passes
 * the centre of the next fibre, two radii away, at the distance 2 cos(at) - sin(theta - at),
 * which must be 1 at least.
 */
static arc past_neighbours(vec w) {
  real at = atan2l(w.y, w.z), side = fabsl(at);
  real room = 2 * cosl(side) - 1;
  arc free = {-pi / 2, side + asinl(room < 1 ? room : 1)};
  arc a = both(facing((vec){w.x, fabsl(w.y), w.z}), free);
  return at < 0 ? (arc){-a.to, -a.from} : a;
}

/* The integral of (n'.a)(n'.b) over an arc, b NULL standing for 1: 16 times Gauss's 5 points. */
static real over_arc(arc on, vec a, const vec *b) {
  enum { PANELS = 16 };
  const real near = sqrtl(5 - 2 * sqrtl(10 / 7.0L)) / 3, far = sqrtl(5 + 2 * sqrtl(10 / 7.0L)) / 3;
  const real heavy = (322 + 13 * sqrtl(70)) / 900, light = (322 - 13 * sqrtl(70)) / 900;
  const real nodes[] = {-far, -near, 0, near, far};
  const real weights[] = {light, heavy, 128 / 225.0L, heavy, light};
  if (on.to <= on.from)
    return 0;
  real sum = 0, half = (on.to - on.from) / (2 * PANELS);
  for (int i = 0; i < 5 * PANELS; i++) {
    real theta = on.from + half * (2 * (i / 5) + 1 + nodes[i % 5]);
    vec n = {0, sinl(theta), cosl(theta)};
    sum += weights[i % 5] * dot(n, a) * (b ? dot(n, *b) : 1);
  }
  return sum * half;
}

/* Phi of unit l and v above the horizon. */
static real diffuse(shade_diffuse model, vec l, vec v) {
  if (hypotl(v.y, v.z) < 1e-15L) /* along the fibre: as seen from above */
    v = (vec){0, 0, 1};
  switch (model) {
  case SHADE_DIFFUSE_MAX_NORMAL: {
    /* of all the fibre's normals, the one in the plane of fibre and light */
    vec t = {1, 0, 0}, across = minus(l, scale(t, dot(l, t)));
    return length(across) > 0 ? dot(l, unit(across)) : 0;
  }
  case SHADE_DIFFUSE_FIBRE:
    return over_arc(facing(l), l, NULL) / pi;
  case SHADE_DIFFUSE_FIBRE_VIEW:
    return over_arc(both(facing(l), facing(v)), l, &v) / over_arc(facing(v), v, NULL);
  case SHADE_DIFFUSE_POULIN_FOURNIER: {
    arc seen = past_neighbours(v);
    real whole = over_arc(seen, v, NULL);
    return whole > 0 ? over_arc(both(past_neighbours(l), seen), l, &v) / whole : 0;
  }
  case SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY:
    return 28 / 23.0L * (1 - powl(1 - l.z / 2, 5)) * (1 - powl(1 - v.z / 2, 5)) * l.z;
  case SHADE_DIFFUSE_LAMBERT:
  default:
    return l.z;
  }
}

double shade_ref_diffuse(shade_diffuse model, const double l_in[3], const double v_in[3]) {
  const double up[3] = {0, 0, 1};
  int sees = model >= SHADE_DIFFUSE_FIBRE_VIEW;
  if (!usable(l_in) || !usable(sees ? v_in : up))
    return 0;
  vec l = direction(l_in), v = direction(sees ? v_in : up);
  return l.z > 0 && v.z > 0 ? (double)diffuse(model, l, v) : 0;
}

/* Channel c of the material's diffuse part times the cosine: fibres along the groove. */
static real diffuse_part(const shade_params *p, int c, vec n, vec wi, vec wo) {
  real kd = within(p->kd[c], 0, 1);
  shade_params q = *p;
  q.detail = p->detail == SHADE_DETAIL_NONE ? SHADE_DETAIL_NONE : SHADE_DETAIL_ROTATE;
  vec l = carried(&q, n, wi), v = carried(&q, n, wo);
  if (grooves_along_y(p)) {
    l = (vec){l.y, l.x, l.z};
    v = (vec){v.y, v.x, v.z};
  }
  /* the library has no neighbours */
  shade_diffuse model =
      p->diffuse == SHADE_DIFFUSE_POULIN_FOURNIER ? SHADE_DIFFUSE_FIBRE_VIEW : p->diffuse;
  if (model == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY)
    kd *= 1 - within(p->f0[c], 0, 1);
  return kd > 0 ? kd * diffuse(model, l, v) / pi : 0;
}

/*
 * f and its cosine by the rule of `hard`. `lobe_n` is n as the distribution takes it.
 * Returns status bits.
 */
static unsigned hard(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3],
                     real *cosine) {
  vec pole = p->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  real cosi = dot(pole, wi), coso = dot(pole, wo);
  f[0] = f[1] = f[2] = 0;
  *cosine = cosi > 0 ? cosi : 0;
  unsigned status = length(plus(wi, wo)) <= 1e-15L ? SHADE_BAD_INPUT : SHADE_OK;
  if (cosi <= 0 || coso <= 0 || wi.z <= 0 || wo.z <= 0)
    return status;
  vec h = unit(plus(wi, wo));
  real hwo = dot(h, wo);
  real d = distribution(p, lobe_n, h);
  real lobe = brdf(p, n, wi, wo, cosi, coso, d);
  for (int i = 0; i < 3; i++)
    f[i] = fresnel(p, i, hwo) * lobe + diffuse_part(p, i, n, wi, wo) / at_least(cosi);
  return status;
}

/* ---- near the perturbed horizon ----------------------------------------------------- */

static vec mirrored(vec w, vec m) {
  return minus(scale(m, 2 * dot(m, w)), w);
}

/*
 * In the plane of z and n, the image of wo under a normal at angle theta from z has
 * z = rho cos(2 theta - phi), where (rho, phi) is wo in that plane: solved for z = t.
 */
static vec bent(vec n, vec wo) {
  real t = 0.9L * wo.z < 0.01L ? 0.9L * wo.z : 0.01L;
  if (wo.z <= 0 || (n.x == 0 && n.y == 0) || mirrored(wo, n).z >= t)
    return n;
  vec x = unit((vec){n.x, n.y, 0});
  real phi = atan2l(dot(x, wo), wo.z), rho = hypotl(dot(x, wo), wo.z);
  real theta = (phi + acosl(t / rho)) / 2;
  return plus(scale(x, sinl(theta)), (vec){0, 0, cosl(theta)});
}

static int bends(shade_horizon horizon) {
  return horizon == SHADE_HORIZON_VALID_REFLECTION || horizon == SHADE_HORIZON_VALID_ESTEVEZ;
}

/* Facets of a surface that is flat as a whole: the bumped one and the upright one. */
typedef struct facets {
  vec normal[2];
  real area[2]; /* a patch of unit area has the sum of area * normal = z */
} facets;
enum { BUMPED, UPRIGHT };

static facets facets_of(vec n) {
  real side = hypotl(n.x, n.y);
  facets s = {{n, {0, 0, 0}}, {1 / n.z, side / n.z}};
  if (side > 0)
    s.normal[UPRIGHT] = (vec){-n.x / side, -n.y / side, 0};
  return s;
}

static real seen_area(const facets *s, int facet, vec w) {
  real cosine = dot(s->normal[facet], w);
  return cosine > 0 ? s->area[facet] * cosine : 0;
}

/* Share of the projected surface that a facet takes up, seen from w. */
static real share(const facets *s, int facet, vec w) {
  real both = seen_area(s, BUMPED, w) + seen_area(s, UPRIGHT, w);
  return both > 0 ? seen_area(s, facet, w) / both : 0;
}

/* How much of a facet is not hidden from w: projected areas must add up to w.z. */
static real unhidden(const facets *s, int facet, vec w) {
  if (dot(s->normal[facet], w) <= 0 || w.z <= 0)
    return 0;
  real part = w.z / (seen_area(s, BUMPED, w) + seen_area(s, UPRIGHT, w));
  return part < 1 ? part : 1;
}

/* Path by path: the eye's ray, traced back to the light. */
static unsigned two_facets(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3],
                           real *cosine) {
  const facets s = facets_of(n);
  real one[3], cosi;
  *cosine = wi.z > 0 ? wi.z : 0;
  /* one reflection, at the bumped facet */
  unsigned status = hard(p, n, lobe_n, wi, wo, one, &cosi);
  f[0] = f[1] = f[2] = 0;
  if (wi.z <= 0 || wo.z <= 0)
    return status;
  for (int i = 0; i < 3; i++)
    f[i] = share(&s, BUMPED, wo) * one[i] * cosi * unhidden(&s, BUMPED, wi) / wi.z;
  if (s.area[UPRIGHT] == 0)
    return status;
  const vec t = s.normal[UPRIGHT];
  if (dot(t, wi) > 0) { /* at the bumped facet, on to the mirror, out to the light */
    vec between = minus(wi, scale(t, 2 * dot(t, wi)));
    hard(p, n, lobe_n, between, wo, one, &cosi);
    real blocked = 1 - unhidden(&s, BUMPED, between);
    for (int i = 0; i < 3; i++)
      f[i] += share(&s, BUMPED, wo) * one[i] * cosi * blocked * unhidden(&s, UPRIGHT, wi) / wi.z;
  }
  if (dot(t, wo) > 0) { /* at the mirror, on to the bumped facet, out to the light */
    vec between = minus(wo, scale(t, 2 * dot(t, wo)));
    hard(p, n, lobe_n, wi, between, one, &cosi);
    for (int i = 0; i < 3; i++)
      f[i] += share(&s, UPRIGHT, wo) * one[i] * cosi * unhidden(&s, BUMPED, wi) / wi.z;
  }
  return status;
}

/* What is left of the light, by horizon. */
static real shadow(shade_horizon horizon, vec n, vec wi) {
  if (wi.z <= 0)
    return 0;
  if (horizon == SHADE_HORIZON_ESTEVEZ || horizon == SHADE_HORIZON_VALID_ESTEVEZ) {
    real bump = atan2l(hypotl(n.x, n.y), n.z), light = atan2l(hypotl(wi.x, wi.y), wi.z);
    real alpha2 = square(tanl(bump)) / 8;
    return 2 / (1 + sqrtl(1 + (alpha2 < 1 ? alpha2 : 1) * square(tanl(light))));
  }
  if (horizon == SHADE_HORIZON_CHIANG && dot(n, wi) > 0) {
    real g = wi.z / (n.z * dot(n, wi));
    return g < 1 ? g + g * g - g * g * g : 1;
  }
  return 1;
}

void shade_ref_normal(const shade_params *p, const double n_in[3], const double wo[3],
                      double out[3]) {
  vec n = normal(n_in);
  if (bends(p->horizon) && p->detail != SHADE_DETAIL_NONE)
    n = bent(n, direction(wo));
  out[0] = (double)n.x;
  out[1] = (double)n.y;
  out[2] = (double)n.z;
}

unsigned shade_ref_f(const shade_params *p, const double n_in[3], const double wi_in[3],
                     const double wo_in[3], double f[3], double *cosine) {
  f[0] = f[1] = f[2] = 0;
  if (cosine)
    *cosine = 0;
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return SHADE_BAD_INPUT;
  vec n = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  vec lobe_n = as_given(p, n_in, n);
  unsigned status = n_in[2] <= 0 ? SHADE_CLAMPED_NORMAL : SHADE_OK;
  shade_horizon horizon = p->detail == SHADE_DETAIL_NONE ? SHADE_HORIZON_HARD : p->horizon;
  real value[3], cosi, factor = shadow(horizon, n, wi); /* 1 but for two of them */
  if (bends(horizon)) {
    vec turned = bent(n, wo);
    lobe_n = turned.z > n.z ? turned : lobe_n;
    n = turned;
  }
  if (horizon == SHADE_HORIZON_SCHUESSLER)
    status |= two_facets(p, n, lobe_n, wi, wo, value, &cosi);
  else
    status |= hard(p, n, lobe_n, wi, wo, value, &cosi);
  for (int i = 0; i < 3; i++)
    f[i] = (double)(horizon == SHADE_HORIZON_HARD ? value[i] : value[i] * factor);
  if (cosine)
    *cosine = (double)cosi;
  return status;
}

/* ---- the density that shade_bsdf_sample draws with, by the contract of its header ------- */

/* One lobe of half vectors: two exponents for Ashikhmin-Shirley and Ward, else two alphas. */
typedef struct proposal {
  real x, y, weight;
} proposal;

static int by_exponents(const shade_params *p) {
  return p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY || p->mdf == SHADE_MDF_WARD;
}

/* Density of m, per sr about it, from its angles; eye is wo in the same frame. */
static real half_density(const shade_params *p, proposal q, vec m, vec eye, int visible) {
  real theta = atan2l(hypotl(m.x, m.y), m.z), phi = atan2l(m.y, m.x);
  real c = cosl(theta), tan2 = square(tanl(theta));
  if (m.x == 0 && m.y == 0)
    phi = pi / 4; /* the mean of both axes */
  if (by_exponents(p)) {
    real e = q.x * square(cosl(phi)) + q.y * square(sinl(phi));
    return sqrtl((q.x + 1) * (q.y + 1)) / (2 * pi) * powl(c, e);
  }
  real k = square(cosl(phi) / q.x) + square(sinl(phi) / q.y), peak = 1 / (pi * q.x * q.y);
  if (p->mdf == SHADE_MDF_WARD_HALF)
    return peak * expl(-4 * k * square(sinl(theta / 2))) / -expm1l(-2 * k);
  int ggx = p->mdf == SHADE_MDF_GGX;
  real d = peak / powl(c, 4) * (ggx ? 1 / square(1 + k * tan2) : expl(-k * tan2));
  if (!visible)
    return d * c;
  /* the share of m's area that the eye sees, of all that it sees */
  real slope = hypotl(q.x * eye.x, q.y * eye.y) / eye.z, lambda_o = 0;
  if (slope > 0 && ggx)
    lambda_o = (sqrtl(1 + slope * slope) - 1) / 2;
  else if (slope > 0)
    lambda_o = slope * expl(-1 / square(slope)) / (2 * sqrtl(pi)) - erfcl(1 / slope) / 2;
  return d * dot(m, eye) / (eye.z * (1 + lambda_o));
}

/* The lobes that the method draws from under n: how many, at most three. */
static int proposals(const shade_params *p, vec n, proposal q[3]) {
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  real ex = within(p->ex, 0, 1e6L), ey = within(p->ey, 0, 1e6L);
  shade_detail detail = method_of(p);
  if (p->mdf == SHADE_MDF_WARD) {
    ex = 2 / square(ax);
    ey = 2 / square(ay);
  }
  if (detail == SHADE_DETAIL_ROTATE_APPROXIMATE && p->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    /* alpha/L, at most sqrt(1000) */
    real l = grooves_along_y(p) ? hypotl(n.y, n.z) : hypotl(n.x, n.z);
    real most = sqrtl(1000);
    ex = p->mdf == SHADE_MDF_WARD && ex * l * l < 1e-3L ? 1e-3L : ex * l * l;
    ey = p->mdf == SHADE_MDF_WARD && ey * l * l < 1e-3L ? 1e-3L : ey * l * l;
    ax = ax / l > most ? most : ax / l;
    ay = ay / l > most ? most : ay / l;
  }
  int e = by_exponents(p);
  real x = e ? ex : ax, y = e ? ey : ay;
  q[0] = (proposal){x, y, 1};
  if (detail != SHADE_DETAIL_PERTURB || x == y)
    return 1;
  real phi = n.x == 0 && n.y == 0 ? pi / 4 : atan2l(n.y, n.x), side2 = square(n.x) + square(n.y);
  real kx = e ? ex : 1 / square(ax), ky = e ? ey : 1 / square(ay);
  real here = kx * square(cosl(phi)) + ky * square(sinl(phi)), least = kx < ky ? kx : ky;
  q[0].weight = 0.5L / (1 + (e ? 0.5L : 1) * side2 * here);
  q[1] = e ? (proposal){here, here, 0} : (proposal){1 / sqrtl(here), 1 / sqrtl(here), 0};
  q[1].weight = 0.5L - q[0].weight;
  q[2] = e ? (proposal){least, least, 0.5L} : (proposal){1 / sqrtl(least), 1 / sqrtl(least), 0.5L};
  return 3;
}

/* Density of wi about n, wi and wo above both horizons. */
static real lobe_density(const shade_params *p, vec n, vec wi, vec wo) {
  shade_detail detail = method_of(p), frame = detail;
  vec h = unit(plus(wi, wo));
  if (detail == SHADE_DETAIL_PERTURB) /* its lobes are carried by the smallest rotation */
    frame = SHADE_DETAIL_SHORTEST_ARC;
  if (detail == SHADE_DETAIL_ROTATE_APPROXIMATE)
    frame = SHADE_DETAIL_ROTATE;
  int visible = p->brdf == SHADE_BRDF_MICROFACET && !is_warp(detail) &&
                (p->mdf == SHADE_MDF_BECKMANN || p->mdf == SHADE_MDF_GGX);
  vec m = carried_by(frame, p, n, h);
  if (m.z <= 0)
    return 0;
  vec eye = visible ? carried_by(frame, p, n, wo) : wo;
  proposal q[3];
  int count = proposals(p, n, q);
  real density = 0;
  for (int i = 0; i < count; i++)
    density += q[i].weight * half_density(p, q[i], m, eye, visible);
  if (is_warp(detail)) /* areas of the disc: d omega = dA / z, on either side */
    density *= (h.x == n.x && h.y == n.y ? 1 : stretch(detail, n, h)) * h.z / m.z;
  return density / (4 * dot(h, wo));
}

/* The lobe's share of the draws beside a diffuse part. */
static real lobe_share(const shade_params *p, real coso) {
  real specular = 0, matt = 0;
  for (int c = 0; c < 3; c++) {
    real f0 = within(p->f0[c], 0, 1), kd = within(p->kd[c], 0, 1);
    matt += kd * (p->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? 1 - f0 : 1) / 3;
    specular += (p->fresnel == SHADE_FRESNEL_CONDUCTOR ? fresnel(p, c, 1) : f0) / 3;
  }
  if (p->fresnel == SHADE_FRESNEL_SCHLICK || p->fresnel == SHADE_FRESNEL_F82)
    specular += (1 - specular) * powl(1 - coso, 5);
  return within(specular / (specular + matt), 0.1L, 0.9L);
}

/* Density by the rule of `hard`. `lobe_n` is n as the distribution takes it. */
static real hard_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo) {
  vec pole = p->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  real cosi = dot(pole, wi), coso = dot(pole, wo);
  if (cosi <= 0 || coso <= 0 || wi.z <= 0 || wo.z <= 0)
    return 0;
  real density = lobe_density(p, lobe_n, wi, wo);
  if (p->kd[0] > 0 || p->kd[1] > 0 || p->kd[2] > 0) {
    int fibres =
        p->diffuse != SHADE_DIFFUSE_LAMBERT && p->diffuse != SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
    real matt = fibres ? 0.5L * cosi / pi + 0.25L / pi : cosi / pi;
    real share_of_lobe = lobe_share(p, coso);
    density = share_of_lobe * density + (1 - share_of_lobe) * matt;
  }
  return density;
}

/* The three ways that draws of two facets come to wi, each with its probability. */
static real two_facet_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo) {
  const facets s = facets_of(n);
  if (s.area[UPRIGHT] == 0)
    return hard_density(p, n, lobe_n, wi, wo);
  const vec t = s.normal[UPRIGHT];
  /* of the light w that leaves the bumped facet towards the mirror (t.w < 0), what is sent on */
  real tilt = atan2l(hypotl(n.x, n.y), n.z);
  real bounced = 0.5L * sinl(tilt) / (sinl(tilt) + cosl(tilt));
  vec image = mirrored(wo, n);
  if (dot(t, image) < 0 && image.z > 0) {
    real past = s.area[UPRIGHT] * fabsl(dot(t, image)) / image.z; /* tan tilt and the slope */
    real here = past < 1 ? past / (1 + past) : 0.5L;
    bounced = here > bounced ? here : bounced;
  }
  real density = hard_density(p, n, lobe_n, wi, wo) * (dot(t, wi) < 0 ? 1 - bounced : 1);
  if (dot(t, wi) > 0)
    density += hard_density(p, n, lobe_n, minus(wi, scale(t, 2 * dot(t, wi))), wo) * bounced;
  density *= share(&s, BUMPED, wo);
  if (dot(t, wo) > 0)
    density += hard_density(p, n, lobe_n, wi, minus(wo, scale(t, 2 * dot(t, wo)))) *
               share(&s, UPRIGHT, wo);
  return density;
}

double shade_ref_pdf(const shade_params *p, const double n_in[3], const double wi_in[3],
                     const double wo_in[3]) {
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return 0;
  vec n = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  vec lobe_n = as_given(p, n_in, n);
  if (p->detail == SHADE_DETAIL_NONE)
    return (double)hard_density(p, n, lobe_n, wi, wo);
  if (bends(p->horizon)) {
    vec turned = bent(n, wo);
    lobe_n = turned.z > n.z ? turned : lobe_n;
    n = turned;
  }
  return (double)(p->horizon == SHADE_HORIZON_SCHUESSLER ? two_facet_density(p, n, lobe_n, wi, wo)
                                                         : hard_density(p, n, lobe_n, wi, wo));
}
