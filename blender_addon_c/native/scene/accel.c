/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/accel.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/library.h"
#include "system/memory.h"
#include "system/threads.h"

/* Embree 4 has no streams, asks a ray's mask always and gives geometries one of a single bit. */
#if RTC_VERSION_MAJOR >= 4
#define EMBREE_SYSTEM "libembree4.so.4"
#define EMBREE_OF_VERSION(F)                                                                       \
  F(rtcIntersect8) F(rtcIntersect16) F(rtcOccluded8) F(rtcOccluded16) F(rtcSetGeometryMask)
#else
#define EMBREE_SYSTEM "libembree3.so.3"
#define EMBREE_OF_VERSION(F) F(rtcIntersectNp) F(rtcOccludedNp) F(rtcOccluded16)
#endif

#define EMBREE_FUNCTIONS(F)                                                                        \
  F(rtcNewDevice)                                                                                  \
  F(rtcReleaseDevice)                                                                              \
  F(rtcGetDeviceError)                                                                             \
  F(rtcGetDeviceProperty)                                                                          \
  F(rtcSetDeviceMemoryMonitorFunction)                                                             \
  F(rtcNewScene)                                                                                   \
  F(rtcReleaseScene)                                                                               \
  F(rtcCommitScene)                                                                                \
  F(rtcSetSceneBuildQuality)                                                                       \
  F(rtcSetSceneFlags)                                                                              \
  F(rtcSetSceneProgressMonitorFunction)                                                            \
  F(rtcNewGeometry)                                                                                \
  F(rtcReleaseGeometry)                                                                            \
  F(rtcSetGeometryBuildQuality)                                                                    \
  F(rtcCommitGeometry)                                                                             \
  F(rtcAttachGeometryByID)                                                                         \
  F(rtcSetSharedGeometryBuffer)                                                                    \
  F(rtcSetGeometryInstancedScene)                                                                  \
  F(rtcSetGeometryTransform)                                                                       \
  F(rtcSetGeometryTransformQuaternion)                                                             \
  F(rtcSetGeometryTimeStepCount)                                                                   \
  F(rtcSetGeometryUserData)                                                                        \
  F(rtcSetGeometryIntersectFilterFunction)                                                         \
  F(rtcSetGeometryOccludedFilterFunction)                                                          \
  EMBREE_OF_VERSION(F)

/* One table for the process, filled once: a library is never unloaded. */
#define MEMBER(name) __typeof__(&name) name;
static struct {
  EMBREE_FUNCTIONS(MEMBER)
  char error[512];
} embree;
static pthread_once_t embree_once = PTHREAD_ONCE_INIT;

/* What is hidden of a geometry, from which rays: its primitives' own, or all of an instance. */
typedef struct veil {
  const accel *of;
  const uint8_t *hidden; /* NULL: instances say */
  size_t step;
} veil;

struct accel {
  RTCDevice device;
  RTCScene scene;
  size_t parts;
  RTCScene *part; /* that instances refer to */
  bool instances, timed;
  bool veiled;         /* something is hidden from some rays */
  uint8_t *hidden;     /* by instance */
  veil own[2], shared; /* of the world's quads and triangles; of all parts */
  uint32_t camera[BATCH], shadow[BATCH];
};

/* Its header, or a later one's that is said to keep to it: 4 does with all of one number. */
static bool version_fits(long long version) {
  const bool later = RTC_VERSION_MAJOR >= 4 && version / 10000 == RTC_VERSION_MAJOR;
  return later ? version >= RTC_VERSION : version == RTC_VERSION;
}

