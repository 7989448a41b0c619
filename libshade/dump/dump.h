/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The dump: one primary hit per pixel of a rendered picture, as a float32
 * OpenEXR, so that an independent program can check what a back end shaded.
 * Channels: docs/theory/conventions.md. Shared by both back ends (writer) and by `shade check`
 * (reader). OpenEXRCore is reached through a table of functions, so that a
 * plug-in can load its own copy of it.
 */
#ifndef SHADE_DUMP_H
#define SHADE_DUMP_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

enum shade_dump_channel {                           /* planes of the hit */
                          SHADE_DUMP_P,             /* 3 planes: position, world */
                          SHADE_DUMP_N = 3,         /* interpolated normal facing V, unit */
                          SHADE_DUMP_T = 6,         /* tangent, unit, orthogonal to N */
                          SHADE_DUMP_NS = 9,        /* perturbed normal, unit */
                          SHADE_DUMP_V = 12,        /* to the eye, unit */
                          SHADE_DUMP_UV = 15,       /* 2 planes */
                          SHADE_DUMP_MATERIAL = 17, /* material.ID; -1 is a miss */
                          SHADE_DUMP_COLOR = 18,    /* reflectance used as f0, RGB */
                          SHADE_DUMP_BASE = 21      /* planes before the lights' */
};
enum shade_dump_light_channel {               /* planes of each light */
                                SHADE_DUMP_L, /* to the light, unit */
                                SHADE_DUMP_E =
                                    3, /* irradiance at normal incidence, after shadowing, RGB */
                                SHADE_DUMP_S =
                                    6, /* what the back end shaded: f * cosine * E, RGB */
                                SHADE_DUMP_PER_LIGHT = 9
};

/*
 * What may vary from hit to hit, in a file only where a writer asks for it (shade_dump_add), then
 * for every hit: where nothing varies, the material's own. Planes of eta, f82 and so on: RGB.
 */
enum shade_dump_optional {
  SHADE_DUMP_OPTIONAL = 1 << 24,               /* numbers apart from those of the others */
  SHADE_DUMP_ALPHA = SHADE_DUMP_OPTIONAL,      /* 2 planes: roughness along x, y of the frame */
  SHADE_DUMP_GROOVE = SHADE_DUMP_OPTIONAL + 2, /* angle of the grooves from T, anticlockwise about
                                                  N, radians */
  SHADE_DUMP_F82 = SHADE_DUMP_OPTIONAL + 3,
  SHADE_DUMP_ETA = SHADE_DUMP_OPTIONAL + 6,
  SHADE_DUMP_K = SHADE_DUMP_OPTIONAL + 9,
  SHADE_DUMP_KD = SHADE_DUMP_OPTIONAL + 12,
  SHADE_DUMP_FOOT = SHADE_DUMP_OPTIONAL + 15,     /* 2 planes: footprint in crossings, cloth only */
  SHADE_DUMP_COVERAGE = SHADE_DUMP_OPTIONAL + 17, /* share of the ray that meets the cloth */
  SHADE_DUMP_TIER = SHADE_DUMP_OPTIONAL + 18,     /* a shade_fabric_tier */
  SHADE_DUMP_LOBE2 = SHADE_DUMP_OPTIONAL + 19,    /* SHADE_DUMP_PER_LOBE planes: a second lobe */
  SHADE_DUMP_LOBE3 = SHADE_DUMP_OPTIONAL + 26,    /* and a third */
  SHADE_DUMP_SLOPES = SHADE_DUMP_OPTIONAL + 33,   /* 5 planes: slopes of the map, along T, N x T */
  SHADE_DUMP_OPTIONAL_END = SHADE_DUMP_OPTIONAL + 38
};

/*
 * Where one lobe is not what slopes too small to be seen make of a hit, more are. Ns, alpha and
 * groove are the first's, whose share of the hit is what the others leave. A share of 0: none.
 */
enum shade_dump_lobe {
  SHADE_DUMP_LOBE_SHARE,     /* of the hit, [0, 1] */
  SHADE_DUMP_LOBE_NS,        /* 3 planes, and so on as above */
  SHADE_DUMP_LOBE_ALPHA = 4, /* 2 planes */
  SHADE_DUMP_LOBE_GROOVE = 6,
  SHADE_DUMP_PER_LOBE = 7
};

