/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Drawing light for prepared lanes of cloth, and its density. First the part: the lobe of
 * either side, what is diffuse (gaps and nap as well), what comes from behind; then a direction of
 * that part. Diffuse directions are about n, half by the cosine and half even: for fibres,
 * however they tilt, the weight stays bounded.
 */

LEAF real FN(mean3)(real r, real g, real b) {
  return (r + g + b) * R(0.33333333333333333333);
}

/* Probability of each part: by what it reflects, a twentieth at least of each that is there. */
static void FN(cloth_shares)(const shade_fabric *f, const FN(cloth) * c, const real *const wo[3],
                             real share[CLOTH_PARTS][BLOCK]) {
  const real *row = c->rows;
  const size_t s = c->stride;
  const real *nx = row + CLOTH_N * s, *ny = nx + s, *nz = ny + s;
  const real *ox = wo[0], *oy = wo[1], *oz = wo[2];
  const real *weight = row + CLOTH_WEIGHT * s, *kd = row + CLOTH_KD * s, *kt = row + CLOTH_KT * s;
  const real *flat = row + CLOTH_FLAT * s, *nap = row + CLOTH_NAP * s;
  real f0[2];
  for (int k = 0; k < 2; k++)
    f0[k] = (real)((f->side[k].f0[0] + f->side[k].f0[1] + f->side[k].f0[2]) / 3);
  const real haze = (real)(0.25 / 3 * (f->nap_color[0] + f->nap_color[1] + f->nap_color[2]));
  real *lobe0 = share[0], *lobe1 = share[1], *diffuse = share[2], *behind = share[3];
  for (size_t i = 0; i < c->count; i++) /* else those rows are not filled */
    behind[i] = f->transmits ? FN(mean3)(kt[i], kt[i + s], kt[i + 2 * s]) +
                                   FN(mean3)(kt[i + 3 * s], kt[i + 4 * s], kt[i + 5 * s])
                             : 0;
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    real co = FN(maximum)(nx[i] * ox[i] + ny[i] * oy[i] + nz[i] * oz[i], R(1e-4));
    real white = FN(schlick_weight)(FN(minimum)(co, 1));
    real gone = FN(minimum)(nap[i] / co, 60);
    real through = FN(exp_negative)(R(0.5) * gone);
    real a = through * weight[i] * (f0[0] + (1 - f0[0]) * white);
    real b = through * weight[i + s] * (f0[1] + (1 - f0[1]) * white);
    real d = FN(mean3)(kd[i], kd[i + s], kd[i + 2 * s]) +
             FN(mean3)(kd[i + 3 * s], kd[i + 4 * s], kd[i + 5 * s]) +
             FN(mean3)(flat[i], flat[i + s], flat[i + 2 * s]);
    d = through * d + haze * (1 - through * through);
    real e = through * behind[i];
    real least = (a + b + d + e) * R(0.0625);
    a += a > 0 ? least : 0;
    b += b > 0 ? least : 0;
    d += d > 0 ? least : 0;
    e += e > 0 ? least : 0;
    real scale = 1 / (a + b + d + e + TINY);
    lobe0[i] = a * scale;
    lobe1[i] = b * scale;
    diffuse[i] = d * scale;
    behind[i] = e * scale;
  }
}

/* The density by the rule of `hard`, for eyes wo. */
static void FN(cloth_density)(const shade_fabric *f, const FN(cloth) * c, const real *const wi[3],
                              const real *const wo[3], real *pdf) {
  FN(gathered) g;
  FN(lists) lists;
  real ci[BLOCK], co[BLOCK], side[BLOCK], one[BLOCK], share[CLOTH_PARTS][BLOCK];
  FN(cloth_sides)(c, wi, wo, ci, co, side);
  FN(cloth_list)(c, side, &lists);
  FN(cloth_shares)(f, c, wo, share);
  const real *diffuse = share[CLOTH_DIFFUSE], *behind = share[CLOTH_BEHIND];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    real part = side[i] > 0 ? diffuse[i] : side[i] < 0 ? behind[i] : 0;
    pdf[i] = part * INVERSE_PI * (R(0.25) + R(0.5) * FN(absolute)(ci[i]));
  }
  for (int kind = 0; kind < CLOTH_VOID; kind++)
    for (int k = 0; k < 2; k++) {
      const fabric_side *s = &f->side[k];
      if (!FN(cloth_gather)(f, c, &lists, 0, kind, k, wi, wo, &g))
        continue;
      FN(cloth_lobes)(FN(ASK_DENSITY), c, s, k, kind, &g, one, NULL);
      for (size_t j = 0; j < g.count; j++)
        pdf[g.lane[j]] += share[k][g.lane[j]] * one[j];
    }
}

