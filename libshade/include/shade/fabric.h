/* SPDX-License-Identifier: Apache-2.0 */
/**
 * Shading of woven cloth, from a macro shot to a figure across the room.
 *
 * Near, each point shows one yarn. A lobe that is narrow along the fibres (alternating anisotropy:
 * weft and warp are crossed) is carried by the tilt that shade_weave_lookup finds there, with any
 * of the detail methods, and a diffuse part is integrated over the fibre. Far away, a pixel holds
 * many yarns. The average over them is a mixture of lobes at nodes of the tilt. It is found once
 * from the weave itself, so that crimp, slant, occlusion, noise and any draft are in it. The
 * footprint of a pixel decides what it needs, and one passes into the other without a jump.
 * [KangFabric, corrected]
 *
 * There are two ways to call it. shade_fabric_eval and its batch answer for one pair of light and
 * eye. A renderer with several lights prepares a hit once: the look-up, the frames, what the
 * footprint holds. Then it evaluates it, asks for densities and draws directions for each light.
 *
 * Frame as in shade.h: x along u, y along v.
 *
 * Threads. A shade_fabric is set up once. Evaluation allocates nothing and holds no state. Any
 * number of threads may call it at once.
 */
#ifndef SHADE_FABRIC_H /* read once */
#define SHADE_FABRIC_H

#include "shade/shade.h"
#include "shade/weave.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * What the yarns of one direction are made of.
 *
 * Exponents are as for Ashikhmin-Shirley. Other distributions take the matching alphas,
 * e = 2/alpha^2 - 2.
 */
typedef struct shade_yarn {
  double along;  /* exponent along the fibres; smooth fibres: large, [0, 1e6] */
  double across; /* exponent across them, [0, 1e6] */
  double f0[3];  /* reflectance at normal incidence (Schlick), linear RGB, [0, 1] */
  double kd[3];  /* diffuse reflectance, linear RGB, [0, 1] */
  shade_diffuse diffuse;
} shade_yarn;

/** A cloth as its author states it. Fill it with shade_fabric_params_init. */
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

/**
 * Set every member to its default.
 *
 * These are Ashikhmin-Shirley (brdf auto), rotate, fibre diffuse, exponents 100 and 10, f0 .04, kd
 * .5, no nap, nothing transmitted, SHADE_HORIZON_VALID_ESTEVEZ, and shadows.
 *
 * @param p  the cloth to fill
 */
SHADE_API void shade_fabric_params_init(shade_fabric_params *p);

/**
 * A number of a yarn's material by its row.
 *
 * @param yarn  the yarn
 * @param row   0, 1, ...
 * @param info  out, or NULL: about it
 * @return where it is kept in *yarn, 1 or 3 numbers as info->components says; NULL past the end
 */
SHADE_API double *shade_fabric_yarn_number(shade_yarn *yarn, int row, shade_param_info *info);

/**
 * A number of a cloth by its row.
 *
 * @param p     the cloth
 * @param row   0, 1, ...
 * @param info  out, or NULL: about it
 * @return where it is kept in *p, 1 or 3 numbers as info->components says; NULL past the end
 */
SHADE_API double *shade_fabric_number(shade_fabric_params *p, int row, shade_param_info *info);

/**
 * The shape of yarns as JSON, for the header of a dump, within their ranges.
 *
 * @param p         the shape
 * @param buffer    out: the text, ended by 0; may be NULL where capacity is 0
 * @param capacity  bytes there
 * @return the length that was needed, as snprintf does
 */
SHADE_API int shade_weave_params_json(const shade_weave_params *p, char *buffer, size_t capacity);

/**
 * A cloth's material as JSON, for the header of a dump, within its ranges.
 *
 * @param p         the material
 * @param buffer    out: the text, ended by 0; may be NULL where capacity is 0
 * @param capacity  bytes there
 * @return the length that was needed, as snprintf does
 */
SHADE_API int shade_fabric_params_json(const shade_fabric_params *p, char *buffer, size_t capacity);