static void embree_load(void) {
  void *library = library_open("embree", EMBREE_SYSTEM, embree.error, sizeof embree.error);
  if (!library)
    return;
    /* POSIX gives functions as void *, C11 has no conversion: copy the bits. */
#define LOAD(name)                                                                                 \
  {                                                                                                \
    void *symbol = library_symbol(library, #name);                                                 \
    if (!symbol)                                                                                   \
      snprintf(embree.error, sizeof embree.error, "Embree has no " #name);                         \
    memcpy(&embree.name, &symbol, sizeof symbol);                                                  \
  }
  EMBREE_FUNCTIONS(LOAD)
  if (embree.error[0])
    return;
  RTCDevice device = embree.rtcNewDevice("threads=1");
  if (!device) {
    snprintf(embree.error, sizeof embree.error, "Embree does not start on this machine");
    return;
  }
  long long version = embree.rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  if (!version_fits(version))
    snprintf(embree.error, sizeof embree.error,
             "Embree %lld.%lld.%lld was loaded where %s is needed", version / 10000,
             version / 100 % 100, version % 100, RTC_VERSION_STRING);
  embree.rtcReleaseDevice(device);
}

static bool go_on(void *cancel, double fraction) {
  (void)fraction;
  return !atomic_load_explicit((atomic_bool *)cancel, memory_order_relaxed);
}

/* Hits that a ray does not see are none. Rays through a surface are of no kind beside. */
static void look_away(const struct RTCFilterFunctionNArguments *arguments) {
  enum { RAY_MASK = 9, HIT_PRIMITIVE = 5, HIT_INSTANCE = 7 }; /* rows of N numbers; names: C++ */
  const veil *v = arguments->geometryUserPtr;
  const unsigned *ray = (const unsigned *)(const void *)arguments->ray;
  const unsigned *hit = (const unsigned *)(const void *)arguments->hit;
  const size_t count = arguments->N;
  for (size_t i = 0; i < count; i++) {
    unsigned kind = ray[RAY_MASK * count + i];
    kind = kind & RAY_TRANSMISSION ? (unsigned)RAY_TRANSMISSION : kind;
    if (!arguments->valid[i])
      continue;
    unsigned hidden = v->hidden ? v->hidden[v->step * hit[HIT_PRIMITIVE * count + i]]
                                : v->of->hidden[hit[HIT_INSTANCE * count + i] - ACCEL_INSTANCES];
    arguments->valid[i] = hidden & kind ? 0 : arguments->valid[i];
  }
}

static bool count_memory(void *unused, ssize_t bytes, bool after) {
  (void)unused, (void)after;
  memory_add(bytes);
  return true;
}

static void join(RTCScene scene, RTCGeometry geometry, unsigned number) {
#if RTC_VERSION_MAJOR >= 4
  embree.rtcSetGeometryMask(geometry, UINT32_MAX);
#endif
  embree.rtcCommitGeometry(geometry);
  embree.rtcAttachGeometryByID(scene, geometry, number);
  embree.rtcReleaseGeometry(geometry);
}

static void attach(accel *a, RTCScene to, enum RTCGeometryType type, unsigned number,
                   const accel_input *input, const accel_part *part, const uint32_t *index,
                   size_t count) {
  bool quads = type == RTC_GEOMETRY_TYPE_QUAD;
  if (!count)
    return;
  RTCGeometry geometry = embree.rtcNewGeometry(a->device, type);
  if (part->steps)
    embree.rtcSetGeometryTimeStepCount(geometry, (unsigned)part->steps);
  for (size_t k = 0; k < (part->steps ? (size_t)part->steps : 1); k++)
    embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, (unsigned)k,
                                      RTC_FORMAT_FLOAT3, input->position + 3 * k * part->stride, 0,
                                      3 * sizeof(float), input->positions - k * part->stride);
  embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                    quads ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3, index, 0,
                                    (quads ? 4 : 3) * sizeof(uint32_t), count);
  if (a->veiled) {
    embree.rtcSetGeometryUserData(geometry, to == a->scene ? &a->own[number] : &a->shared);
    embree.rtcSetGeometryIntersectFilterFunction(geometry, look_away);
    embree.rtcSetGeometryOccludedFilterFunction(geometry, look_away);
  }
  if (input->hasty && to != a->scene)
    embree.rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
  join(to, geometry, number);
}

static void attach_part(accel *a, RTCScene to, const accel_input *input, const accel_part *part) {
  attach(a, to, RTC_GEOMETRY_TYPE_QUAD, ACCEL_QUADS, input, part, part->quad_position, part->quads);
  attach(a, to, RTC_GEOMETRY_TYPE_TRIANGLE, ACCEL_TRIANGLES, input, part, part->triangle_position,
         part->triangles);
}