static void FN(cloth_eye)(const FN(cloth) * c, const real *wo[3]) {
  for (int a = 0; a < 3; a++)
    wo[a] = FN(cloth_row)(c, CLOTH_WO + a);
}

/* The same for facets and upright mirrors; draws go the paths of sample.h. */
static void FN(cloth_facets_density)(const shade_fabric *f, const FN(cloth) * c,
                                     const real *const wi[3], real *pdf) {
  const real *n[3], *wo[3];
  real x[BLOCK], y[BLOCK], one[BLOCK], plain[BLOCK], light[BLOCK], eye[BLOCK];
  const size_t size = c->count;
  FN(cloth_eye)(c, wo);
  for (int a = 0; a < 3; a++)
    n[a] = FN(cloth_row)(c, CLOTH_N + a);
  FN(pass_paths)
  (size, FN(vec_of)(n), FN(vec_of)(wi), FN(vec_of)(wo), plain, light, eye);
  for (size_t i = 0; i < size; i++)
    if (!(wi[2][i] > 0)) { /* what comes from behind meets no mirror */
      plain[i] = 1 - eye[i];
      light[i] = 0;
    }
  FN(cloth_density)(f, c, wi, wo, pdf);
  FN(pass_multiply)(size, plain, pdf);
  FN(pass_mirror)(size, FN(vec_of)(n), FN(vec_of)(wi), x, y);
  const real *const from[3] = {x, y, wi[2]};
  FN(cloth_density)(f, c, from, wo, one);
  FN(pass_add_product)(size, light, one, pdf);
  FN(pass_mirror)(size, FN(vec_of)(n), FN(vec_of)(wo), x, y);
  const real *const seen[3] = {x, y, wo[2]};
  FN(cloth_density)(f, c, wi, seen, one);
  FN(pass_add_product)(size, eye, one, pdf);
}

static unsigned FN(kernel_cloth_pdf)(const shade_fabric *f, const FN(cloth) * c,
                                     const real *const wi_in[3], real *pdf) {
  FN(mended_light) m;
  const real *wo[3];
  unsigned status = FN(mend_light)(c->count, wi_in, &m);
  const real *const wi[3] = {m.wi[0], m.wi[1], m.wi[2]};
  FN(cloth_eye)(c, wo);
  if (!f->transmits)
    status |= FN(cloth_opposite)(c, wi);
  if (f->horizon == SHADE_HORIZON_SCHUESSLER)
    FN(cloth_facets_density)(f, c, wi, pdf);
  else
    FN(cloth_density)(f, c, wi, wo, pdf);
  for (size_t i = 0; status & SHADE_BAD_INPUT && i < c->count; i++)
    if (m.wi[0] != wi_in[0] && m.void_lane[i])
      pdf[i] = 0;
  return status;
}

/* ---- draws ------------------------------------------------------------------ */

/* Draws of one lobe for every eye of g, into its wi. */
static void FN(cloth_sample)(const bsdf *b, FN(gathered) * g, const real *u1, const real *u2) {
  real rgb[3][BLOCK], pdf[BLOCK], cosine[BLOCK];
  FN(varied) lobes;
  const FN(shade_sample_lanes) in = {.size = sizeof in,
                                     .nx = g->n[0],
                                     .ny = g->n[1],
                                     .nz = g->n[2],
                                     .wox = g->wo[0],
                                     .woy = g->wo[1],
                                     .woz = g->wo[2],
                                     .u1 = u1,
                                     .u2 = u2};
  const FN(shade_sample_result) out = {.size = sizeof out,
                                       .wix = g->wi[0],
                                       .wiy = g->wi[1],
                                       .wiz = g->wi[2],
                                       .r = rgb[0],
                                       .g = rgb[1],
                                       .b = rgb[2],
                                       .pdf = pdf,
                                       .cosine = cosine};
  FN(sample_batch)(b, g->count, &in, FN(cloth_varied)(b, g, &lobes), &out);
}