/**
 * A whole cloth as JSON, as one of the materials of a dump's header.
 *
 * It looks so:
 * {"id": 0, "name": "...", "fabric": {"weave": "plain", "yarns": {...}, "cloth": {...}}}. Without
 * `weave`, "draft" holds the draft as the text of a WIF.
 *
 * @param id        its number in the dump
 * @param name      its name, or NULL
 * @param draft     its draft, read where weave is NULL
 * @param weave     a name that shade_draft_named takes, or NULL
 * @param yarns     the shape of its yarns
 * @param cloth     its material
 * @param buffer    out: the text, ended by 0; may be NULL where capacity is 0
 * @param capacity  bytes there
 * @return the length that was needed, as snprintf does; -1 when out of memory
 */
SHADE_API int shade_fabric_json(int id, const char *name, const shade_draft *draft,
                                const char *weave, const shade_weave_params *yarns,
                                const shade_fabric_params *cloth, char *buffer, size_t capacity);

/** A fabric ready for evaluation. */
typedef struct shade_fabric shade_fabric;

/**
 * Make a fabric ready for evaluation. It keeps `weave`, which the caller may free at once.
 *
 * The call looks at some 10^5 points of the weave and tables the far model. That takes some tens of
 * milliseconds for the presets, and up to half a second for the largest drafts. A fabric takes .2
 * to .6 MiB, and 208 bytes for each crossing of the repeat (to 512 a side).
 *
 * Threads: the call allocates, and reads the environment as shade_bsdf_setup does.
 *
 * @param weave   what lies over what, and the shape of the yarns
 * @param p       the cloth's material; NULL: the defaults
 * @param status  NULL, or where status bits are or-ed into: SHADE_CLAMPED_PARAMETER for numbers out
 *                of range, where NaN becomes the default, SHADE_BAD_CHOICE for unknown choices,
 *                which become the first of their list
 * @return the fabric, to be freed with shade_fabric_free; NULL if weave is NULL or memory ran out
 */
SHADE_API shade_fabric *shade_fabric_create(const shade_weave *weave, const shade_fabric_params *p,
                                            unsigned *status);

/**
 * Free a fabric.
 *
 * Threads: no thread may use the fabric any more.
 *
 * @param fabric  the fabric, or NULL
 */
SHADE_API void shade_fabric_free(shade_fabric *fabric);

/**
 * How to evaluate.
 *
 * - AUTO goes by the footprint. The near model counts in it while it is below .75 crossings, the
 *   far model above 2, and both between.
 * - NEAR is the one point (u, v): what AUTO does for no footprint.
 * - FAR is the mixture, with what share of the footprint each yarn has by the draft. While there
 *   are fewer than 16 across it, each also has its own noise of width and brightness. Tables make
 *   it quick where the yarns' BRDF is Ashikhmin and Shirley's with a detail method other than none
 *   or perturb, both exponents are below 1100, the diffuse model does not see light and eye at
 *   once, and the lane's gloss is 1. Else, and where light and eye are more than 90 degrees apart,
 *   all its lobes are evaluated in turn, which takes about ten times as long.
 * - SINGLE is one lobe for the warp and one for the weft, of the right second moments, the same
 *   everywhere. It is the cheapest, for the background, and its mean colour can be far off where a
 *   dark cloth has a narrow highlight (docs/results/library.md).
 *
 * The near model in a footprint is the mean of 16 points of it. A random number r in [0, 1) picks
 * one term instead. With x the share of far, r < x is the far model. Else the point number
 * floor(16 (r - x)/(1 - x)) is the near one. The mean over r is what is had without. A path tracer
 * draws r once a hit, and eval, pdf and draw of that hit all speak of the same term.
 */
typedef enum shade_fabric_tier {
  SHADE_TIER_AUTO,
  SHADE_TIER_NEAR,
  SHADE_TIER_FAR,
  SHADE_TIER_SINGLE
} shade_fabric_tier;

