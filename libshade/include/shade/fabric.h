/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Shading of woven cloth, from a macro shot to a figure across the room.
 *
 * Near, each point shows one yarn: a lobe that is narrow along the fibres (alternating
 * anisotropy: weft and warp are crossed) is carried by the tilt that shade_weave_lookup finds
 * there, with any of the detail methods, and a diffuse part is integrated over the fibre. Far
 * away, a pixel holds many yarns: the average over them is a mixture of lobes at nodes of the
 * tilt, found once from the weave itself, so that crimp, slant, occlusion, noise and
 * any draft are in it. What a pixel needs is chosen by its footprint, and one passes into
 * the other without a jump. [KangFabric, corrected]
 *
 * Two ways to call it. shade_fabric_eval and its batch answer for one pair of light and eye. A
 * renderer with several lights prepares a hit once (the look-up, the frames, what the
 * footprint holds), then evaluates it, asks for densities and draws directions for each light.
 *
 * A shade_fabric is set up once; evaluation allocates nothing, holds no state and may be
 * called from any number of threads at once. Frame as in shade.h: x along u, y along v.
 */
#ifndef SHADE_FABRIC_H
#define SHADE_FABRIC_H

#include "shade/shade.h"
#include "shade/weave.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the yarns of one direction are made of. Exponents as for Ashikhmin-Shirley; other
 * distributions take the matching alphas, e = 2/alpha^2 - 2. */
typedef struct shade_yarn {
  double along;  /* exponent along the fibres; smooth fibres: large, [0, 1e6] */
  double across; /* exponent across them, [0, 1e6] */
  double f0[3];  /* reflectance at normal incidence (Schlick), linear RGB, [0, 1] */
  double kd[3];  /* diffuse reflectance, linear RGB, [0, 1] */
  shade_diffuse diffuse;
} shade_yarn;

typedef struct shade_fabric_params {
  size_t size; /* sizeof(shade_fabric_params), set by shade_fabric_params_init */
  shade_mdf mdf;
  shade_brdf brdf;
  shade_detail detail;
  shade_yarn warp, weft;
  int draft_colors;  /* 1: each yarn's kd is multiplied by its colour in the draft */
  double backing[3]; /* reflectance of what shows through the gaps (Lambert), [0, 1] */
  /* A nap of loose fibres over the cloth: optical depth [0, 10] and colour [0, 1]. It
   * scatters once, which brightens grazing views, and veils the yarns below. 0: none. */
  double nap, nap_color[3];
  /* Diffuse transmission of a yarn: the share of light from behind that it lets through,
   * linear RGB, [0, 1]; 0: none. Multiplied by the yarn's colour in the draft and by its noise,
   * as kd is, and then at most what kd leaves of 1. */
  double warp_transmit[3], weft_transmit[3];
  /* For folds: what becomes of light and eye at the horizon of n (shade.h). Callers whose
   * `size` ends before it keep `hard`. */
  shade_horizon horizon;
  /* 1: yarns shade one another. Where light grazes, the yarns that lean towards it would take
   * more than falls on the cloth; all of it is scaled to what does, so that s goes to 0 at the
   * terminator instead of ending in a line (docs/theory/conventions.md, "Shadows of yarns"). 0: as
   * if each yarn were alone; so for callers whose `size` ends before it. */
  int shadows;
  size_t defaults; /* as in shade_params: SHADE_BRDF_AUTO, the default, is Ashikhmin-Shirley's for
                    * callers whose `size` ends before it */
} shade_fabric_params;

/* Ashikhmin-Shirley (brdf auto), rotate, fibre diffuse; exponents 100 and 10, f0 .04, kd .5, no
 * nap, nothing transmitted, SHADE_HORIZON_VALID_ESTEVEZ, shadows. */
SHADE_API void shade_fabric_params_init(shade_fabric_params *p);

/*
 * The numbers of a yarn's material and of a cloth by row: where row 0, 1, … is kept in *yarn or *p
 * (info->components of them, 1 or 3), and about it in *info unless that is NULL. NULL past the end.
 */
