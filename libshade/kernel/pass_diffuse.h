/* SPDX-License-Identifier: Apache-2.0 */
/* Diffuse passes: components across the fibre, then Phi/(pi cos), then each colour. */

static void FN(pass_across)(size_t count, const real *restrict nx, const real *restrict ny,
                            const real *restrict nz, const real *restrict wx,
                            const real *restrict wy, const real *restrict wz,
                            real *restrict across) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    across[i] = FN(across_fibre)(nx[i], ny[i], nz[i], wx[i], wy[i], wz[i]);
}

/* The floor keeps f finite where the cosine vanishes and Phi does not. */
#define DIFFUSE_PASS(name)                                                                         \
  static void FN(pass_##name)(size_t count, const real *restrict ly, const real *restrict cosi,    \
                              const real *restrict vy, const real *restrict coso,                  \
                              real *restrict q) {                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      real phi = FN(name)(ly[i], cosi[i], vy[i], coso[i]);                                         \
      real value = phi * R(0.31830988618379067154) / FN(maximum)(cosi[i], R(1e-20));               \
      q[i] = coso[i] > 0 ? value : 0;                                                              \
    }                                                                                              \
  }

DIFFUSE_PASS(diffuse_lambert)
DIFFUSE_PASS(diffuse_max_normal)
DIFFUSE_PASS(diffuse_fibre)
DIFFUSE_PASS(diffuse_fibre_view)
DIFFUSE_PASS(diffuse_ashikhmin_shirley)
#undef DIFFUSE_PASS

static void FN(pass_diffuse)(const bsdf *b, size_t count, const real *ly, const real *cosi,
                             const real *vy, const real *coso, real *q) {
  switch (b->diffuse) {
  case SHADE_DIFFUSE_MAX_NORMAL:
    FN(pass_diffuse_max_normal)(count, ly, cosi, vy, coso, q);
    break;
  case SHADE_DIFFUSE_FIBRE:
    FN(pass_diffuse_fibre)(count, ly, cosi, vy, coso, q);
    break;
  case SHADE_DIFFUSE_FIBRE_VIEW:
  case SHADE_DIFFUSE_POULIN_FOURNIER:
    FN(pass_diffuse_fibre_view)(count, ly, cosi, vy, coso, q);
    break;
  case SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY:
    FN(pass_diffuse_ashikhmin_shirley)(count, ly, cosi, vy, coso, q);
    break;
  default:
    FN(pass_diffuse_lambert)(count, ly, cosi, vy, coso, q);
  }
}

/* The same decision for one sample: Phi. */
LEAF real FN(diffuse_phi)(shade_diffuse model, real ly, real lz, real vy, real vz) {
  switch (model) {
  case SHADE_DIFFUSE_MAX_NORMAL:
    return FN(diffuse_max_normal)(ly, lz, vy, vz);
  case SHADE_DIFFUSE_FIBRE:
    return FN(diffuse_fibre)(ly, lz, vy, vz);
  case SHADE_DIFFUSE_FIBRE_VIEW:
  case SHADE_DIFFUSE_POULIN_FOURNIER:
    return FN(diffuse_fibre_view)(ly, lz, vy, vz);
  case SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY:
    return FN(diffuse_ashikhmin_shirley)(ly, lz, vy, vz);
  default:
    return FN(diffuse_lambert)(ly, lz, vy, vz);
  }
}

/* Adds a colour channel's diffuse part to out. Ashikhmin-Shirley's has what f0 leaves. */
static void FN(pass_add_diffuse)(size_t count, real kd, const real *restrict q,
                                 real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] += kd * q[i];
}

static void FN(pass_add_diffuse_textured)(size_t count, real kd, const real *restrict f0,
                                          const real *restrict q, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] += kd * (1 - FN(reflectance)(f0[i])) * q[i];
}

/* d: f to f cos. q: Phi/(pi cos) to what yarn_batch promises. */
static void FN(pass_yarn)(size_t count, const real *restrict cosi, const real *restrict coso,
                          real *restrict d, real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real enter = 1 - FN(schlick_weight)(FN(minimum)(cosi[i], 1));
    real leave = 1 - FN(schlick_weight)(FN(minimum)(coso[i], 1));
    real matt = q[i] * cosi[i] * enter * leave;
    d[i] *= cosi[i];
    q[i] = coso[i] > 0 ? matt : 0;
  }
}