/**
 * Radiance towards wo for unit irradiance at normal incidence from wi: s = f cos.
 *
 * A picture is s times irradiance. A renderer that wants f divides by |n.wi|. s is 0 where n.wo or
 * wo.z is <= 0, and where n.wi or wi.z is, by the rule of the horizon. With transmission wi may
 * come from behind (n.wi < 0 and wi.z < 0): s is then what yarns let through.
 *
 * No s is larger than what arrives allows. Over all wi the integral of s dwi is at most 1, near and
 * far, for detail methods other than perturb (test_fabric).
 *
 * @param fabric     the fabric
 * @param uv         where, in crossings (weave.h)
 * @param footprint  extent of the pixel along u and v in crossings, >= 0; NULL is 0
 * @param n          perturbed normal of the cloth as a whole (folds, a normal map), NULL for none.
 *                   It is carried by groove transport: weft yarns follow dP/du of the surface whose
 *                   normal is n, warp yarns dP/dv, and the yarn's own tilt is applied in that frame
 * @param wi         to the light, unit, local frame
 * @param wo         to the eye, unit, local frame
 * @param tier       how to evaluate
 * @param s          out: RGB in 1/sr
 * @return status bits: SHADE_CLAMPED_NORMAL; SHADE_BAD_CHOICE for an unknown tier (AUTO);
 *         SHADE_BAD_INPUT for non-finite input, a direction of length 0 or wi = -wo (0), and for a
 *         footprint that is negative or NaN (taken as 0)
 */
SHADE_API unsigned shade_fabric_eval(const shade_fabric *fabric, const double uv[2],
                                     const double footprint[2], const double n[3],
                                     const double wi[3], const double wo[3], shade_fabric_tier tier,
                                     double s[3]);

/** In float: shade_fabric_eval. */
SHADE_API unsigned shade_fabric_evalf(const shade_fabric *fabric, const float uv[2],
                                      const float footprint[2], const float n[3], const float wi[3],
                                      const float wo[3], shade_fabric_tier tier, float s[3]);

/**
 * A point of the cloth with what textures say of it there.
 *
 * Fill it with shade_fabric_point_init, which takes the fabric's own numbers, then change what
 * differs.
 */
typedef struct shade_fabric_point {
  size_t size;         /* set by shade_fabric_point_init */
  double uv[2];        /* 0 */
  double footprint[2]; /* 0 */
  double n[3];         /* (0, 0, 1) */
  double random;       /* [0, 1): which term stands for the footprint; < 0: all of them (-1); from 1
                        * on it counts as just below 1, without a status; NaN: SHADE_BAD_INPUT, as 0 */
  /* In place of the yarn's, [0, 1]. Near, what is let through is at most what it leaves of 1; far
   * it is what the fabric's own kd leaves. */
  double warp_kd[3], weft_kd[3];
  /* Scale of both exponents, [0, 1]; 1: the yarn's own. A lobe of the alpha a becomes one of
   * a^2/gloss (exponents: e gloss), near and in every lobe of the far model, by as much
   * variance. 0 counts as 1e-6. */
  double warp_gloss, weft_gloss;
  double nap; /* optical depth, [0, 10] */
} shade_fabric_point;

/** In float: shade_fabric_point. */
typedef struct shade_fabric_pointf {
  size_t size;
  float uv[2], footprint[2], n[3];
  float random;
  float warp_kd[3], weft_kd[3], warp_gloss, weft_gloss, nap;
} shade_fabric_pointf;

/**
 * Fill a point with the fabric's own numbers, at (0, 0), without a footprint.
 *
 * @param fabric  the fabric
 * @param point   the point to fill
 */
SHADE_API void shade_fabric_point_init(const shade_fabric *fabric, shade_fabric_point *point);

/** In float: shade_fabric_point_init. */
SHADE_API void shade_fabric_point_initf(const shade_fabric *fabric, shade_fabric_pointf *point);

/** Bytes of a prepared hit. */
enum { SHADE_FABRIC_HIT_SIZE = 6144, SHADE_FABRIC_HITF_SIZE = 3584 };

/**
 * A hit prepared for many lights, for the fabric it was made of.
 *
 * Its size is fixed, its contents are private, and it has no pointers to free.
 */
typedef struct shade_fabric_hit {
  union {
    double align;
    unsigned char bytes[SHADE_FABRIC_HIT_SIZE];
  } private_;
} shade_fabric_hit;

/** In float: shade_fabric_hit. */
typedef struct shade_fabric_hitf {
  union {
    double align;
    unsigned char bytes[SHADE_FABRIC_HITF_SIZE];
  } private_;
} shade_fabric_hitf;