SHADE_API double *shade_fabric_yarn_number(shade_yarn *yarn, int row, shade_param_info *info);
SHADE_API double *shade_fabric_number(shade_fabric_params *p, int row, shade_param_info *info);

/*
 * As JSON, for the header of a dump, within their ranges: the shape of the yarns, their material,
 * and a cloth as one of the header's materials,
 * {"id": 0, "name": "…", "fabric": {"weave": "plain", "yarns": {…}, "cloth": {…}}}.
 * `weave` is a name that shade_draft_named takes; where it is NULL, "draft" holds `draft` as the
 * text of a WIF. Each writes at most `capacity` bytes with the closing 0 and returns the length
 * that was needed, as snprintf does; shade_fabric_json -1 when out of memory. `name` may be NULL.
 */
SHADE_API int shade_weave_params_json(const shade_weave_params *p, char *buffer, size_t capacity);
SHADE_API int shade_fabric_params_json(const shade_fabric_params *p, char *buffer, size_t capacity);
SHADE_API int shade_fabric_json(int id, const char *name, const shade_draft *draft,
                                const char *weave, const shade_weave_params *yarns,
                                const shade_fabric_params *cloth, char *buffer, size_t capacity);

typedef struct shade_fabric shade_fabric;

/*
 * A fabric ready for evaluation. It keeps `weave`, which the caller may free at once. Numbers
 * out of range are clamped (SHADE_CLAMPED_PARAMETER; NaN becomes the default), unknown choices
 * become the first of their list (SHADE_BAD_CHOICE): or-ed into *status unless it is NULL. p may
 * be NULL: the defaults. Looks at some 10^5 points of the weave and tables the far model: 10 to
 * 90 ms for the presets, up to half a second for the largest drafts. A fabric takes .2 to .6 MiB,
 * and 208 bytes for each crossing of the repeat (to 512 a side). NULL if weave is NULL or memory
 * ran out.
 */
SHADE_API shade_fabric *shade_fabric_create(const shade_weave *weave, const shade_fabric_params *p,
                                            unsigned *status);
SHADE_API void shade_fabric_free(shade_fabric *fabric); /* NULL is fine */

/*
 * How to evaluate.
 *   AUTO    by the footprint: the near model in it while it is below .75 crossings, the far
 *           model above 2, both between
 *   NEAR    the one point (u, v): what AUTO does for no footprint
 *   FAR     the mixture, with what share of the footprint each yarn has by the draft and, while
 *           there are fewer than 16 across it, by its own noise of width and brightness. Quick, by
 *           tables, where the yarns' BRDF is Ashikhmin and Shirley's with a detail method other
 *           than none or perturb, both exponents below 1100, a diffuse model that does not see
 *           light and eye at once, and the lane's gloss is 1; else, and where light and eye are
 *           more than 90 degrees apart, all its lobes in turn: some ten times as long
 *   SINGLE  one lobe for the warp and one for the weft, of the right second moments, the
 *           same everywhere: cheapest, for the background. Its mean colour is off by 15 to 55 %
 *           at the worst of 20 pairs of light and eye, and by 250 % where a dark cloth has a
 *           narrow highlight (FAR: by 2 %; compare/fabric.py)
 *
 * The near model in a footprint is the mean of 16 points of it. A random number r in [0, 1) picks
 * one term instead: with far's share x, r < x is the far model, else the point number
 * floor(16 (r - x)/(1 - x)) is the near one. The mean over r is what is had without. A path
 * tracer draws r once a hit, and eval, pdf and draw of that hit all speak of the same term.
 */
typedef enum shade_fabric_tier {
  SHADE_TIER_AUTO,
  SHADE_TIER_NEAR,
  SHADE_TIER_FAR,
  SHADE_TIER_SINGLE
} shade_fabric_tier;

