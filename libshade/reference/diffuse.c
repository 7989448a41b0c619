/* SPDX-License-Identifier: Apache-2.0 */
/* Diffuse models: fibres by quadrature over what faces light and eye. */
#include "model.h"

#include <math.h>

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

/*
 * The integral of (n'.a)(n'.b) over an arc, b NULL standing for 1: 16 times Gauss's 5 points. From
 * panel to panel n' is turned, which is as good as its sine and cosine and takes a tenth.
 */
static real over_arc(arc on, vec a, const vec *b) {
  enum { PANELS = 16 };
  const real near = sqrtl(5 - 2 * sqrtl(10 / 7.0L)) / 3, far = sqrtl(5 + 2 * sqrtl(10 / 7.0L)) / 3;
  const real heavy = (322 + 13 * sqrtl(70)) / 900, light = (322 - 13 * sqrtl(70)) / 900;
  const real nodes[] = {-far, -near, 0, near, far};
  const real weights[] = {light, heavy, 128 / 225.0L, heavy, light};
  if (on.to <= on.from)
    return 0;
  const real half = (on.to - on.from) / (2 * PANELS), c = cosl(2 * half), s = sinl(2 * half);
  real sum = 0;
  for (int k = 0; k < 5; k++) {
    const real theta = on.from + half * (1 + nodes[k]);
    vec n = {0, sinl(theta), cosl(theta)};
    for (int panel = 0; panel < PANELS; panel++) {
      sum += weights[k] * dot(n, a) * (b ? dot(n, *b) : 1);
      n = (vec){0, n.y * c + n.z * s, n.z * c - n.y * s};
    }
  }
  return sum * half;
}

/* Phi of unit l and v above the horizon. */
static real diffuse(shade_diffuse model, vec l, vec v) {
  if (length2(v.y, v.z) < 1e-15L) /* along the fibre: as seen from above */
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
    return 28 / 23.0L * (1 - fifth(1 - l.z / 2)) * (1 - fifth(1 - v.z / 2)) * l.z;
  case SHADE_DIFFUSE_LAMBERT:
  case SHADE_DIFFUSE_COUNT:
    break;
  }
  return l.z;
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
real ref_diffuse_part(const shade_params *p, int c, vec n, vec wi, vec wo) {
  real kd = within(p->kd[c], 0, 1);
  shade_params q = *p;
  q.detail = p->detail == SHADE_DETAIL_NONE ? SHADE_DETAIL_NONE : SHADE_DETAIL_ROTATE;
  vec l = ref_carried(&q, n, wi), v = ref_carried(&q, n, wo);
  if (ref_grooves_along_y(p)) {
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