/* Lobes of the lanes that are listed, into wi. u3 chooses among nodes, and is used up. */
static void FN(cloth_draw_lobes)(const shade_fabric *f, const FN(cloth) * c, const FN(lists) * l,
                                 int kind, int k, const real *const wo[3], real *u3, const real *u1,
                                 const real *u2, real *const wi[3]) {
  FN(gathered) g, dull;
  real v[2][BLOCK];
  int at[BLOCK];
  const fabric_side *s = &f->side[k];
  if (!FN(cloth_gather)(f, c, l, 0, kind, k, NULL, wo, &g))
    return;
  FN(cloth_tilts)(c, kind, &s->one, &g);
  for (size_t j = 0; j < g.count; j++) {
    const int i = g.lane[j];
    v[0][j] = u1[i];
    v[1][j] = u2[i];
    if (kind != CLOTH_FAR || s->draws_one)
      continue;
    int node = 0;
    real left = u3[i];
    while (node + 1 < s->coarse.count && left >= s->coarse.FN(weight)[node])
      left -= s->coarse.FN(weight)[node++];
    g.n[0][j] = s->coarse.FN(x)[node];
    g.n[1][j] = s->coarse.FN(y)[node];
    g.n[2][j] = s->coarse.FN(z)[node];
  }
  const fabric_lobe which = FN(cloth_lobe)(FN(ASK_DENSITY), s, kind);
  const bsdf *b = bsdf_of(&s->lobe[which]);
  const size_t less = FN(cloth_dull)(c, s, which, k, &g, &dull, at);
  if (less < g.count)
    FN(cloth_sample)(b, &g, v[0], v[1]);
  for (size_t i = 0; i < less; i++) {
    const int j = at[i]; /* never before i */
    for (int a = 0; a < 3; a++)
      dull.n[a][i] = g.n[a][j];
    v[0][i] = v[0][j];
    v[1][i] = v[1][j];
  }
  if (less)
    FN(cloth_sample)(b, &dull, v[0], v[1]);
  for (size_t i = 0; i < less; i++)
    for (int a = 0; a < 3; a++)
      g.wi[a][at[i]] = dull.wi[a][i];
  FN(cloth_carry_back)(f, c, kind, k, &g, wi);
}

/* A diffuse direction about n: half by the cosine, half even; mirrored for light from behind. */
static void FN(cloth_draw_diffuse)(const FN(cloth) * c, size_t i, int behind, real u3, real u1,
                                   real u2, real w[3]) {
  const real nx = FN(cloth_row)(c, CLOTH_N)[i], ny = FN(cloth_row)(c, CLOTH_N + 1)[i];
  const real nz = FN(cloth_row)(c, CLOTH_N + 2)[i];
  const FN(axes) a = FN(axes_shortest_arc)(nx, ny, nz);
  const FN(pair) p = FN(circle)(u1);
  const int flat = u3 < R(0.5);
  real z = flat ? 1 - u2 : FN(root)(1 - u2), sine = FN(root)(flat ? u2 * (2 - u2) : u2);
  real x = sine * p.x, y = sine * p.y;
  z = behind ? -z : z;
  w[0] = a.x.x * x + a.y.x * y + nx * z;
  w[1] = a.x.y * x + a.y.y * y + ny * z;
  w[2] = a.x.z * x + a.y.z * y + nz * z;
}