/*
 * Radiance towards wo for unit irradiance at normal incidence from wi: f cos, RGB, in
 * 1/sr. (A picture is s times irradiance; a renderer that wants f divides by |n.wi|.) 0 where
 * n.wo or wo.z is <= 0, and where n.wi or wi.z is, by the horizon's rule.
 *   uv         where, in crossings (weave.h)
 *   footprint  extent of the pixel along u and v in crossings, >= 0; NULL is 0
 *   n          perturbed normal of the cloth as a whole (folds, a normal map), NULL for none.
 *              It is carried by groove transport: weft yarns follow dP/du of the surface whose
 *              normal is n, warp yarns dP/dv, and the yarn's own tilt is applied in that frame.
 * With transmission wi may come from behind (n.wi < 0 and wi.z < 0): what yarns let through.
 * No s is larger than what arrives allows: over all wi, the integral of s dwi is at most
 * 1, near and far, for detail methods other than perturb (test_fabric).
 * Status: SHADE_CLAMPED_NORMAL; SHADE_BAD_INPUT for non-finite input or wi = -wo (0) and for a
 * footprint that is negative or NaN (taken as 0).
 */
SHADE_API unsigned shade_fabric_eval(const shade_fabric *fabric, const double uv[2],
                                     const double footprint[2], const double n[3],
                                     const double wi[3], const double wo[3], shade_fabric_tier tier,
                                     double s[3]);
SHADE_API unsigned shade_fabric_evalf(const shade_fabric *fabric, const float uv[2],
                                      const float footprint[2], const float n[3], const float wi[3],
                                      const float wo[3], shade_fabric_tier tier, float s[3]);

/*
 * A point of the cloth with what textures say of it there. Fill it with
 * shade_fabric_point_init, which takes the fabric's own numbers, then change what differs.
 */
typedef struct shade_fabric_point {
  size_t size;         /* set by shade_fabric_point_init */
  double uv[2];        /* 0 */
  double footprint[2]; /* 0 */
  double n[3];         /* (0, 0, 1) */
  double random;       /* [0, 1): which term stands for the footprint; < 0: all of them (-1) */
  /* In place of the yarn's, [0, 1]. Near, what is let through is at most what it leaves of 1; far
   * it is what the fabric's own kd leaves. */
  double warp_kd[3], weft_kd[3];
  /* Scale of both exponents, [0, 1]; 1: the yarn's own. A lobe of the alpha a becomes one of
   * a^2/gloss (exponents: e gloss), near and in every lobe of the far model, by as much
   * variance. 0 counts as 1e-6. */
  double warp_gloss, weft_gloss;
  double nap; /* optical depth, [0, 10] */
} shade_fabric_point;
typedef struct shade_fabric_pointf {
  size_t size;
  float uv[2], footprint[2], n[3];
  float random;
  float warp_kd[3], weft_kd[3], warp_gloss, weft_gloss, nap;
} shade_fabric_pointf;
SHADE_API void shade_fabric_point_init(const shade_fabric *fabric, shade_fabric_point *point);
SHADE_API void shade_fabric_point_initf(const shade_fabric *fabric, shade_fabric_pointf *point);

/*
 * A hit prepared for many lights: a fixed size, private contents, no pointers to free. It holds
 * for the fabric it was made of.
 */
enum { SHADE_FABRIC_HIT_SIZE = 6144, SHADE_FABRIC_HITF_SIZE = 3584 };
typedef struct shade_fabric_hit {
  union {
    double align;
    unsigned char bytes[SHADE_FABRIC_HIT_SIZE];
  } private_;
} shade_fabric_hit;
typedef struct shade_fabric_hitf {
  union {
    double align;
    unsigned char bytes[SHADE_FABRIC_HITF_SIZE];
  } private_;
} shade_fabric_hitf;