/* cancel: or NULL */
static RTCScene new_scene(accel *a, const atomic_bool *cancel) {
  RTCScene made = embree.rtcNewScene(a->device);
  if (made)
    embree.rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST); /* no holes along shared edges */
  if (made && cancel)
    embree.rtcSetSceneProgressMonitorFunction(made, go_on, (void *)(uintptr_t)cancel);
  return made;
}

/* What turns goes round, between its steps too. */
static void set_motion(RTCGeometry geometry, const motion *m) {
  embree.rtcSetGeometryTimeStepCount(geometry, (unsigned)m->steps);
  for (int k = 0; k < m->steps; k++) {
    const pose *p = &m->pose[k];
    struct RTCQuaternionDecomposition d = {.scale_x = p->shape[0],
                                           .skew_xy = p->shape[1],
                                           .skew_xz = p->shape[2],
                                           .scale_y = p->shape[3],
                                           .skew_yz = p->shape[4],
                                           .scale_z = p->shape[5],
                                           .quaternion_r = p->turn[0],
                                           .quaternion_i = p->turn[1],
                                           .quaternion_j = p->turn[2],
                                           .quaternion_k = p->turn[3],
                                           .translation_x = p->place[0],
                                           .translation_y = p->place[1],
                                           .translation_z = p->place[2]};
    embree.rtcSetGeometryTransformQuaternion(geometry, (unsigned)k, &d);
  }
}

static void attach_instance(accel *a, unsigned number, const accel_instance *instance) {
  RTCGeometry geometry = embree.rtcNewGeometry(a->device, RTC_GEOMETRY_TYPE_INSTANCE);
  embree.rtcSetGeometryInstancedScene(geometry, a->part[instance->part]);
  if (instance->motion)
    set_motion(geometry, instance->motion);
  else
    embree.rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance->matrix);
  join(a->scene, geometry, number);
}

/* Parts first: the world's tree is over their bounds. */
static enum RTCError fill(accel *a, const accel_input *input, const atomic_bool *cancel) {
  enum RTCError status = RTC_ERROR_NONE;
  for (; a->parts < input->parts && status == RTC_ERROR_NONE; a->parts++) {
    RTCScene part = a->part[a->parts] = new_scene(a, cancel);
    if (!part)
      break;
    if (input->hasty) /* both say so: else the builder is another, but no quicker one */
      embree.rtcSetSceneBuildQuality(part, RTC_BUILD_QUALITY_LOW);
    attach_part(a, part, input, &input->part[a->parts]);
    embree.rtcCommitScene(part);
    status = embree.rtcGetDeviceError(a->device);
  }
  if (a->parts < input->parts)
    return status == RTC_ERROR_NONE ? RTC_ERROR_OUT_OF_MEMORY : status;
  attach_part(a, a->scene, input, &input->world);
  for (size_t i = 0; i < input->instances; i++)
    attach_instance(a, (unsigned)(ACCEL_INSTANCES + i), &input->instance[i]);
  embree.rtcCommitScene(a->scene);
  return embree.rtcGetDeviceError(a->device);
}

/* What is hidden, where anything is. */
static bool draw_veils(accel *a, const accel_input *input) {
  if (!input->quad_hidden)
    return true;
  a->veiled = true;
  a->hidden = calloc(input->instances + 1, 1);
  for (size_t i = 0; a->hidden && i < input->instances; i++)
    a->hidden[i] = (uint8_t)input->instance[i].hidden;
  a->own[ACCEL_QUADS] = (veil){.of = a, .hidden = input->quad_hidden, .step = 2};
  a->own[ACCEL_TRIANGLES] = (veil){.of = a, .hidden = input->triangle_hidden, .step = 1};
  a->shared = (veil){.of = a};
  for (size_t i = 0; i < BATCH; i++) {
    a->camera[i] = RAY_CAMERA;
    a->shadow[i] = RAY_SHADOW;
  }
  return a->hidden != NULL;
}