/* Draws by the rule of `hard` for eyes wo; u3 is used up. wi is 0 where nothing was found. */
static void FN(cloth_draw)(const shade_fabric *f, const FN(cloth) * c, const real *const wo[3],
                           real *u3, const real *u1, const real *u2, real *const wi[3]) {
  FN(lists) lists[2];
  real share[CLOTH_PARTS][BLOCK];
  const real *nx = FN(cloth_row)(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  FN(cloth_shares)(f, c, wo, share);
  memset(lists[0].count, 0, sizeof lists[0].count);
  memset(lists[1].count, 0, sizeof lists[1].count);
  for (size_t i = 0; i < c->count; i++) {
    wi[0][i] = wi[1][i] = wi[2][i] = 0;
    const real co = nx[i] * wo[0][i] + ny[i] * wo[1][i] + nz[i] * wo[2][i];
    if (c->kind[i] == CLOTH_VOID || !(FN(minimum)(co, wo[2][i]) > 0))
      continue;
    int part = 0, last = -1;
    real u = u3[i];
    for (int k = 0; k < CLOTH_PARTS; k++)
      last = share[k][i] > 0 ? k : last;
    while (part < last && u >= share[part][i])
      u -= share[part++][i];
    if (last < 0)
      continue;
    u3[i] = u = FN(minimum)(u / FN(maximum)(share[part][i], R(1e-20)), BELOW_ONE);
    if (part < CLOTH_DIFFUSE) {
      lists[part].lane[0][c->kind[i]][lists[part].count[0][c->kind[i]]++] = (int)i;
    } else {
      real w[3];
      FN(cloth_draw_diffuse)(c, i, part == CLOTH_BEHIND, u, u1[i], u2[i], w);
      for (int a = 0; a < 3; a++)
        wi[a][i] = w[a];
    }
  }
  for (int k = 0; k < 2; k++)
    for (int kind = 0; kind < CLOTH_VOID; kind++)
      FN(cloth_draw_lobes)(f, c, &lists[k], kind, k, wo, u3, u1, u2, wi);
  for (size_t i = 0; i < c->count; i++) { /* unit, and on one side of both horizons */
    real size2 = wi[0][i] * wi[0][i] + wi[1][i] * wi[1][i] + wi[2][i] * wi[2][i];
    real ci = nx[i] * wi[0][i] + ny[i] * wi[1][i] + nz[i] * wi[2][i];
    real scale = size2 > R(0.25) && ci * wi[2][i] > 0 ? 1 / FN(root)(size2) : 0;
    for (int a = 0; a < 3; a++)
      wi[a][i] *= scale;
  }
}

/* Draws for facets and upright mirrors: the path first, by u3, then as for hard. */
static void FN(cloth_facets_draw)(const shade_fabric *f, const FN(cloth) * c, real *u3,
                                  const real *u1, const real *u2, real *const wi[3]) {
  const real *n[3], *wo[3];
  real x[BLOCK], y[BLOCK], bounce[BLOCK];
  FN(cloth_eye)(c, wo);
  for (int a = 0; a < 3; a++)
    n[a] = FN(cloth_row)(c, CLOTH_N + a);
  FN(pass_choose_path)
  (c->count, FN(vec_of)(n), FN(vec_of)(wo), u3, x, y, bounce);
  const real *const eye[3] = {x, y, wo[2]};
  FN(cloth_draw)(f, c, eye, u3, u1, u2, wi);
  for (size_t i = 0; i < c->count; i++) {
    const real side = n[0][i] * wi[0][i] + n[1][i] * wi[1][i];
    if (bounce[i] > 0 && side > 0 && wi[2][i] > 0) {
      const real step = FN(mirror_step)(n[0][i], n[1][i], wi[0][i], wi[1][i]);
      wi[0][i] -= step * n[0][i];
      wi[1][i] -= step * n[1][i];
    }
  }
}

/* wi from u1, u2, u3 of every lane: 0 where no direction was found. Returns status bits. */
static unsigned FN(kernel_cloth_draw)(const shade_fabric *f, const FN(cloth) * c,
                                      const real *const u_in[3], real *const wi[3]) {
  real u[3][BLOCK];
  const real *wo[3];
  int odd = 0;
  for (int a = 0; a < 3; a++)
    odd |= FN(pass_uniform)(c->count, u_in[a], u[a]);
  FN(cloth_eye)(c, wo);
  if (f->horizon == SHADE_HORIZON_SCHUESSLER)
    FN(cloth_facets_draw)(f, c, u[2], u[0], u[1], wi);
  else
    FN(cloth_draw)(f, c, wo, u[2], u[0], u[1], wi);
  for (size_t i = 0; odd && i < c->count; i++)
    for (int a = 0; a < 3; a++)
      if (u_in[a][i] != u_in[a][i])
        wi[0][i] = wi[1][i] = wi[2][i] = 0;
  return odd ? SHADE_BAD_INPUT : SHADE_OK;
}