/*
 * Prepare a hit for the eye's direction wo. point NULL: the fabric's own numbers at (0, 0); so
 * where nobody set its size (SHADE_BAD_INPUT). *coverage, if not NULL, is the share of the eye's
 * ray that meets something: 1 on yarns and where the gaps have a backing; else, in gaps, what loose
 * fibres and the nap take of it. A renderer that looks through the cloth adds (1 - coverage) of
 * what is behind; the near model's is that of the point (0 or 1 but for fuzz and nap), the far
 * model's a share. s never has that part. Status as for shade_fabric_eval; *hit is always usable
 * afterwards (0 for bad input).
 */
SHADE_API unsigned shade_fabric_prepare(const shade_fabric *fabric, const shade_fabric_point *point,
                                        const double wo[3], shade_fabric_tier tier,
                                        shade_fabric_hit *hit, double *coverage);
SHADE_API unsigned shade_fabric_preparef(const shade_fabric *fabric,
                                         const shade_fabric_pointf *point, const float wo[3],
                                         shade_fabric_tier tier, shade_fabric_hitf *hit,
                                         float *coverage);

/*
 * What a prepared hit reflects from wi, as shade_fabric_eval; the density with which
 * shade_fabric_hit_sample draws wi, per sr; and such a draw from three independent numbers u,
 * uniform in [0, 1) (clamped to it). s/pdf, averaged over u, is the integral of s over all
 * directions: the albedo.
 *
 * What is drawn: the part, by its reflectance (a yarn's lobe, its diffuse part, what comes
 * through, the nap, the gap; each that is there has at least a twentieth of the draws), then
 *   near    the yarn's lobe as shade_bsdf_sample draws it in the frame of its fibres, tilt and
 *           fold included
 *   far     a yarn system by its share, then one of at most 16 lobes that stand for its mixture
 *   single  a yarn system, then its lobe
 * and all that is diffuse about n (what comes through about -n), half by the cosine, half even.
 * The density is that of the whole mixture of all these. A draw below a horizon finds nothing
 * (SHADE_NO_SAMPLE: wi, s and pdf are 0) and counts as 0: the pdf's integral is 1 less their
 * probability. pdf is finite, and > 0 for every direction drawn. Weights:
 * docs/theory/conventions.md.
 */
SHADE_API unsigned shade_fabric_hit_eval(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                         const double wi[3], double s[3]);
SHADE_API unsigned shade_fabric_hit_evalf(const shade_fabric *fabric, const shade_fabric_hitf *hit,
                                          const float wi[3], float s[3]);
SHADE_API double shade_fabric_hit_pdf(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                      const double wi[3], unsigned *status);
SHADE_API float shade_fabric_hit_pdff(const shade_fabric *fabric, const shade_fabric_hitf *hit,
                                      const float wi[3], unsigned *status);
SHADE_API unsigned shade_fabric_hit_sample(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                           const double u[3], double wi[3], double s[3],
                                           double *pdf);
SHADE_API unsigned shade_fabric_hit_samplef(const shade_fabric *fabric,
                                            const shade_fabric_hitf *hit, const float u[3],
                                            float wi[3], float s[3], float *pdf);

/* Both at once, for callers with one light: prepare, then pdf or sample. */
SHADE_API double shade_fabric_pdf(const shade_fabric *fabric, const shade_fabric_point *point,
                                  const double wi[3], const double wo[3], shade_fabric_tier tier,
                                  unsigned *status);
SHADE_API float shade_fabric_pdff(const shade_fabric *fabric, const shade_fabric_pointf *point,
                                  const float wi[3], const float wo[3], shade_fabric_tier tier,
                                  unsigned *status);
SHADE_API unsigned shade_fabric_sample(const shade_fabric *fabric, const shade_fabric_point *point,
                                       const double wo[3], shade_fabric_tier tier,
                                       const double u[3], double wi[3], double s[3], double *pdf);
SHADE_API unsigned shade_fabric_samplef(const shade_fabric *fabric,
                                        const shade_fabric_pointf *point, const float wo[3],
                                        shade_fabric_tier tier, const float u[3], float wi[3],
                                        float s[3], float *pdf);

