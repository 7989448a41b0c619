/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is to be rendered. render/read.c fills a scene from its description; render/build.c makes
 * textures and lights of it, world.c triangles and a BVH. After scene_build nothing changes any
 * more and every thread may read.
 */
#ifndef LIBSHADE_SCENE_H
#define LIBSHADE_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/accel.h"
#include "scene/aims.h"
#include "scene/cloth.h"
#include "scene/emitters.h"
#include "scene/features.h"
#include "scene/geometry.h"
#include "scene/material.h"
#include "scene/motion.h"
#include "scene/object.h"
#include "scene/scratches.h"
#include "scene/sky.h"
#include "scene/texture.h"
#include "system/message.h"

/* Cameras that see around them (render/panorama.c): words in a scene. */
#define PANORAMA_TABLE(ROW)                                                                        \
  ROW(NONE)                                                                                        \
  ROW(EQUIRECTANGULAR)                                                                             \
  ROW(EQUIANGULAR_CUBEMAP_FACE)                                                                    \
  ROW(MIRRORBALL)                                                                                  \
  ROW(FISHEYE_EQUIDISTANT)                                                                         \
  ROW(FISHEYE_EQUISOLID)                                                                           \
  ROW(FISHEYE_LENS_POLYNOMIAL)                                                                     \
  ROW(CENTRAL_CYLINDRICAL)
#define PANORAMA_NUMBER(WORD) PANORAMA_##WORD,
typedef enum panorama { PANORAMA_TABLE(PANORAMA_NUMBER) } panorama;

typedef struct camera {
  bool perspective; /* or a panorama */
  panorama panorama;
  float range[4];  /* longitudes and latitudes of its sides; of a cylinder heights */
  float fov;       /* of a fisheye, radians; */
  float focal;     /* its focal length, */
  float sensor[2]; /* and what its sensor measures, in the same unit; */
  float polynomial[5];
  float axis[3][3]; /* right, up, back; unit, world */
  float origin[3];
  float frame[4]; /* x0 x1 y0 y1 of the view plane */
  float clip[2];
  float lens[2]; /* half the width and height of the aperture; 0: all is sharp */
  float focus;   /* distance of the plane that is sharp */
  int blades;    /* corners of the aperture; less than 3: an ellipse */
  float turn;    /* of the first corner's side, radians */
  motion motion;
  float *frames; /* `frame` at each of its steps, or NULL */
} camera;

/* How far what is seen fades; only a plane tells. */
typedef enum mist_falloff { MIST_LINEAR, MIST_QUADRATIC, MIST_INVERSE_QUADRATIC } mist_falloff;
typedef struct mist {
  float start, rise; /* none is before the start, nothing is left 1 / rise behind */
  mist_falloff falloff;
} mist;

/* How samples lie in a pixel: its filter is kept as so many offsets. */
typedef enum filter_type { FILTER_BLACKMAN_HARRIS, FILTER_GAUSSIAN } filter_type;
enum { FILTER_STEPS = 256 };

enum { SHUTTER_STEPS = 256 };

/* What rays that surfaces drew see where they meet nothing, if they came by some ways. */
typedef struct ray_look {
  float even[3]; /* where there is no sky */
  sky sky;
} ray_look;

enum { RAY_WAYS = 16, MAX_LOOKS = RAY_WAYS - 1 };

/* By which way a ray came, as a number; 0 for those of the camera. */
static inline unsigned ray_way(uint32_t ray) {
  return (ray & RAY_BOUNCED) / RAY_DIFFUSE + (ray & RAY_SINGULAR) / (RAY_SINGULAR / 8);
}

typedef struct light light; /* light/light.h */

