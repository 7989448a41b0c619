/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The choices of table.h as code sees them: what a detail method, a Fresnel, a horizon is. Each
 * row of table.h needs its row here, and the leaf that is named there: a compiler tells what is
 * missing. Distributions: mdf.h. Independent of precision; setup.c reads it too.
 */
#ifndef SHADE_MODEL_METHODS_H
#define SHADE_MODEL_METHODS_H

#include "shade/shade.h"

/*
 * How a half vector is carried: ROW(NAME, leaf, along_y, kind, frame)
 *   leaf     detail_<leaf> of detail.h
 *   along_y  1: with x and y in each other's place
 *   kind     RIGID, or a warp: WARP_LINEAR, WARP_SMOOTH, which needs a unit h and has a Jacobian
 *   frame    the map in whose frame, or through which, half vectors are drawn for it: one of
 *            SHADE_FRAME_ROWS, or a warp
 * _RATIO: for distributions that see neither a common scale of x and y nor the slope itself.
 */
#define SHADE_MAP_ROWS(ROW)                                                                        \
  ROW(NONE, none, 0, RIGID, NONE)                                                                  \
  ROW(PERTURB_RATIO, perturb_ratio, 0, RIGID, SHORTEST_ARC)                                        \
  ROW(PERTURB, perturb, 0, RIGID, SHORTEST_ARC)                                                    \
  ROW(ROTATE_X, rotate, 0, RIGID, ROTATE_X)                                                        \
  ROW(ROTATE_Y, rotate, 1, RIGID, ROTATE_Y)                                                        \
  ROW(ROTATE_RATIO_X, rotate_ratio, 0, RIGID, ROTATE_X)                                            \
  ROW(ROTATE_RATIO_Y, rotate_ratio, 1, RIGID, ROTATE_Y)                                            \
  ROW(SHORTEST_ARC, shortest_arc, 0, RIGID, SHORTEST_ARC)                                          \
  ROW(DEFORM_LINEAR, deform_linear, 0, WARP_LINEAR, DEFORM_LINEAR)                                 \
  ROW(DEFORM_SMOOTH, deform_smooth, 0, WARP_SMOOTH, DEFORM_SMOOTH)

/*
 * SHADE_LOOP_OF_<list>(choice): the loop LOOP(choice), a macro of where it stands, once for each
 * choice of a list, which is a constant in it. So compilers make a loop of each.
 */
#define SHADE_LOOP_(choice)                                                                        \
  case choice:                                                                                     \
    LOOP(choice);                                                                                  \
    break;