/*
 * The same over arrays, `count` long each. Set size; members beyond it count as NULL.
 * Required: u, v, wo, and what the call reads of wi (eval, pdf) or u1, u2, u3 (sample). n, the
 * footprint and a yarn's colour may be NULL as a whole (all three, both), every other array
 * alone: the fabric's own numbers. Outputs must not overlap inputs.
 *
 * Each lane is what a single call has, unless the caller says that they are `neighbours`: that they
 * lie side by side, as samples of a pixel and those of the pixels about it do, one after the other.
 * Far away their yarns are then looked at in common, and what is seen of each is interpolated along
 * it. Of 16 and more samples a pixel's mean is within .25 % of what it is else (root mean square,
 * of presets; a lane within .6 %, at most 7), that of many pixels within 1e-4; what the draft alone
 * decides is each lane's own. By how much depends on the lanes beside it in the call. Those that
 * turn out to lie apart are what they are else.
 */
typedef struct shade_fabric_lanes {
  size_t size; /* sizeof(shade_fabric_lanes) */
  const double *u, *v, *du, *dv;
  const double *nx, *ny, *nz, *wix, *wiy, *wiz, *wox, *woy, *woz;
  const double *random; /* as shade_fabric_point's, below 0: all terms; NULL: so in every lane */
  const double *warp_r, *warp_g, *warp_b, *weft_r, *weft_g, *weft_b; /* kd */
  const double *warp_gloss, *weft_gloss, *nap;
  const double *u1, *u2, *u3; /* uniform in [0, 1), for draws */
  size_t neighbours;          /* not 0: side by side */
} shade_fabric_lanes;
typedef struct shade_fabric_lanesf {
  size_t size;
  const float *u, *v, *du, *dv;
  const float *nx, *ny, *nz, *wix, *wiy, *wiz, *wox, *woy, *woz;
  const float *random;
  const float *warp_r, *warp_g, *warp_b, *weft_r, *weft_g, *weft_b;
  const float *warp_gloss, *weft_gloss, *nap;
  const float *u1, *u2, *u3;
  size_t neighbours;
} shade_fabric_lanesf;

/* r, g, b are required for eval and sample, pdf for pdf and sample, wi for sample; the rest may be
 * NULL, and is then not computed. */
typedef struct shade_fabric_result {
  size_t size;       /* sizeof(shade_fabric_result) */
  double *r, *g, *b; /* s, in 1/sr */
  double *pdf;       /* of wi, in 1/sr */
  double *coverage;
  double *wix, *wiy, *wiz; /* what was drawn */
} shade_fabric_result;
typedef struct shade_fabric_resultf {
  size_t size;
  float *r, *g, *b;
  float *pdf;
  float *coverage;
  float *wix, *wiy, *wiz;
} shade_fabric_resultf;

/*
 * Return the or of all status bits; SHADE_BAD_INPUT, nothing written, where a structure is too
 * short for what is required or that is NULL.
 */