/**
 * Prepare a hit for many lights. *hit can always be used afterwards, and is 0 for bad input.
 *
 * The coverage is the share of the eye's ray that meets something. It is 1 on yarns and where the
 * gaps have a backing. In gaps without one it is what loose fibres and the nap take of the ray. A
 * renderer that looks through the cloth adds (1 - coverage) of what is behind. s never has that
 * part. The near model's coverage is that of the point (0 or 1 but for fuzz and nap), the far
 * model's a share.
 *
 * @param fabric    the fabric
 * @param point     where; NULL, or without its size (SHADE_BAD_INPUT): the fabric's own numbers at
 *                  (0, 0)
 * @param wo        to the eye, unit, local frame
 * @param tier      how to evaluate
 * @param hit       out: the hit
 * @param coverage  out, or NULL
 * @return status bits, as for shade_fabric_eval; SHADE_CLAMPED_PARAMETER for a colour, gloss or nap
 *         of the point out of its range, which is brought into it, and for NaN, which becomes 0
 */
SHADE_API unsigned shade_fabric_prepare(const shade_fabric *fabric, const shade_fabric_point *point,
                                        const double wo[3], shade_fabric_tier tier,
                                        shade_fabric_hit *hit, double *coverage);

/** In float: shade_fabric_prepare. */
SHADE_API unsigned shade_fabric_preparef(const shade_fabric *fabric,
                                         const shade_fabric_pointf *point, const float wo[3],
                                         shade_fabric_tier tier, shade_fabric_hitf *hit,
                                         float *coverage);

/**
 * What a prepared hit reflects from wi, as shade_fabric_eval.
 *
 * @param fabric  the fabric
 * @param hit     a hit that was prepared with it
 * @param wi      to the light, unit, local frame
 * @param s       out: RGB in 1/sr
 * @return status bits
 */
SHADE_API unsigned shade_fabric_hit_eval(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                         const double wi[3], double s[3]);

/** In float: shade_fabric_hit_eval. */
SHADE_API unsigned shade_fabric_hit_evalf(const shade_fabric *fabric, const shade_fabric_hitf *hit,
                                          const float wi[3], float s[3]);

/**
 * The density with which shade_fabric_hit_sample draws wi.
 *
 * It is finite, and > 0 for every direction drawn. Its integral is 1 less the probability of draws
 * that find nothing.
 *
 * @param fabric  the fabric
 * @param hit     a hit that was prepared with it
 * @param wi      to the light, unit, local frame
 * @param status  NULL, or where status bits are or-ed into
 * @return the density of wi, per sr
 */
SHADE_API double shade_fabric_hit_pdf(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                      const double wi[3], unsigned *status);

/** In float: shade_fabric_hit_pdf. */
SHADE_API float shade_fabric_hit_pdff(const shade_fabric *fabric, const shade_fabric_hitf *hit,
                                      const float wi[3], unsigned *status);

/**
 * Draw a direction to the light. s/pdf, averaged over u, is the albedo: the integral of s.
 *
 * First a part is drawn by its reflectance: a yarn's lobe, its diffuse part, what comes through,
 * the nap, the gap. Each that is there has at least a twentieth of the draws. Near, the yarn's lobe
 * is then drawn as shade_bsdf_sample does in the frame of its fibres, tilt and fold included. Far,
 * a yarn system is drawn by its share, then one of at most 16 lobes that stand for its mixture.
 * With SINGLE it is a yarn system, then its lobe. All that is diffuse is drawn about n, and what
 * comes through about -n, half by the cosine and half evenly. The density is that of the whole
 * mixture of all these. docs/theory/conventions.md has the weights.
 *
 * A draw below a horizon finds nothing. wi, s and pdf are then 0, and it counts as 0.
 *
 * @param fabric  the fabric
 * @param hit     a hit that was prepared with it
 * @param u       three independent numbers, uniform in [0, 1); clamped to it
 * @param wi      out: to the light
 * @param s       out: RGB in 1/sr
 * @param pdf     out: the density of wi, per sr
 * @return status bits; SHADE_NO_SAMPLE where the draw found nothing
 */
SHADE_API unsigned shade_fabric_hit_sample(const shade_fabric *fabric, const shade_fabric_hit *hit,
                                           const double u[3], double wi[3], double s[3],
                                           double *pdf);