#define SHADE_MDF_LOOP_(NAME, ...) SHADE_LOOP_(SHADE_MDF_##NAME)
#define SHADE_BRDF_LOOP_(NAME, ...) SHADE_LOOP_(SHADE_BRDF_##NAME)
#define SHADE_FRESNEL_LOOP_(NAME, ...) SHADE_LOOP_(SHADE_FRESNEL_##NAME)
#define SHADE_DIFFUSE_LOOP_(NAME, ...) SHADE_LOOP_(SHADE_DIFFUSE_##NAME)
#define SHADE_LOOP_OF(LIST, choice)                                                                \
  switch (choice) { SHADE_TABLE_##LIST(SHADE_##LIST##_LOOP_) case SHADE_##LIST##_COUNT : break; }

#define SHADE_LOOP_OF_BRDF(choice)                                                                 \
  switch (choice) {                                                                                \
    SHADE_TABLE_BRDF_FORMS(SHADE_BRDF_LOOP_)                                                       \
  case SHADE_BRDF_AUTO:                                                                            \
  case SHADE_BRDF_COUNT:                                                                           \
    break;                                                                                         \
  }

#define SHADE_MAP_LOOP_(NAME, ...) SHADE_LOOP_(SHADE_MAP_##NAME)
#define SHADE_LOOP_OF_MAP(map)                                                                     \
  switch (map) {                                                                                   \
    SHADE_MAP_ROWS(SHADE_MAP_LOOP_)                                                                \
  case SHADE_MAP_COUNT:                                                                            \
    break;                                                                                         \
  }

#define SHADE_MAP_ENUM_(NAME, leaf, along_y, kind, frame) SHADE_MAP_##NAME,
typedef enum shade_map { SHADE_MAP_ROWS(SHADE_MAP_ENUM_) SHADE_MAP_COUNT } shade_map;

typedef enum shade_map_kind { SHADE_RIGID, SHADE_WARP_LINEAR, SHADE_WARP_SMOOTH } shade_map_kind;

/*
 * Relative errors of D through a warp, any distribution, |p|^2 <= 0.75 and tilts to 75 degrees;
 * else as shade_mdf_traits has those of rigid frames. Worst seen, all of deform_smooth: 4.0e-5 at
 * exponents (3.06, 364), n (.350, .713, .608), h (.808, .530, .256); 4.3e-5 at (257, .65); double
 * 1.3e-13. Held by test_accuracy.
 */
#define SHADE_WARP_FLOAT_1E3 1e-4
#define SHADE_WARP_FLOAT_1E5 3e-4
#define SHADE_WARP_DOUBLE_1E4 1e-12

/* The two columns that are asked for by value. */
typedef struct shade_map_traits {
  shade_map_kind kind;
  shade_map frame;
} shade_map_traits;
#define SHADE_MAP_IS_(NAME, leaf, along_y, kind, frame)                                            \
  [SHADE_MAP_##NAME] = {SHADE_##kind, SHADE_MAP_##frame},
static inline shade_map_traits shade_map_is(shade_map map) {
  static const shade_map_traits rows[] = {SHADE_MAP_ROWS(SHADE_MAP_IS_)};
  return rows[map];
}

/* What half vectors can be drawn in or through; rigid ones, ROW(NAME, name), by axes_<name> of
 * frame.h. */
#define SHADE_FRAME_ROWS(ROW)                                                                      \
  ROW(ROTATE_X, rotate_x) ROW(ROTATE_Y, rotate_y) ROW(SHORTEST_ARC, shortest_arc)
#define SHADE_FRAME_LOOP_(NAME, name) SHADE_LOOP_(SHADE_MAP_##NAME)
#define SHADE_LOOP_OF_FRAME(frame)                                                                 \
  switch (frame) {                                                                                 \
    SHADE_FRAME_ROWS(SHADE_FRAME_LOOP_)                                                            \
    SHADE_FRAME_LOOP_(DEFORM_LINEAR, )                                                             \
    SHADE_FRAME_LOOP_(DEFORM_SMOOTH, )                                                             \
  default:                                                                                         \
    LOOP(SHADE_MAP_NONE);                                                                          \
  }

/*
 * A detail method: its maps for grooves along x and y, for slopes, and for distributions that
 * read ratios; that of light and eye for Smith's Lambda where it is another (warps have no
 * frame). SHADE_DETAIL_<NAME>_IS for each row of table.h.
 */
typedef struct shade_detail_traits {
  shade_map slopes[2], ratio[2], shadow[2];
  int conserve;  /* a warp's D is divided by its stretch */
  int no_lobe;   /* D' has no closed integral unless it is round: drawn as a mixture */
  int ignores_n; /* n is taken as z: no horizon but that of the surface */
} shade_detail_traits;

#define SHADE_BOTH_(a)                                                                             \
  { SHADE_MAP_##a, SHADE_MAP_##a }
#define SHADE_EACH_(a)                                                                             \
  { SHADE_MAP_##a##_X, SHADE_MAP_##a##_Y }
#define SHADE_DETAIL_NONE_IS                                                                       \
  { SHADE_BOTH_(NONE), SHADE_BOTH_(NONE), SHADE_BOTH_(NONE), 0, 0, 1 }
#define SHADE_DETAIL_PERTURB_IS                                                                    \
  { SHADE_BOTH_(PERTURB), SHADE_BOTH_(PERTURB_RATIO), SHADE_BOTH_(PERTURB), 0, 1, 0 }
/* its x' is x without its part along n: the x' of groove transport along y */
#define SHADE_DETAIL_GRAM_SCHMIDT_IS                                                               \
  { SHADE_BOTH_(ROTATE_Y), SHADE_BOTH_(ROTATE_RATIO_Y), SHADE_BOTH_(ROTATE_Y), 0, 0, 0 }
#define SHADE_DETAIL_ROTATE_IS                                                                     \
  { SHADE_EACH_(ROTATE), SHADE_EACH_(ROTATE_RATIO), SHADE_EACH_(ROTATE), 0, 0, 0 }
#define SHADE_DETAIL_SHORTEST_ARC_IS                                                               \
  { SHADE_BOTH_(SHORTEST_ARC), SHADE_BOTH_(SHORTEST_ARC), SHADE_BOTH_(SHORTEST_ARC), 0, 0, 0 }
/* the ratio form, read as if it were slopes: they are short by L */
#define SHADE_DETAIL_ROTATE_APPROXIMATE_IS                                                         \
  { SHADE_EACH_(ROTATE_RATIO), SHADE_EACH_(ROTATE_RATIO), SHADE_EACH_(ROTATE_RATIO), 0, 0, 0 }
#define SHADE_DETAIL_DEFORM_LINEAR_IS                                                              \
  { SHADE_BOTH_(DEFORM_LINEAR), SHADE_BOTH_(DEFORM_LINEAR), SHADE_BOTH_(PERTURB), 0, 0, 0 }
#define SHADE_DETAIL_DEFORM_SMOOTH_IS                                                              \
  { SHADE_BOTH_(DEFORM_SMOOTH), SHADE_BOTH_(DEFORM_SMOOTH), SHADE_BOTH_(PERTURB), 0, 0, 0 }
/* what setup.c makes of it for a lobe that is not round */
#define SHADE_DETAIL_AUTO_IS SHADE_DETAIL_ROTATE_IS
#define SHADE_DETAIL_DEFORM_LINEAR_CONSERVING_IS                                                   \
  { SHADE_BOTH_(DEFORM_LINEAR), SHADE_BOTH_(DEFORM_LINEAR), SHADE_BOTH_(PERTURB), 1, 0, 0 }
#define SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING_IS                                                   \
  { SHADE_BOTH_(DEFORM_SMOOTH), SHADE_BOTH_(DEFORM_SMOOTH), SHADE_BOTH_(PERTURB), 1, 0, 0 }

/* A Fresnel: which of f0, tint (f82 or eta) and k its leaf reads; white at grazing angles. */
typedef struct shade_fresnel_traits {
  int f0, tint, k, grazing;
} shade_fresnel_traits;
#define SHADE_FRESNEL_NONE_IS                                                                      \
  { 1, 0, 0, 0 }
#define SHADE_FRESNEL_SCHLICK_IS                                                                   \
  { 1, 0, 0, 1 }
#define SHADE_FRESNEL_F82_IS                                                                       \
  { 1, 1, 0, 1 }
#define SHADE_FRESNEL_CONDUCTOR_IS                                                                 \
  { 0, 1, 1, 0 }

/* A diffuse model: whether it is one of fibres, which are drawn evenly too; what f0 leaves only. */
typedef struct shade_diffuse_traits {
  int fibres, less_f0, sees; /* sees: Phi depends on the eye */
} shade_diffuse_traits;
#define SHADE_DIFFUSE_LAMBERT_IS                                                                   \
  { 0, 0, 0 }
#define SHADE_DIFFUSE_MAX_NORMAL_IS                                                                \
  { 1, 0, 0 }
#define SHADE_DIFFUSE_FIBRE_IS                                                                     \
  { 1, 0, 0 }
#define SHADE_DIFFUSE_FIBRE_VIEW_IS                                                                \
  { 1, 0, 1 }
#define SHADE_DIFFUSE_POULIN_FOURNIER_IS                                                           \
  { 1, 0, 1 }
#define SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY_IS                                                         \
  { 0, 1, 1 }

/* A horizon: n is bent for the eye; which factor fades light; two facets instead of either, or
 * slopes of the map. */
typedef enum shade_fade { SHADE_FADE_NOT, SHADE_FADE_ESTEVEZ, SHADE_FADE_CHIANG } shade_fade;
typedef struct shade_horizon_traits {
  int bends;
  shade_fade fade;
  int facets, mutual;
} shade_horizon_traits;
#define SHADE_HORIZON_HARD_IS                                                                      \
  { 0, SHADE_FADE_NOT, 0, 0 }
#define SHADE_HORIZON_VALID_REFLECTION_IS                                                          \
  { 1, SHADE_FADE_NOT, 0, 0 }
#define SHADE_HORIZON_ESTEVEZ_IS                                                                   \
  { 0, SHADE_FADE_ESTEVEZ, 0, 0 }
#define SHADE_HORIZON_CHIANG_IS                                                                    \
  { 0, SHADE_FADE_CHIANG, 0, 0 }
#define SHADE_HORIZON_SCHUESSLER_IS                                                                \
  { 0, SHADE_FADE_NOT, 1, 0 }
#define SHADE_HORIZON_VALID_ESTEVEZ_IS                                                             \
  { 1, SHADE_FADE_ESTEVEZ, 0, 0 }

/* without slopes `hard`, which these traits say */
#define SHADE_HORIZON_MUTUAL_IS                                                                    \
  { 0, SHADE_FADE_NOT, 0, 1 }

/* shade_detail_is(d) and so on: the row of a choice. */
#define SHADE_DETAIL_IS_(NAME, word, value, label, help) [value] = SHADE_DETAIL_##NAME##_IS,
#define SHADE_FRESNEL_IS_(NAME, word, value, label, help) [value] = SHADE_FRESNEL_##NAME##_IS,
#define SHADE_DIFFUSE_IS_(NAME, word, value, label, help) [value] = SHADE_DIFFUSE_##NAME##_IS,
#define SHADE_HORIZON_IS_(NAME, word, value, label, help) [value] = SHADE_HORIZON_##NAME##_IS,
static inline shade_detail_traits shade_detail_is(shade_detail d) {
  static const shade_detail_traits rows[] = {SHADE_TABLE_DETAIL(SHADE_DETAIL_IS_)};
  return rows[d];
}
static inline shade_fresnel_traits shade_fresnel_is(shade_fresnel f) {
  static const shade_fresnel_traits rows[] = {SHADE_TABLE_FRESNEL(SHADE_FRESNEL_IS_)};
  return rows[f];
}
static inline shade_diffuse_traits shade_diffuse_is(shade_diffuse d) {
  static const shade_diffuse_traits rows[] = {SHADE_TABLE_DIFFUSE(SHADE_DIFFUSE_IS_)};
  return rows[d];
}
static inline shade_horizon_traits shade_horizon_is(shade_horizon h) {
  static const shade_horizon_traits rows[] = {SHADE_TABLE_HORIZON(SHADE_HORIZON_IS_)};
  return rows[h];
}

#endif
