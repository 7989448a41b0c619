/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is to be rendered. read.c fills a scene from its description; scene.c makes textures and
 * lights of it, world.c triangles and a BVH. After scene_build nothing changes any more and every
 * thread may read.
 */
#ifndef LIBSHADE_SCENE_H
#define LIBSHADE_SCENE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

#include "closure/closure.h"
#include "light/light.h"
#include "node/node.h"
#include "scene/accel.h"
#include "scene/aims.h"
#include "scene/cloth.h"
#include "scene/emitters.h"
#include "scene/motion.h"
#include "scene/object.h"
#include "system/message.h"
#include "scene/sky.h"
#include "scene/texture.h"

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

typedef enum filter_type { FILTER_BLACKMAN_HARRIS, FILTER_GAUSSIAN } filter_type;

typedef struct material {
  int number; /* material.ID of a dump */
  int pass_index;
  float matte; /* what stands for its name */
  char *name;
  unsigned status; /* of its closure's parameters: what had to be clamped */
  size_t closures; /* 1 to CLOSURES_MOST */
  closure closure[CLOSURES_MOST];
  unsigned traits; /* of all of them */
  int normal[3];   /* registers of the first one's */
  bool bare;       /* one of them takes the unperturbed normal */
  size_t nodes;    /* in the order in which they run */
  node *node;
  bool undrawn; /* whatever it shines with, its triangles are no light: rays alone find them */
  bool shines;  /* evenly, with this radiance: its triangles are a light */
  float radiance[3];
} material;

typedef struct mesh {
  size_t positions, triangles;
  const float *position;           /* 3 per position */
  const uint32_t *corner_position; /* 3 per triangle */
  const float *corner_normal;      /* 9 per triangle */
  const float *corner_uv;          /* 6 per triangle, or NULL */
  const int32_t *material;         /* 1 per triangle */
  const float **layer;             /* by layer of the scene: per corner, or NULL */
  /* where it changes its shape: how many times, and positions and normals at each */
  int steps;
  const float *moved_position, *moved_normal;
  int shapes; /* the same where the scene has `vectors`: it stands still, but for these */
  char *name;
} mesh;

typedef struct instance {
  size_t mesh;
  double matrix[12]; /* object to world, rows of 4 */
  int pass_index;    /* of its object */
  float matte[2];    /* what stands for the object's name, and its asset's */
  int hidden;        /* ray_kinds that do not see it */
  int unlit;         /* bits of lights that do not light it, */
  int shadeless;     /* and of those that it does not shade */
  uint32_t link;     /* its own bit where what it shines lights some alone, or 0 */
  uint32_t shade;    /* and where some alone shade that */
  float color[4], random, metres[2];
  const float *told; /* four numbers for each of the scene's attributes, or NULL */
  motion motion;
  size_t base;  /* of its mesh's positions among those that Embree reads */
  bool unmoved; /* it would move, but not by places that can be inverted */
} instance;

/*
 * All that shading needs to know of one triangle, world space, two cache lines.
 * A corner is normal, tangent, uv: one vector register of 8.
 */
typedef struct triangle {
  _Alignas(128) float corner[3][8];
  uint32_t material;
  float handed;    /* bitangent = handed * cross(normal, tangent) */
  float reach;     /* largest coordinate of a corner: scale of rounding errors */
  uint32_t object; /* number of its instance */
  /* Heights of the corners over each other's tangent planes, of a smooth triangle whose `curved` is
   * 1: of 1 and 2 over that of 0, 0 and 2 over 1, 0 and 1 over 2; upper halves of floats. */
  uint16_t height[6];
  uint16_t curved, mirrored; /* mirrored: its corners go round the other way */
} triangle;
_Static_assert(sizeof(triangle) == 128, "two cache lines");

/* Position of a triangle by u and v; without UVs by two of its edges. */
typedef struct stretch {
  float u[3], v[3];
} stretch;

/* A mesh that changes its shape, as it is kept: at each of its steps. */
typedef struct deform {
  int steps;
  uint32_t positions, records; /* how many at each step */
  size_t position;             /* of the first step's first, in the world's; others follow */
  size_t normal;               /* the same in moved_normal: three a record, quads' halves first */
} deform;

enum { SHUTTER_STEPS = 256 };

/* Records are numbered in 32 bits; the last number is a miss. */
#define RECORD_MISS UINT32_MAX

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