/** In float: shade_fabric_hit_sample. */
SHADE_API unsigned shade_fabric_hit_samplef(const shade_fabric *fabric,
                                            const shade_fabric_hitf *hit, const float u[3],
                                            float wi[3], float s[3], float *pdf);

/**
 * shade_fabric_prepare and shade_fabric_hit_pdf at once, for callers with one light.
 *
 * @param fabric  the fabric
 * @param point   where; NULL: the fabric's own numbers at (0, 0)
 * @param wi      to the light, unit, local frame
 * @param wo      to the eye, unit, local frame
 * @param tier    how to evaluate
 * @param status  NULL, or where status bits are or-ed into
 * @return the density of wi, per sr
 */
SHADE_API double shade_fabric_pdf(const shade_fabric *fabric, const shade_fabric_point *point,
                                  const double wi[3], const double wo[3], shade_fabric_tier tier,
                                  unsigned *status);

/** In float: shade_fabric_pdf. */
SHADE_API float shade_fabric_pdff(const shade_fabric *fabric, const shade_fabric_pointf *point,
                                  const float wi[3], const float wo[3], shade_fabric_tier tier,
                                  unsigned *status);

/**
 * shade_fabric_prepare and shade_fabric_hit_sample at once, for callers with one light.
 *
 * @param fabric  the fabric
 * @param point   where; NULL: the fabric's own numbers at (0, 0)
 * @param wo      to the eye, unit, local frame
 * @param tier    how to evaluate
 * @param u       three independent numbers, uniform in [0, 1); clamped to it
 * @param wi      out: to the light
 * @param s       out: RGB in 1/sr
 * @param pdf     out: the density of wi, per sr
 * @return status bits; SHADE_NO_SAMPLE where the draw found nothing
 */
SHADE_API unsigned shade_fabric_sample(const shade_fabric *fabric, const shade_fabric_point *point,
                                       const double wo[3], shade_fabric_tier tier,
                                       const double u[3], double wi[3], double s[3], double *pdf);

/** In float: shade_fabric_sample. */
SHADE_API unsigned shade_fabric_samplef(const shade_fabric *fabric,
                                        const shade_fabric_pointf *point, const float wo[3],
                                        shade_fabric_tier tier, const float u[3], float wi[3],
                                        float s[3], float *pdf);

/**
 * Inputs of a batch: one array per component, `count` long each.
 *
 * Set size. Members beyond it count as NULL. u, v and wo are required, and what the call reads of
 * wi (eval, pdf) or of u1, u2, u3 (sample). n, the footprint and a yarn's colour may be NULL as a
 * whole (all three, both), every other array alone: the fabric's own numbers. Outputs must not
 * overlap inputs.
 *
 * Each lane is what a single call has, unless the caller says that they are `neighbours`. Then they
 * lie side by side, one after the other, as samples of a pixel and of the pixels about it do. Far
 * away their yarns are looked at in common, and what is seen of each is interpolated along it. The
 * mean of a pixel's samples stays within a fraction of a percent. By how much a lane differs
 * depends on the lanes beside it in the call. What the draft alone decides is each lane's own.
 * Lanes that turn out to lie apart are what they are else.
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

/** In float: shade_fabric_lanes. */
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

/**
 * Outputs of a batch.
 *
 * r, g and b are required for eval and sample, pdf for pdf and sample, wi for sample. The rest may
 * be NULL, and is then not computed.
 */
typedef struct shade_fabric_result {
  size_t size;       /* sizeof(shade_fabric_result) */
  double *r, *g, *b; /* s, in 1/sr */
  double *pdf;       /* of wi, in 1/sr */
  double *coverage;
  double *wix, *wiy, *wiz; /* what was drawn */
} shade_fabric_result;

/** In float: shade_fabric_result. */
typedef struct shade_fabric_resultf {
  size_t size;
  float *r, *g, *b;
  float *pdf;
  float *coverage;
  float *wix, *wiy, *wiz;
} shade_fabric_resultf;

/**
 * shade_fabric_eval over arrays.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes
 * @param in      inputs, one array per component
 * @param tier    how to evaluate
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, where a structure is
 *         NULL or too short for what is required, or that is NULL
 */
