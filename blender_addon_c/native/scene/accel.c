/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/accel.h"

#include <embree3/rtcore.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/library.h"

#define EMBREE_LIBRARY "libembree3.so.3"

#define EMBREE_FUNCTIONS(F)                                                                        \
  F(rtcNewDevice)                                                                                  \
  F(rtcReleaseDevice)                                                                              \
  F(rtcGetDeviceError)                                                                             \
  F(rtcGetDeviceProperty)                                                                          \
  F(rtcNewScene)                                                                                   \
  F(rtcReleaseScene)                                                                               \
  F(rtcCommitScene)                                                                                \
  F(rtcSetSceneFlags)                                                                              \
  F(rtcSetSceneProgressMonitorFunction)                                                            \
  F(rtcNewGeometry)                                                                                \
  F(rtcReleaseGeometry)                                                                            \
  F(rtcCommitGeometry)                                                                             \
  F(rtcAttachGeometryByID)                                                                         \
  F(rtcSetSharedGeometryBuffer)                                                                    \
  F(rtcIntersectNp)                                                                                \
  F(rtcOccludedNp)

/* One table for the process, filled once: a library is never unloaded. */
#define MEMBER(name) __typeof__(&name) name;
static struct {
  EMBREE_FUNCTIONS(MEMBER)
  char error[256];
} embree;
static pthread_once_t embree_once = PTHREAD_ONCE_INIT;

struct accel {
  RTCDevice device;
  RTCScene scene;
};

static void embree_load(void) {
  void *library = library_open(EMBREE_LIBRARY, embree.error, sizeof embree.error);
  if (!library)
    return;
    /* POSIX gives functions as void *, C11 has no conversion: copy the bits. */
#define LOAD(name)                                                                                 \
  {                                                                                                \
    void *symbol = library_symbol(library, #name);                                                 \
    if (!symbol)                                                                                   \
      snprintf(embree.error, sizeof embree.error, EMBREE_LIBRARY " has no " #name);                \
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
  if (version != RTC_VERSION)
    snprintf(embree.error, sizeof embree.error,
             "Embree %lld.%lld.%lld was loaded where %s is needed", version / 10000,
             version / 100 % 100, version % 100, RTC_VERSION_STRING);
  embree.rtcReleaseDevice(device);
}

static bool go_on(void *cancel, double fraction) {
  (void)fraction;
  return !atomic_load_explicit((atomic_bool *)cancel, memory_order_relaxed);
}

static void attach(accel *a, enum RTCGeometryType type, unsigned number, const accel_input *input,
                   const uint32_t *index, size_t count, enum RTCFormat format,
                   size_t corners_per_primitive) {
  if (!count)
    return;
  RTCGeometry geometry = embree.rtcNewGeometry(a->device, type);
  embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    input->position, 0, 3 * sizeof(float), input->positions);
  embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, format, index, 0,
                                    corners_per_primitive * sizeof(uint32_t), count);
  embree.rtcCommitGeometry(geometry);
  embree.rtcAttachGeometryByID(a->scene, geometry, number);
  embree.rtcReleaseGeometry(geometry);
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
  a->scene = a->device ? embree.rtcNewScene(a->device) : NULL;
  enum RTCError status = RTC_ERROR_NONE;
  if (a->scene) {
    embree.rtcSetSceneFlags(a->scene, RTC_SCENE_FLAG_ROBUST); /* no holes along shared edges */
    embree.rtcSetSceneProgressMonitorFunction(a->scene, go_on, (void *)(uintptr_t)cancel);
    attach(a, RTC_GEOMETRY_TYPE_QUAD, ACCEL_QUADS, input, input->quad_position, input->quads,
           RTC_FORMAT_UINT4, 4);
    attach(a, RTC_GEOMETRY_TYPE_TRIANGLE, ACCEL_TRIANGLES, input, input->triangle_position,
           input->triangles, RTC_FORMAT_UINT3, 3);
    embree.rtcCommitScene(a->scene);
    status = embree.rtcGetDeviceError(a->device);
  }
  if (a->scene && status == RTC_ERROR_NONE)
    return a;
  if (status == RTC_ERROR_CANCELLED)
    error[0] = 0;
  else if (status == RTC_ERROR_OUT_OF_MEMORY)
    snprintf(error, error_size, "out of memory in Embree");
  else
    snprintf(error, error_size, "Embree cannot build the scene (error %d)", (int)status);
  accel_free(a);
  return NULL;
}

void accel_free(accel *a) {
  if (!a)
    return;
  if (a->scene)
    embree.rtcReleaseScene(a->scene);
  if (a->device)
    embree.rtcReleaseDevice(a->device);
  free(a);
}

static struct RTCRayNp ray_arrays(rays *ray) {
  return (struct RTCRayNp){.org_x = ray->o.x,
                           .org_y = ray->o.y,
                           .org_z = ray->o.z,
                           .tnear = ray->tnear,
                           .dir_x = ray->d.x,
                           .dir_y = ray->d.y,
                           .dir_z = ray->d.z,
                           .tfar = ray->tfar};
}

void accel_intersect(const accel *a, size_t count, bool coherent, rays *ray, hits *hit) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  struct RTCRayHitNp all = {.ray = ray_arrays(ray),
                            .hit = {.Ng_x = hit->g.x,
                                    .Ng_y = hit->g.y,
                                    .Ng_z = hit->g.z,
                                    .u = hit->u,
                                    .v = hit->v,
                                    .primID = hit->primitive,
                                    .geomID = hit->geometry}};
  memset(hit->geometry, 0xff, count * sizeof *hit->geometry); /* ACCEL_MISS */
  embree.rtcIntersectNp(a->scene, &context, &all, (unsigned)count);
}

void accel_occluded(const accel *a, size_t count, bool coherent, rays *ray) {
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  struct RTCRayNp all = ray_arrays(ray);
  embree.rtcOccludedNp(a->scene, &context, &all, (unsigned)count);
}