/* Why there is none; empty where that was wanted. */
static void explain(enum RTCError status, char *error, size_t error_size) {
  if (status == RTC_ERROR_CANCELLED)
    error[0] = 0;
  else if (status == RTC_ERROR_OUT_OF_MEMORY)
    snprintf(error, error_size, "out of memory in Embree");
  else
    snprintf(error, error_size, "Embree cannot build the scene (error %d)", (int)status);
}

accel *accel_create(const accel_input *input, int threads, const atomic_bool *cancel, char *error,
                    size_t error_size) {
  char config[32];
  pthread_once(&embree_once, embree_load);
  if (embree.error[0]) {
    snprintf(error, error_size, "%s", embree.error);
    return NULL;
  }
  accel *a = calloc(1, sizeof *a);
  if (!a) {
    snprintf(error, error_size, "out of memory");
    return NULL;
  }
  snprintf(config, sizeof config, "threads=%d", threads);
  a->device = embree.rtcNewDevice(config);
  if (a->device)
    embree.rtcSetDeviceMemoryMonitorFunction(a->device, count_memory, NULL);
  a->scene = a->device ? new_scene(a, cancel) : NULL;
  a->part = calloc(input->parts + 1, sizeof *a->part);
  a->instances = input->instances > 0;
  a->timed = input->timed;
  enum RTCError status = RTC_ERROR_NONE;
  if (a->scene && !(a->part && draw_veils(a, input)))
    status = RTC_ERROR_OUT_OF_MEMORY;
  else if (a->scene)
    status = fill(a, input, cancel);
  if (a->scene && status == RTC_ERROR_NONE)
    return a;
  explain(status, error, error_size);
  accel_free(a);
  return NULL;
}

bool accel_place(accel *a, const accel_input *input, char *error, size_t error_size) {
  embree.rtcReleaseScene(a->scene);
  a->scene = new_scene(a, NULL);
  enum RTCError status = a->scene ? fill(a, input, NULL) : RTC_ERROR_OUT_OF_MEMORY;
  if (status != RTC_ERROR_NONE)
    explain(status, error, error_size);
  return status == RTC_ERROR_NONE;
}

void accel_free(accel *a) {
  if (!a)
    return;
  if (a->scene)
    embree.rtcReleaseScene(a->scene);
  for (size_t i = 0; a->part && i < a->parts; i++)
    embree.rtcReleaseScene(a->part[i]);
  free(a->part);
  free(a->hidden);
  if (a->device)
    embree.rtcReleaseDevice(a->device);
  free(a);
}

#define TO_PACKET(packet, of, lanes) memcpy((packet).of, (lanes) + begin, sizeof(packet).of)