SHADE_API unsigned shade_fabric_eval_batch(const shade_fabric *fabric, size_t count,
                                           const shade_fabric_lanes *in, shade_fabric_tier tier,
                                           const shade_fabric_result *out);

/** In float: shade_fabric_eval_batch. */
SHADE_API unsigned shade_fabric_eval_batchf(const shade_fabric *fabric, size_t count,
                                            const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                            const shade_fabric_resultf *out);

/**
 * shade_fabric_pdf over arrays.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes
 * @param in      inputs, one array per component
 * @param tier    how to evaluate
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, where a structure is
 *         NULL or too short for what is required, or that is NULL
 */
SHADE_API unsigned shade_fabric_pdf_batch(const shade_fabric *fabric, size_t count,
                                          const shade_fabric_lanes *in, shade_fabric_tier tier,
                                          const shade_fabric_result *out);

/** In float: shade_fabric_pdf_batch. */
SHADE_API unsigned shade_fabric_pdf_batchf(const shade_fabric *fabric, size_t count,
                                           const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                           const shade_fabric_resultf *out);

/**
 * shade_fabric_sample over arrays.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes
 * @param in      inputs, one array per component
 * @param tier    how to evaluate
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, where a structure is
 *         NULL or too short for what is required, or that is NULL
 */
SHADE_API unsigned shade_fabric_sample_batch(const shade_fabric *fabric, size_t count,
                                             const shade_fabric_lanes *in, shade_fabric_tier tier,
                                             const shade_fabric_result *out);

/** In float: shade_fabric_sample_batch. */
SHADE_API unsigned shade_fabric_sample_batchf(const shade_fabric *fabric, size_t count,
                                              const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                              const shade_fabric_resultf *out);

/**
 * The bytes that hits in number take, which the caller lends to shade_fabric_prepare_batch.
 *
 * @param count  number of lanes
 * @return bytes, to be aligned as malloc does
 */
SHADE_API size_t shade_fabric_hits_size(size_t count);

/** In float: shade_fabric_hits_size. */
SHADE_API size_t shade_fabric_hits_sizef(size_t count);

/**
 * Many hits prepared for many lights.
 *
 * One lane is one term of its footprint, so that `random` is required with AUTO and footprints. Of
 * out only coverage is written. Afterwards shade_fabric_hits_eval, shade_fabric_hits_pdf and
 * shade_fabric_hits_sample read of their inputs wi, or u1 to u3, alone, for the same count.
 *
 * Threads: any number at once, as long as their outputs and hits lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes
 * @param in      inputs, one array per component
 * @param tier    how to evaluate
 * @param hits    out: storage of shade_fabric_hits_size(count) bytes, aligned as malloc does
 * @param out     outputs, or NULL
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing prepared, without what is
 *         required; SHADE_BAD_INPUT also where a lane's random is below 0, and counts as 0
 */
SHADE_API unsigned shade_fabric_prepare_batch(const shade_fabric *fabric, size_t count,
                                              const shade_fabric_lanes *in, shade_fabric_tier tier,
                                              void *hits, const shade_fabric_result *out);

/** In float: shade_fabric_prepare_batch. */
SHADE_API unsigned shade_fabric_prepare_batchf(const shade_fabric *fabric, size_t count,
                                               const shade_fabric_lanesf *in,
                                               shade_fabric_tier tier, void *hits,
                                               const shade_fabric_resultf *out);

/**
 * shade_fabric_hit_eval over arrays of hits.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes, as for shade_fabric_prepare_batch
 * @param hits    what that call prepared
 * @param in      inputs, of which wi is read
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, without what is required
 */
SHADE_API unsigned shade_fabric_hits_eval(const shade_fabric *fabric, size_t count,
                                          const void *hits, const shade_fabric_lanes *in,
                                          const shade_fabric_result *out);

/** In float: shade_fabric_hits_eval. */
SHADE_API unsigned shade_fabric_hits_evalf(const shade_fabric *fabric, size_t count,
                                           const void *hits, const shade_fabric_lanesf *in,
                                           const shade_fabric_resultf *out);