enum { SHADE_DUMP_MAX_SIDE = 65536, SHADE_DUMP_MAX_LIGHTS = 10000 };

typedef struct shade_dump {
  int width, height, lights;
  int has_color;     /* 1 from shade_dump_create; 0: no Color.*, each material's own f0 holds */
  uint64_t optional; /* a bit for each plane from SHADE_DUMP_OPTIONAL that is in the file */
  char *json;        /* header attribute `libshade`; owned */
  /* SHADE_DUMP_BASE planes, 9 of each light, then the optional ones; each of width*height, row by
   * row from the top */
  float *data;
} shade_dump;

/*
 * Allocate with material.ID = -1 and 0 elsewhere. Returns NULL when out of memory
 * or when a size is out of range: 1 to SHADE_DUMP_MAX_SIDE pixels a side, 0 to
 * SHADE_DUMP_MAX_LIGHTS lights.
 */
shade_dump *shade_dump_create(int width, int height, int lights);
void shade_dump_free(shade_dump *d); /* NULL is fine */

/* Plane of a channel (add 0..2 to the channel for its components). That of an optional channel
 * that is not in the file holds 0 and may not be written. */
float *shade_dump_plane(const shade_dump *d, int channel);
float *shade_dump_light_plane(const shade_dump *d, int light, int channel);

/* Take an optional channel into the file, with all its components; its first plane. */
float *shade_dump_add(shade_dump *d, enum shade_dump_optional channel);
/* 1 if an optional channel is in the file. */
int shade_dump_has(const shade_dump *d, enum shade_dump_optional channel);

/*
 * What a renderer puts there: {"version": …, "renderer": …, "materials": […]}, as
 * docs/theory/conventions.md has it. The material at index i has the id i. The caller frees it;
 * NULL when out of memory.
 */
typedef struct shade_dump_material {
  const char *name;
  const shade_params *params;
  const char *json; /* or NULL; else the whole material, as shade_fabric_json writes it */
} shade_dump_material;
char *shade_dump_header(const char *renderer, const shade_dump_material *materials, size_t count);

/* Replace the JSON text (copied). Returns 0, or -1 when out of memory. */
int shade_dump_set_json(shade_dump *d, const char *json);

/*
 * Plane number of the channel called `name` ("light10.S.G"), or -1; the channel's
 * name of a plane, written to name[SHADE_DUMP_NAME_SIZE]. Planes of light k follow
 * those of light k - 1, the first at SHADE_DUMP_BASE; optional ones have numbers of their own.
 */
enum { SHADE_DUMP_NAME_SIZE = 32 };
int shade_dump_channel_plane(const char *name);
void shade_dump_channel_name(int plane, char name[SHADE_DUMP_NAME_SIZE]);

/* OpenEXRCore, linked or loaded. shade_exr_api_linked is in dump_linked.c. */
struct shade_exr_api;
const struct shade_exr_api *shade_exr_api_linked(void);
/* Look every function up with a dlsym-like `symbol`. Free the result with free();
 * NULL and a message on failure. */
struct shade_exr_api *shade_exr_api_load(void *(*symbol)(void *context, const char *name),
                                         void *context, char *error, size_t error_size);

/*
 * Write or read a dump. The file appears whole or not at all (temporary file in
 * the same folder, then rename): 0 on success; -1 and a message naming the file
 * otherwise. Reading takes channels in any order, wants all but Color.* and the
 * optional ones (of either all components or none) and passes over those it does not know;
 * scanlines, one part, 32-bit float, compression none, ZIPS or ZIP. It returns NULL and a message
 * naming the file for anything else. The JSON text and the values are handed on unjudged.
 * Thread-safe.
 */
int shade_dump_write(const struct shade_exr_api *api, const char *path, const shade_dump *d,
                     char *error, size_t error_size);
shade_dump *shade_dump_read(const struct shade_exr_api *api, const char *path, char *error,
                            size_t error_size);

#ifdef __cplusplus
}
#endif
#endif