#if RTC_VERSION_MAJOR >= 4
/* By packets of N. */
#define FROM_PACKET(lanes, of) memcpy((lanes) + begin, packet.of, sizeof packet.of)
#define INTERSECT(N)                                                                               \
  static void intersect_##N(const accel *a, size_t count, const uint32_t *kinds,                   \
                            struct RTCIntersectArguments *arguments, rays *ray, hits *hit) {       \
    struct RTCRayHit##N packet = {.ray = {.time = {0}}};                                           \
    _Alignas(64) int valid[N];                                                                     \
    memset(packet.ray.mask, 0xff, sizeof packet.ray.mask);                                         \
    for (size_t begin = 0; begin < count; begin += N) {                                            \
      TO_PACKET(packet.ray, org_x, ray->o.x);                                                      \
      TO_PACKET(packet.ray, org_y, ray->o.y);                                                      \
      TO_PACKET(packet.ray, org_z, ray->o.z);                                                      \
      TO_PACKET(packet.ray, tnear, ray->tnear);                                                    \
      TO_PACKET(packet.ray, dir_x, ray->d.x);                                                      \
      TO_PACKET(packet.ray, dir_y, ray->d.y);                                                      \
      TO_PACKET(packet.ray, dir_z, ray->d.z);                                                      \
      TO_PACKET(packet.ray, tfar, ray->tfar);                                                      \
      if (a->timed)                                                                                \
        TO_PACKET(packet.ray, time, ray->time);                                                    \
      if (a->veiled)                                                                               \
        TO_PACKET(packet.ray, mask, kinds);                                                        \
      for (size_t k = 0; k < N; k++)                                                               \
        valid[k] = begin + k < count && packet.ray.tfar[k] >= packet.ray.tnear[k] ? -1 : 0;        \
      memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID); /* ACCEL_MISS */                  \
      memset(packet.hit.instID, 0xff, sizeof packet.hit.instID);                                   \
      embree.rtcIntersect##N(valid, a->scene, &packet, arguments);                                 \
      FROM_PACKET(ray->tfar, ray.tfar);                                                            \
      FROM_PACKET(hit->g.x, hit.Ng_x);                                                             \
      FROM_PACKET(hit->g.y, hit.Ng_y);                                                             \
      FROM_PACKET(hit->g.z, hit.Ng_z);                                                             \
      FROM_PACKET(hit->u, hit.u);                                                                  \
      FROM_PACKET(hit->v, hit.v);                                                                  \
      FROM_PACKET(hit->primitive, hit.primID);                                                     \
      FROM_PACKET(hit->geometry, hit.geomID);                                                      \
      if (a->instances)                                                                            \
        FROM_PACKET(hit->instance, hit.instID[0]);                                                 \
    }                                                                                              \
  }
INTERSECT(8)
INTERSECT(16)

/* Rays that keep together gain by wider packets, others by narrower ones. */
static void intersect(const accel *a, size_t count, bool coherent, const uint32_t *kinds, rays *ray,
                      hits *hit) {
  struct RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  (coherent ? intersect_16 : intersect_8)(a, count, kinds, &arguments, ray, hit);
}
#else
static struct RTCRayNp ray_arrays(const accel *a, rays *ray, const uint32_t *kinds) {
  return (struct RTCRayNp){.mask = a->veiled ? (unsigned *)(uintptr_t)kinds : NULL, /* but read */
                           .time = a->timed ? ray->time : NULL,
                           .org_x = ray->o.x,
                           .org_y = ray->o.y,
                           .org_z = ray->o.z,
                           .tnear = ray->tnear,
                           .dir_x = ray->d.x,
                           .dir_y = ray->d.y,
                           .dir_z = ray->d.z,
                           .tfar = ray->tfar};
}

static void intersect(const accel *a, size_t count, bool coherent, const uint32_t *kinds, rays *ray,
                      hits *hit) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  struct RTCRayHitNp all = {.ray = ray_arrays(a, ray, kinds),
                            .hit = {.Ng_x = hit->g.x,
                                    .Ng_y = hit->g.y,
                                    .Ng_z = hit->g.z,
                                    .u = hit->u,
                                    .v = hit->v,
                                    .primID = hit->primitive,
                                    .geomID = hit->geometry,
                                    .instID = {a->instances ? hit->instance : NULL}}};
  memset(hit->geometry, 0xff, count * sizeof *hit->geometry); /* ACCEL_MISS */
  if (a->instances)
    memset(hit->instance, 0xff, count * sizeof *hit->instance);
  embree.rtcIntersectNp(a->scene, &context, &all, (unsigned)count);
}
#endif

void accel_intersect(const accel *a, size_t count, ray_kind kind, const uint32_t *kinds, rays *ray,
                     hits *hit) {
  kinds = kind == RAY_CAMERA ? a->camera : kind == RAY_SHADOW ? a->shadow : kinds;
  intersect(a, count, kind == RAY_CAMERA, kinds, ray, hit);
  for (size_t i = 0; a->instances && i < count; i++)
    hit->instance[i] =
        hit->instance[i] == RTC_INVALID_GEOMETRY_ID ? 0 : hit->instance[i] - ACCEL_INSTANCES + 1;
}

#if RTC_VERSION_MAJOR >= 4
typedef struct RTCOccludedArguments occluded_ask;
#define OCCLUDED(N, valid, packet, ask) embree.rtcOccluded##N(valid, a->scene, packet, ask)
#else
typedef struct RTCIntersectContext occluded_ask;
#define OCCLUDED(N, valid, packet, ask) embree.rtcOccluded##N(valid, a->scene, ask, packet)
#endif