/**
 * shade_fabric_hit_pdf over arrays of hits.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes, as for shade_fabric_prepare_batch
 * @param hits    what that call prepared
 * @param in      inputs, of which wi is read
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, without what is required
 */
SHADE_API unsigned shade_fabric_hits_pdf(const shade_fabric *fabric, size_t count, const void *hits,
                                         const shade_fabric_lanes *in,
                                         const shade_fabric_result *out);

/** In float: shade_fabric_hits_pdf. */
SHADE_API unsigned shade_fabric_hits_pdff(const shade_fabric *fabric, size_t count,
                                          const void *hits, const shade_fabric_lanesf *in,
                                          const shade_fabric_resultf *out);

/**
 * shade_fabric_hit_sample over arrays of hits.
 *
 * Threads: any number at once, as long as their outputs lie apart.
 *
 * @param fabric  the fabric
 * @param count   number of lanes, as for shade_fabric_prepare_batch
 * @param hits    what that call prepared
 * @param in      inputs, of which u1 to u3 are read
 * @param out     outputs, one array per component
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, without what is required
 */
SHADE_API unsigned shade_fabric_hits_sample(const shade_fabric *fabric, size_t count,
                                            const void *hits, const shade_fabric_lanes *in,
                                            const shade_fabric_result *out);

/** In float: shade_fabric_hits_sample. */
SHADE_API unsigned shade_fabric_hits_samplef(const shade_fabric *fabric, size_t count,
                                             const void *hits, const shade_fabric_lanesf *in,
                                             const shade_fabric_resultf *out);

/** A table of the directional albedo of one fabric. */
typedef struct shade_fabric_albedo shade_fabric_albedo;

/**
 * A table of the directional albedo of the far model, by elevation and azimuth of wo.
 *
 * The albedo is the share of light from all sides that leaves towards wo, for ambient terms and
 * energy bounds. Quadrature over wi makes the table, in some tenths of a second. It is within 5 %
 * where wo.z >= .1, and 10 % at .05. It holds its own numbers: the fabric may be freed.
 *
 * Threads: the call allocates.
 *
 * @param fabric  the fabric
 * @return the table, to be freed with shade_fabric_albedo_free; NULL when out of memory
 */
SHADE_API shade_fabric_albedo *shade_fabric_albedo_create(const shade_fabric *fabric);

/**
 * Free a table.
 *
 * Threads: no thread may use the table any more.
 *
 * @param albedo  the table, or NULL
 */
SHADE_API void shade_fabric_albedo_free(shade_fabric_albedo *albedo);

/**
 * The albedo of the whole repeat in the fabric's own colours, for n = z. Transmitted light counts.
 *
 * @param albedo  the table
 * @param wo      to the eye, local frame
 * @param rgb     out: RGB; 0 for wo.z <= 0 or non-finite wo
 * @return status bits; SHADE_BAD_INPUT for non-finite wo
 */
SHADE_API unsigned shade_fabric_albedo_eval(const shade_fabric_albedo *albedo, const double wo[3],
                                            double rgb[3]);

/**
 * The same for one wo, without a table: the quadrature alone, within 2 % where wo.z/|wo| >= .1.
 *
 * It takes some milliseconds.
 *
 * Threads: the call allocates what it needs, and frees it.
 *
 * @param fabric  the fabric
 * @param wo      to the eye, local frame, of any length
 * @param rgb     out: RGB
 * @return status bits; SHADE_BAD_INPUT, and 0, for non-finite wo and when out of memory
 */
SHADE_API unsigned shade_fabric_albedo_towards(const shade_fabric *fabric, const double wo[3],
                                               double rgb[3]);

/** How the far model sees the fabric, for charts and tests. */
typedef struct shade_fabric_info {
  int warp_lobes, weft_lobes;            /* nodes of the mixture */
  double warp_share, weft_share;         /* what is seen of each, times its occlusion */
  double warp_single[2], weft_single[2]; /* exponents along and across, tier SINGLE */
} shade_fabric_info;

/**
 * How the far model sees a fabric.
 *
 * @param fabric  the fabric
 * @param info    out: about it
 */
SHADE_API void shade_fabric_get_info(const shade_fabric *fabric, shade_fabric_info *info);

#ifdef __cplusplus
}
#endif
#endif