SHADE_API unsigned shade_fabric_eval_batch(const shade_fabric *fabric, size_t count,
                                           const shade_fabric_lanes *in, shade_fabric_tier tier,
                                           const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_eval_batchf(const shade_fabric *fabric, size_t count,
                                            const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                            const shade_fabric_resultf *out);
SHADE_API unsigned shade_fabric_pdf_batch(const shade_fabric *fabric, size_t count,
                                          const shade_fabric_lanes *in, shade_fabric_tier tier,
                                          const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_pdf_batchf(const shade_fabric *fabric, size_t count,
                                           const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                           const shade_fabric_resultf *out);
SHADE_API unsigned shade_fabric_sample_batch(const shade_fabric *fabric, size_t count,
                                             const shade_fabric_lanes *in, shade_fabric_tier tier,
                                             const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_sample_batchf(const shade_fabric *fabric, size_t count,
                                              const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                              const shade_fabric_resultf *out);

/*
 * Many hits prepared for many lights. The caller lends storage, shade_fabric_hits_size(count)
 * bytes (…f: for float), aligned as malloc does; one lane is one term of its footprint, so
 * `random` is required with AUTO and footprints (SHADE_BAD_INPUT, nothing prepared; a lane's that
 * is below 0 counts as 0, SHADE_BAD_INPUT). Of out only coverage is written; out may be NULL.
 * Afterwards the calls below read of `in` wi, or u1 to u3, alone, for the same count, as the
 * batches above do.
 */
SHADE_API size_t shade_fabric_hits_size(size_t count);
SHADE_API size_t shade_fabric_hits_sizef(size_t count);
SHADE_API unsigned shade_fabric_prepare_batch(const shade_fabric *fabric, size_t count,
                                              const shade_fabric_lanes *in, shade_fabric_tier tier,
                                              void *hits, const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_prepare_batchf(const shade_fabric *fabric, size_t count,
                                               const shade_fabric_lanesf *in,
                                               shade_fabric_tier tier, void *hits,
                                               const shade_fabric_resultf *out);
SHADE_API unsigned shade_fabric_hits_eval(const shade_fabric *fabric, size_t count,
                                          const void *hits, const shade_fabric_lanes *in,
                                          const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_hits_evalf(const shade_fabric *fabric, size_t count,
                                           const void *hits, const shade_fabric_lanesf *in,
                                           const shade_fabric_resultf *out);
SHADE_API unsigned shade_fabric_hits_pdf(const shade_fabric *fabric, size_t count, const void *hits,
                                         const shade_fabric_lanes *in,
                                         const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_hits_pdff(const shade_fabric *fabric, size_t count,
                                          const void *hits, const shade_fabric_lanesf *in,
                                          const shade_fabric_resultf *out);
SHADE_API unsigned shade_fabric_hits_sample(const shade_fabric *fabric, size_t count,
                                            const void *hits, const shade_fabric_lanes *in,
                                            const shade_fabric_result *out);
SHADE_API unsigned shade_fabric_hits_samplef(const shade_fabric *fabric, size_t count,
                                             const void *hits, const shade_fabric_lanesf *in,
                                             const shade_fabric_resultf *out);

/*
 * The directional albedo of the far model: the share of light from all sides that leaves towards
 * wo, for ambient terms and energy bounds. A table by elevation and azimuth of wo, made on
 * demand by quadrature over wi: some tenths of a second. Within 5 % where wo.z >= .1, 10 % at .05.
 * It holds its own numbers: the fabric
 * may be freed. NULL when out of memory. _eval: rgb for the whole repeat in the fabric's own
 * colours, n = z; 0 for wo.z <= 0 or non-finite wo (SHADE_BAD_INPUT). Transmitted light counts.
 */
typedef struct shade_fabric_albedo shade_fabric_albedo;
SHADE_API shade_fabric_albedo *shade_fabric_albedo_create(const shade_fabric *fabric);
SHADE_API void shade_fabric_albedo_free(shade_fabric_albedo *albedo); /* NULL is fine */
SHADE_API unsigned shade_fabric_albedo_eval(const shade_fabric_albedo *albedo, const double wo[3],
                                            double rgb[3]);

/*
 * The same for one wo of any length, without a table: the quadrature alone (within 2 % where
 * wo.z/|wo| >= .1), some milliseconds. SHADE_BAD_INPUT, and rgb is 0, when out of memory too.
 */
SHADE_API unsigned shade_fabric_albedo_towards(const shade_fabric *fabric, const double wo[3],
                                               double rgb[3]);

/* How the far model sees the fabric, for charts and tests. */
typedef struct shade_fabric_info {
  int warp_lobes, weft_lobes;            /* nodes of the mixture */
  double warp_share, weft_share;         /* what is seen of each, times its occlusion */
  double warp_single[2], weft_single[2]; /* exponents along and across, tier SINGLE */
} shade_fabric_info;
SHADE_API void shade_fabric_get_info(const shade_fabric *fabric, shade_fabric_info *info);

#ifdef __cplusplus
}
#endif
#endif