typedef struct scene {
  features features;
  int width, height;
  int region[4]; /* x0 y0 x1 y1, y up */
  int samples;
  size_t share[2]; /* of them, where that is not 0: those from the first to below the second */
  uint32_t seed;
  int threads;
  float clear_alpha;   /* of glass that a transparent film is seen through */
  float reach;         /* how far rays that surfaces draw may meet something; 0: anywhere */
  float background[3]; /* 0 where there is a sky */
  sky sky;
  uint32_t sky_hidden; /* ray_kinds to which background and sky are black */
  float backdrop[3];   /* what rays of the camera see, where they see no sky */
  sky behind;          /* what they see instead of all that, if there */
  size_t looks;
  ray_look *look;
  uint8_t look_of[RAY_WAYS]; /* 1 + which, by ray_way; 0: background and sky as they light */
  filter_type filter;
  float filter_width;       /* pixels; 0: the pixel's square */
  unsigned mattes;          /* which are wanted: a bit for each matte_kind, */
  int matte_slots;          /* and how many names a pixel has of each */
  unsigned planes;          /* what is rendered beside the picture: a bit for each plane_type */
  float adaptive_threshold; /* see render/adaptive.h */
  int adaptive_least;
  float time_limit;     /* seconds for the picture; 0: as many as it takes */
  int max_bounces;      /* of a path before the surface that it sees last */
  float clamp_direct;   /* largest brightness that lights, lamps or surfaces, may add to a sample at
                           its first surface */
  float clamp_indirect; /* and all light at a later bounce; 0: any */
  bounce_limits limits;
  float light_threshold; /* light samples that bring less are worth a shadow ray now and then; 0 */
  float blur_glossy;     /* lobes that a path meets by chance are blurred the more; 0: not */
  float texture_blur;    /* of a ray's width, over which colours of images are averaged; 0: not */
  float normal_blur;     /* over which normals of images become roughness; 0: not */
  camera camera;
  mist mist;
  size_t lights, images, cloths, scratch_fields, materials, meshes, instances, layers;
  light *light;
  image *image;
  cloth *cloth;
  scratches *scratches;
  material *material;
  mesh *mesh;
  instance *instance;
  layer *layer;
  int attributes;  /* how many numbers nodes ask of objects by name, four each */
  float *shutter;  /* SHUTTER_STEPS + 1 times by an even number from 0 to 1, or NULL: the same */
  float line_time; /* of a rolling shutter: the part of the time that each line sees */
  /* meshes of so many triangles, and all where they are many, are kept by themselves, and another
   * scene may take the world over; 0: only where that is less work for rays */
  int apart;
  char *denoiser;                   /* path of Open Image Denoise, or NULL */
  char *dump;                       /* path, or NULL */
  char *renderer;                   /* for the dump's header */
  const struct stage_table *stages; /* chosen with the materials: what the environment says then */

  /* made by scene_build */
  size_t choices; /* lights, the sky and the emitters, where they are some */
  emitters emitters;
  aims aims;
  size_t triangle_count, quad_count; /* records 2q and 2q + 1 are the halves of quad q */
  triangle *triangle;
  stretch *stretch; /* by triangle, where a material asks for it */
  float finest; /* most texels across a UV map of images that are averaged, by the part of a ray */
  uint8_t *hidden; /* by triangle: ray_kinds that do not see it; NULL where all see all */
  object *object;  /* by instance, where nodes ask */
  placed *placed;  /* by instance of Embree; 0 is the world; NULL where there are none */
  size_t placed_count;
  deform *deform; /* of placed ones */
  float *moved_normal;
  texture_set textures;
  texture_set kept; /* of a scene before, and the images that they are made from */
  image *kept_image;
  void *world[3];          /* positions and indices, for Embree */
  struct world_plan *plan; /* how all these lie there, where another scene may take them over */
  bool built;
  message_list said; /* while it was built */
  bool hasty; /* a mesh of the scene before was edited, and soon may be again: see accel_input */
  accel *accel;
} scene;

/* How long it took to make each. */
typedef struct scene_times {
  double image, mesh, bvh;
} scene_times;

/* The image or sky that rays of the camera see, or NULL. */
static inline const sky *scene_seen_sky(const scene *s) {
  if (s->behind.there)
    return &s->behind;
  return s->sky.there && !(s->sky_hidden & RAY_CAMERA) ? &s->sky : NULL;
}

#endif