/* Rays that keep together, as they lie; lanes have room for a whole last packet. */
static void occlude_together(const accel *a, size_t count, occluded_ask *ask, rays *ray) {
  struct RTCRay16 packet = {.time = {0}};
  _Alignas(64) int valid[16];
  memset(packet.mask, 0xff, sizeof packet.mask);
  for (size_t begin = 0; begin < count; begin += 16) {
    TO_PACKET(packet, org_x, ray->o.x);
    TO_PACKET(packet, org_y, ray->o.y);
    TO_PACKET(packet, org_z, ray->o.z);
    TO_PACKET(packet, tnear, ray->tnear);
    TO_PACKET(packet, dir_x, ray->d.x);
    TO_PACKET(packet, dir_y, ray->d.y);
    TO_PACKET(packet, dir_z, ray->d.z);
    TO_PACKET(packet, tfar, ray->tfar);
    if (a->timed)
      TO_PACKET(packet, time, ray->time);
    if (a->veiled)
      TO_PACKET(packet, mask, a->shadow);
    for (size_t k = count - begin; k < 16; k++) /* Embree 3 has asked them, whatever is valid, */
      packet.tfar[k] = -1.0f;                   /* where packets of 16 are none of the CPU's own */
    for (size_t k = 0; k < 16; k++)
      valid[k] = packet.tfar[k] >= packet.tnear[k] ? -1 : 0;
    OCCLUDED(16, valid, &packet, ask);
    memcpy(ray->tfar + begin, packet.tfar, sizeof packet.tfar);
  }
}

/* Never said to be coherent: some rays then made Embree 3.13 go round for ever
 * (tests/test_native_shadow.py has them). */
#if RTC_VERSION_MAJOR >= 4
/* Others by packets full of those that have a length: many shadow rays have none. */
static void occlude_apart(const accel *a, size_t count, occluded_ask *ask, rays *ray) {
  struct RTCRay8 packet = {.time = {0}};
  _Alignas(64) int valid[8];
  size_t lane[8], used = 0;
  memset(packet.mask, 0xff, sizeof packet.mask);
  for (size_t i = 0; i < count; i++) {
    if (ray->tfar[i] >= ray->tnear[i]) {
      packet.org_x[used] = ray->o.x[i];
      packet.org_y[used] = ray->o.y[i];
      packet.org_z[used] = ray->o.z[i];
      packet.tnear[used] = ray->tnear[i];
      packet.dir_x[used] = ray->d.x[i];
      packet.dir_y[used] = ray->d.y[i];
      packet.dir_z[used] = ray->d.z[i];
      packet.tfar[used] = ray->tfar[i];
      if (a->timed)
        packet.time[used] = ray->time[i];
      if (a->veiled)
        packet.mask[used] = a->shadow[i];
      lane[used++] = i;
    }
    if (used < 8 && i + 1 < count)
      continue;
    for (size_t k = 0; k < 8; k++)
      valid[k] = k < used ? -1 : 0;
    OCCLUDED(8, valid, &packet, ask);
    for (size_t k = 0; k < used; k++)
      ray->tfar[lane[k]] = packet.tfar[k];
    used = 0;
  }
}

void accel_occluded(const accel *a, size_t count, bool coherent, rays *ray) {
  occluded_ask ask;
  rtcInitOccludedArguments(&ask);
  ask.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  (coherent ? occlude_together : occlude_apart)(a, count, &ask, ray);
}
#else
void accel_occluded(const accel *a, size_t count, bool coherent, rays *ray) {
  occluded_ask ask;
  rtcInitIntersectContext(&ask);
  ask.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  if (coherent) {
    occlude_together(a, count, &ask, ray);
    return;
  }
  struct RTCRayNp all = ray_arrays(a, ray, a->shadow);
  embree.rtcOccludedNp(a->scene, &ask, &all, (unsigned)count);
}
#endif
