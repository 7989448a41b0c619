/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade check: what its files share. check.c reads options and files, check_header.c the
 * materials of the header, check_hit.c the hits, check_compare.c compares them with the
 * reference, check_fabric.c knows cloths, check_report.c says what came out.
 */
#ifndef SHADE_TOOL_CHECK_H
#define SHADE_TOOL_CHECK_H

#include <stddef.h>

#include "dump/dump.h"
#include "shade/fabric.h"
#include "shade/shade.h"
#include "tool/json.h"
#include "tool/work.h"

typedef struct check_options {
  const char *path;
  double tolerance, mean_tolerance;
  int all, json, threads;
} check_options;

/* What can be wrong with a dump besides a differing S. */
typedef enum check_fault {
  FAULT_ID,
  FAULT_MISS,
  FAULT_NOT_FINITE,
  FAULT_UNIT_N,
  FAULT_UNIT_T,
  FAULT_UNIT_NS,
  FAULT_UNIT_V,
  FAULT_UNIT_L,
  FAULT_TANGENT,
  FAULT_E,
  FAULT_S,
  FAULT_REFERENCE,
  FAULT_CLOTH,
  FAULT_COVERAGE,
  FAULT_LOBE,
  FAULT_COUNT
} check_fault;

typedef struct check_material {
  int id;
  const char *name; /* in the JSON tree */
  shade_params params;
  struct check_cloth *cloth; /* NULL: none; owned */
  size_t pixels;
  double tilt; /* largest angle of Ns from N, radians: 0 means that no bump was tested */
} check_material;

/* How a value is compared: with the reference at its point; with a mean, or with lobes that stand
 * for many, and then apart from the others. */
typedef enum check_tier { CHECK_NEAR, CHECK_FAR, CHECK_SINGLE, CHECK_TIERS } check_tier;

/* Values of cloth that are judged apart. An error is relative to at least a tenth of the largest.
 */
typedef struct check_apart {
  size_t checked, over;
  double largest, beyond; /* error; and less what the reference's own doubt allows */
  double s, reference;    /* sums */
  size_t worst_pixel;
} check_apart;

/* One material under one light. */
typedef struct check_cell {
  check_apart apart[CHECK_TIERS]; /* not of CHECK_NEAR */
  double maximum;                 /* of S and of the reference */
  size_t checked;
  double largest, sum; /* relative errors */
  double asked;        /* above this error, what rounding may do there is computed */
  double doubted;      /* far hits whose doubt is above it are averaged over more points */
  double beyond;       /* the largest that is over the limit, less what rounding may do there */
  double beyond_sum;   /* the same of all: where the mean is over its limit, less that everywhere */
  size_t excused;      /* values over the limit, but not by more than rounding may do */
  size_t worst_pixel;
  int worst_channel;
  double worst_s, worst_reference, worst_rounding;
} check_cell;

typedef struct check {
  const check_options *options;
  const shade_dump *dump;
  const char *renderer;
  check_material *materials;
  int material_count;
  size_t pixels;
  check_cell *cells; /* material by material, light by light */
  int *index;        /* per pixel: its material's index, or -1: nothing to compare */
  double *reference; /* per pixel and channel, of the light at hand */
  double *doubt;     /* the same: standard error of what the reference averaged */
  double *rounding;  /* the same: what the rounding of directions may do, where that is asked */
  int far_points;    /* over so many points, so that the whole takes no minutes; see far_again() */
  size_t horizon;    /* values left out there */
  size_t faults[FAULT_COUNT], first_fault[FAULT_COUNT];
  tool_progress progress;
} check;

/* ---- the materials of the header: check_header.c ---- */

/* The materials, sorted by id. NULL after printing why. */
check_material *check_read_materials(const char *path, const json *header, int *count);
void check_free_materials(check_material *materials, int count);
/* The index of the material that a pixel's material.ID names, or -1. */
int check_find_material(const check *c, float id);

/* ---- the hits: check_hit.c ---- */

/* x = tangent, y = z x x, z = normal: the frame of the library. */
typedef struct check_frame {
  double axis[3][3];
} check_frame;

/* A lobe beside the first, in its own frame: turned from that of the first by an angle. */
typedef struct check_lobe {
  double share, n[3], alpha[2], angle;
} check_lobe;

enum { CHECK_LOBES = 2 };

/* The frame of a hit, its Ns and V in it, and the material's parameters there. */
typedef struct check_hit {
  check_frame frame;
  double n[3], wo[3];
  shade_params params;
  struct check_cloth *cloth; /* of its material */
  double uv[2], foot[2];     /* in crossings */
  shade_fabric_tier tier;
  int lobes; /* besides the first */
  check_lobe lobe[CHECK_LOBES];
} check_hit;

void check_note_fault(check *c, check_fault what, size_t pixel);
/* Three planes from `first` on. */
void check_read_three(const check *c, const float *first, size_t pixel, double v[3]);
int check_finite_three(const double v[3]);
double check_dot(const double a[3], const double b[3]);
/* Reads a direction and makes it unit in double; 0 if it was not nearly so. */
int check_read_unit(const check *c, const float *first, size_t pixel, double v[3]);
void check_to_local(const check_frame *f, const double v[3], double local[3]);
void check_set_alphas(shade_params *p, const double alpha[2]);
/* 0 with a fault noted if the hit's planes are unfit. */
int check_read_hit(check *c, size_t pixel, check_hit *h);
/* Find each pixel's material; what is no hit or unfit gets -1. */
void check_find_hits(check *c);

/* ---- the header: check_header.c ---- */

enum { CHECK_EXPECTED = 320 };
/* What a number of the table, or a choice of a list, must be: for messages. */
void check_expected_number(const shade_param_info *info, char *text, size_t size);
void check_expected_choice(shade_list list, char *text, size_t size);
/* One more of several words; *length counts what is there, from 0. */
void check_add_choice(const char *word, char *text, size_t size, size_t *length);

/* ---- cloths: check_fabric.c ---- */

typedef struct check_cloth check_cloth;
/* The object `fabric` of a material; NULL after writing what is wrong with it. */
check_cloth *check_read_fabric(const json *object, char *message, size_t size);
void check_free_fabric(check_cloth *cloth); /* NULL is fine */
/* The limits of errors of a tier that is judged apart: of one value, and of the sum of many. */
double check_limit(check_tier tier);
double check_sum_limit(check_tier tier);
/* Is `coverage` what the cloth has there? */
int check_coverage(const check_hit *h, double coverage);
check_tier check_tier_of(const check_hit *h);
/* To be called before hits of a cloth that may be of CHECK_SINGLE are shaded, by one thread. */
void check_prepare_single(check_cloth *cloth);
/* s of a hit on a cloth, and the standard error of it where it is the mean over `points`. */
void check_cloth_s(const check_hit *h, int points, const double uv[2], const double n[3],
                   const double wi[3], const double wo[3], double s[3], double doubt[3]);

/* ---- the comparison: check_compare.c ---- */

check_cell *check_cell_at(const check *c, int material_index, int light);
/* Compares all values of a light and fills its cells. -1: out of memory. */
int check_compare_light(check *c, int light);

/* ---- the verdict: check_report.c ---- */

/* Prints what came out, as text or as JSON. 1 if the dump passes. */
int check_report(const check *c);

#endif