typedef struct scene {
  int width, height;
  int region[4]; /* x0 y0 x1 y1, y up */
  int samples;
  uint32_t seed;
  int threads;
  bool transparent;
  bool clears; /* it is, and glass no rougher than this alpha hides nothing from it */
  float clear_alpha;
  float reach;          /* how far rays that surfaces draw may meet something; 0: anywhere */
  bool matt_leans;      /* LEANS_AWAY, not LEANS_FADING */
  bool soft_terminator; /* smooth surfaces cast no shadows of their facets on themselves */
  float background[3];  /* 0 where there is a sky */
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
  walk_limits limits;
  float light_threshold; /* light samples that bring less are worth a shadow ray now and then; 0 */
  float blur_glossy;     /* lobes that a path meets by chance are blurred the more; 0: not */
  float texture_blur;    /* of a ray's width, over which colours of images are averaged; 0: not */
  float normal_blur;     /* over which normals of images become roughness; 0: not */
  bool no_reflected, no_refracted; /* caustics: of matt surfaces by mirrors, through glass */
  bool passes;                     /* some material lets rays pass on */
  bool holds;                      /* or leaves a hole in the picture */
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
  bool identified; /* some node asks for layers or for objects */
  bool occluded;   /* or casts rays */
  bool routed;     /* or by which way it is seen */
  bool stepped;    /* or how wide a pixel is there */
  bool moves;      /* something moves while the shutter is open: */
  bool timed;      /* not the camera alone */
  bool vectors;    /* nothing does, but a plane says where it was and will be */
  float *shutter;  /* SHUTTER_STEPS + 1 times by an even number from 0 to 1, or NULL: the same */
  bool rolls;      /* lines see one after another, from the top, each for */
  float line_time; /* this part of the time */
  /* meshes of so many triangles, and all where they are many, are kept by themselves, and another
   * scene may take the world over; 0: only where that is less work for rays */
  int apart;
  bool denoise;
  char *denoiser;                   /* path of Open Image Denoise, or NULL */
  char *dump;                       /* path, or NULL */
  char *renderer;                   /* for the dump's header */
  const struct stage_table *stages; /* chosen with the materials: what the environment says then */

  /* made by scene_build */
  size_t choices; /* lights, the sky and the emitters, where they are some */
  emitters emitters;
  aims aims;
  bool meets;                        /* drawn rays may meet light */
  bool links;                        /* some light is for some instances alone */
  bool shades;                       /* some light is shaded by some instances alone */
  bool chosen_emitters;              /* either is said of an instance that may shine */
  bool hides;                        /* some light is hidden from some kinds of ray */
  size_t triangle_count, quad_count; /* records 2q and 2q + 1 are the halves of quad q */
  triangle *triangle;
  stretch *stretch; /* by triangle, where a material asks for it */
  uint8_t *hidden;  /* by triangle: ray_kinds that do not see it; NULL where all see all */
  object *object;   /* by instance, where nodes ask */
  bool cones;       /* cloth, images or scratches ask how much a ray stands for */
  bool curved;      /* any of them, where the scene wants to know */
  placed *placed;   /* by instance of Embree; 0 is the world; NULL where there are none */
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

/* Another view of a scene that is built: its camera, size, region and samples. What was there stays
 * where the description is wrong. */
bool scene_look(reader *r, scene *s);

/* The image or sky that rays of the camera see, or NULL. */
static inline const sky *scene_seen_sky(const scene *s) {
  if (s->behind.there)
    return &s->behind;
  return s->sky.there && !(s->sky_hidden & RAY_CAMERA) ? &s->sky : NULL;
}

/* A scene that scene_free frees; NULL where its description is wrong. Its buffers stay Python's. */
scene *scene_read(reader *r);

typedef struct scene_times {
  double image, mesh, bvh;
} scene_times;

/*
 * Make the textures, the triangles and the BVH. Returns false on failure, with
 * the reason in `log`, or when *cancel became true.
 */
bool scene_build(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times);

/* What a scene that is read can use of one that is built and not needed any more, it takes over:
 * the world where the meshes are the same buffers, textures of the same images. */
void scene_take(scene *to, scene *from);

/* Free what scene_build and scene_read allocated (not the buffers of Python). NULL is fine. */
void scene_free(scene *s);

#endif
