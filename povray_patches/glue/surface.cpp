// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/surface.h"

#include <cmath>

#include "backend/colour/colour.h"
#include "backend/math/matrices.h"
#include "backend/mdf/tangents.h"
#include "backend/mdf/texturespace.h"
#include "backend/mdf/vectors.h"
#include "backend/scene/scene.h"
#include "backend/scene/threaddata.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

using namespace glue;

namespace {

bool same(const Vector3d &a, const Vector3d &b) {
  return a[X] == b[X] && a[Y] == b[Y] && a[Z] == b[Z];
}

const mdf::Shape &shape_of(const ObjectBase *object) {
  static const mdf::Shape unknown(mdf::Shape::OTHER);
  return object->Mdf_Shape != NULL ? *object->Mdf_Shape : unknown;
}

// The shading frame of a hit. To be worked out in this order: its place in the (u, v) plane, its
// normals, its tangent.
struct ShadingFrame {
  ShadingFrame(const FINISH *f, const Intersection &i, const TextureSpace &s,
               const Vector3d &geometric, const Vector3d &shading, const Vector3d &eye, bool dump);

  void find_directions(TraceThreadData *thread);
  void perturb_normal(double width);
  void find_tangent();
  // What bumps too small to be seen make of the lobes. level: of Material::regularized, or -1.
  void widen(mdf::ShadedPoint &shaded, int level) const;
  mdf::ClothPlace place_on_cloth(double width, bool mirrored) const;
  // Whether its cloth is to be seen as in a mirror.
  bool mirrored() const;

  const FINISH *const finish;
  const mdf::Material &material;
  const Intersection &isect;
  const TextureSpace &space;
  const mdf::Shape &shape;
  const bool dumped, cloth, by_axis, bumped, scratched;
  const bool any_tangent_will_do; // what Lambert's law shines is the same for each
  const Vector3d N, V;
  Vector3d Ns, T;

  UV_VECT uv;
  bool has_directions; // du and dv are known
  bool radial;         // the plane goes round the axis of `tangent radial`
  bool orthogonal;     // du is orthogonal to N already
  Vector3d du, dv;
  Vector3d outside; // the object's own normal, where it counts which side that is on

  Vector3d map_x, map_y;             // of the frame of normal maps
  double covariance[3];              // of the slopes of a bump image, there
  Slopes scratches;                  // likewise
  Vector3d smooth, scratched_normal; // means beside scratches, and in them

private:
  void add_scratches(const double footprint[4]);
  bool upright_tangent();
  PlaneTransform plane() const {
    return radial ? PlaneTransform() : PlaneTransform(finish->Mdf_Plane);
  }
};

ShadingFrame::ShadingFrame(const FINISH *f, const Intersection &i, const TextureSpace &s,
                           const Vector3d &geometric, const Vector3d &shading, const Vector3d &eye,
                           bool dump)
    : finish(f), material(*f->Mdf), isect(i), space(s), shape(shape_of(i.Object)), dumped(dump),
      cloth(material.cloth != NULL), by_axis(!cloth && material.by_axis()),
      bumped(material.bump && shape.has_uv()), scratched(material.field != NULL),
      any_tangent_will_do(!cloth && !dumped && material.diffuse_only &&
                          material.params.diffuse == SHADE_DIFFUSE_LAMBERT && !bumped &&
                          !scratched),
      N(geometric), V(eye), Ns(shading), uv(), has_directions(false), radial(false),
      orthogonal(false), covariance(), smooth(shading), scratched_normal(shading) {}

void ShadingFrame::find_directions(TraceThreadData *thread) {
  if (shape.has_uv() && (bumped || dumped || cloth || scratched))
    isect.Object->UVCoord(uv, &isect, thread);
  if ((by_axis || any_tangent_will_do) && !bumped && !scratched)
    return;

  // a texture that is not turned by itself needs no dP/dv
  const bool turned = finish->Mdf_Plane[X][Y] != 0.0 || !(finish->Mdf_Plane[X][X] > 0.0);
  const bool both = bumped || turned || cloth || scratched;
  if (bumped || (both && shape.kind == mdf::Shape::MESH)) {
    Intersection copy(isect); // Normal() wants to write to it
    isect.Object->Normal(*outside, &copy, thread);
  }
  orthogonal = !both && !shape.has_uv();
  // a box's UV coordinates unfold it, each side to its own scale: cloth keeps that of the scene
  const bool by_side = shape.kind == mdf::Shape::BOX && !bumped;
  const bool planar = (cloth || scratched) && (!shape.has_uv() || by_side);
  radial = planar && !cloth && material.tangent == mdf::Material::TANGENT_RADIAL;
  has_directions = radial   ? space.radial_plane(N, uv, du, dv)
                   : planar ? planar_plane(shape.kind, isect, N, uv, du, dv)
                            : uv_directions(shape, isect, N, outside, thread, both, du, dv);
}

void ShadingFrame::perturb_normal(double width) {
  if (!(bumped || scratched) || !has_directions)
    return;
  const bool front =
      !bumped || (dot(outside, N) > 0.0) != (Test_Flag(isect.Object, INVERTED_FLAG) != 0);
  double footprint[4];
  uv_footprint(du, dv, V, material.spreads_bumps() ? width : 0.0, footprint);
  if (!map_frame(N, front, du, dv, map_x, map_y))
    return;
  if (bumped)
    Ns = add_slopes(Ns, image_normal(material, uv, footprint, map_x, map_y, N, covariance), N);
  smooth = scratched_normal = Ns;
  if (scratched)
    add_scratches(footprint);
}

void ShadingFrame::add_scratches(const double footprint[4]) {
  scratches = scratch_slopes(material, plane(), uv, footprint);
  if (!(scratches.share > 0.0))
    return;
  const Vector3d down = scratches.mean[0] * map_x + scratches.mean[1] * map_y;
  scratched_normal = add_slopes(smooth, (N - down).normalized(), N);
  Ns = add_slopes(smooth, (N - scratches.share * down).normalized(), N);
}

void ShadingFrame::find_tangent() {
  if (any_tangent_will_do)
    T = fabs(N[X]) < 0.7 ? axis_vector(X) : axis_vector(Z);
  else if (by_axis)
    T = space.tangent(Vector3d(material.axis));
  else if (has_directions)
    T = orthogonal ? du : finish->Mdf_Plane[X][X] * du + finish->Mdf_Plane[X][Y] * dv;
  if ((orthogonal && has_directions) || orthogonalise(T, N))
    return;
  if (!upright_tangent())
    T = any_tangent(N);
}

// Where what is asked for stands upright on the surface: another axis in its place, or u where it
// is the texture's x axis that does.
bool ShadingFrame::upright_tangent() {
  if (material.tangent == mdf::Material::TANGENT_AXIS && by_axis)
    T = space.tangent(any_tangent(Vector3d(material.axis).normalized()));
  else
    T = du;
  return (by_axis || has_directions) && orthogonalise(T, N);
}

void ShadingFrame::widen(mdf::ShadedPoint &shaded, int level) const {
  if (!(bumped || scratched) || !has_directions)
    return;
  const Vector3d B = cross(N, T); // the frame's y axis, as ShadedPoint has it
  const double a = dot(T, map_x), b = dot(T, map_y), c = dot(B, map_x), d = dot(B, map_y);
  double k[3] = {covariance[0], covariance[1], covariance[2]};
  // Slopes of a plate with scratches are 0, or theirs: one lobe for all of them would be wrong.
  for (int scratch = 0; scratch < 2; scratch++) {
    const double share = scratch ? scratches.share : 1.0 - scratches.share;
    if (!(share > 0.0))
      continue;
    for (int i = 0; scratch && i < 3; i++)
      k[i] += scratches.covariance[i];
    const double local[3] = {a * a * k[0] + 2.0 * a * b * k[1] + b * b * k[2],
                             a * c * k[0] + (a * d + b * c) * k[1] + b * d * k[2],
                             c * c * k[0] + 2.0 * c * d * k[1] + d * d * k[2]};
    shaded.roughen(share, scratch ? *scratched_normal : *smooth, local, scratch ? 2 : 1, level);
  }
}

mdf::ClothPlace ShadingFrame::place_on_cloth(double width, bool as_mirrored) const {
  const mdf::ClothPlace nowhere = {{0.0, 0.0}, {0.0, 0.0}, false};
  return has_directions
             ? cloth_place(*material.cloth, plane(), uv, du, dv, N, T, V, width, as_mirrored)
             : nowhere;
}

bool ShadingFrame::mirrored() const {
  const TRANSFORM *const moved = isect.Object->UV_Trans;
  return cloth && material.cloth->mirrored &&
         (moved != NULL && determinant(moved->matrix) < 0.0) != (plane().det < 0.0);
}

// Puts the hit into a dump. False where it holds another layer's already, or has no room: for the
// colours of yarns, or for fibres that run elsewhere than the grooves.
bool record_hit(mdf::Dump &dump, int pixel, const mdf::ShadedPoint &shaded,
                const ShadingFrame &frame, const double rgb[3], const mdf::ClothPlace *place,
                double gaps) {
  const mdf::Material &material = shaded.of();
  mdf::LobeSeen lobes[mdf::ShadedPoint::MOST_LOBES];
  const int count = shaded.lobes(lobes);
  bool turned = false;

  for (int i = 0; i < count; i++)
    turned = turned || lobes[i].angle != 0.0;
  if (material.cloth && material.has_pigment())
    return false;
  if (turned && material.has_diffuse && material.params.diffuse != SHADE_DIFFUSE_LAMBERT)
    return false;
  double slopes[5];
  shaded.slopes(slopes);
  return dump.hit(pixel, &material, frame.isect.IPoint, frame.uv, *frame.N, *frame.T, *frame.V, rgb,
                  place, gaps, lobes, count, slopes, shaded.left_handed());
}

} // namespace

void Transform_Mdf(FINISH *finish, const TRANSFORM *transform, bool with_object) {
  if (finish == NULL || finish->Mdf == NULL)
    return;
  MTimesA(finish->Mdf_Space, transform->matrix);
  if (!with_object)
    MTimesA(finish->Mdf_Plane, transform->matrix);
}

void MdfHit::Prepare(const FINISH *finish, const Intersection &isect, const Ray &ray,
                     const Vector3d &raw_normal, const Vector3d &layer_normal,
                     const std::vector<const TEXTURE *> &warps, const Vector3d &ipoint,
                     double opaque, TraceThreadData *thread, mdf::Dump *d, int p, double roughness,
                     double width, const RGBColour &pigment) {
  const mdf::Material &material = *finish->Mdf;
  const bool cloth = material.cloth != NULL, dumped = p >= 0;

  dump = NULL;
  pixel = -1;
  global_lights = 0;
  opacity = opaque;
  place[U] = place[V] = 0.0;
  both_sides = simple = false;
  level = mdf::Material::level_of(roughness);
  if (cloth && !material.prepared_cloth) // no object that shows it was announced
    return;

  const double rgb[3] = {pigment.red(), pigment.green(), pigment.blue()};
  both_sides = Test_Flag(isect.Object, DOUBLE_ILLUMINATE_FLAG) != 0;
  // nothing tells one part from the other
  const bool whole =
      !material.has_pigment() && (!material.has_diffuse || (opacity == 1.0 && !both_sides));
  if (material.lambert && !dumped && same(raw_normal, layer_normal)) {
    shaded.set_lambert(&material, *unit(raw_normal));
    if (material.has_pigment())
      shaded.set_pigment(rgb);
    simple = whole;
    return;
  }

  const TextureSpace space(finish, isect, warps, ipoint);
  ShadingFrame frame(finish, isect, space, unit(raw_normal), unit(layer_normal),
                     -unit(Vector3d(ray.Direction)), dumped);
  frame.find_directions(thread);
  frame.perturb_normal(width);
  frame.find_tangent();
  const bool mirrored = frame.mirrored();
  shaded.set(&material, *frame.N, *frame.T, *frame.Ns, *frame.V, mirrored);
  if (frame.bumped)
    Assign_UV_Vect(place, frame.uv);
  if (material.relief && frame.bumped)
    shaded.set_slopes(place);
  if (material.has_pigment())
    shaded.set_pigment(rgb);
  mdf::ClothPlace place;
  if (cloth) {
    place = frame.place_on_cloth(width, mirrored);
    place.far = level >= 0 || ray.IsRadiosityRay();
    gaps = 1.0 - shaded.prepare_cloth(place);
  } else
    frame.widen(shaded, level);
  simple = whole && !cloth && level < 0 && !shaded.is_rough();

  if (dumped && record_hit(*d, p, shaded, frame, rgb, cloth ? &place : NULL, gaps)) {
    dump = d;
    pixel = p;
    global_lights = (int)thread->GetSceneData()->lightSources.size();
  }
}

bool Mdf_Is_Open(const FINISH *finish) {
  return finish != NULL && finish->Mdf != NULL && finish->Mdf->cloth && finish->Mdf->cloth->open();
}

double MdfHit::ShadowGaps(const FINISH *finish, const Intersection &isect, const Ray &ray,
                          const Vector3d &raw_normal, TraceThreadData *thread, double width) {
  if (!Mdf_Is_Open(finish))
    return 0.0;
  const Vector3d facing = dot(raw_normal, Vector3d(ray.Direction)) > 0.0 ? -raw_normal : raw_normal;
  MdfHit hit;
  hit.Prepare(finish, isect, ray, facing, facing, std::vector<const TEXTURE *>(),
              Vector3d(isect.IPoint), 1.0, thread, NULL, -1, 0.0, width);
  return hit.Gaps();
}

void MdfHit::AddLight(const VECTOR direction, const RGBColour &light_colour, bool highlight,
                      bool diffuse, const LightSource *light, RGBColour &colour) const {
  const mdf::Material &material = shaded.of();
  const double E[3] = {M_PI * light_colour.red(), M_PI * light_colour.green(),
                       M_PI * light_colour.blue()};
  const bool recorded = dump != NULL && light != NULL && highlight;
  double S[3];

  if (simple && highlight && (diffuse || !material.has_diffuse)) {
    shaded.eval_smooth(direction, E, S);
    colour += rgb_colour(S);
    if (recorded)
      Record(light, direction, E, S);
    return;
  }

  const bool behind = !shaded.above(direction), cloth = material.cloth != NULL;
  // what double_illuminate lets through shines as from the other side
  const Vector3d through = -Vector3d(direction);
  const bool turned = behind && both_sides && !(cloth && material.cloth->transmits());
  const double *const from = turned ? *through : direction;

  if (cloth) { // all of it goes where what is diffuse goes
    if (!highlight && !diffuse)
      return;
    shaded.eval(mdf::ShadedPoint::ALL, -1, from, E, S);
    colour += rgb_colour(S) * opacity;
    if (recorded && !turned)
      Record(light, direction, E, S);
    return;
  }
  if (recorded)
    RecordParts(light, direction, E);
  if (highlight) {
    shaded.eval(mdf::ShadedPoint::SPECULAR, level, direction, E, S);
    colour += rgb_colour(S);
  }
  if (diffuse && material.has_diffuse) {
    shaded.eval(mdf::ShadedPoint::DIFFUSE, -1, from, E, S);
    colour += rgb_colour(S) * opacity;
  }
}

void MdfHit::RecordParts(const LightSource *light, const VECTOR direction,
                         const double E[3]) const {
  double S[3], part[3];

  shaded.eval(mdf::ShadedPoint::SPECULAR, -1, direction, E, S);
  if (shaded.of().has_diffuse) {
    shaded.eval(mdf::ShadedPoint::DIFFUSE, -1, direction, E, part);
    for (int c = 0; c < 3; c++)
      S[c] += part[c];
  }
  Record(light, direction, E, S);
}

void MdfHit::Record(const LightSource *light, const VECTOR direction, const double E[3],
                    const double S[3]) const {
  dump->light(pixel, (int)light->index + (light->lightGroupLight ? global_lights : 0), direction, E,
              S, shaded.left_handed());
}

bool MdfHit::Meets(const VECTOR direction) const {
  return shaded.faces(direction);
}

RGBColour MdfHit::Between(const RGBColour &transparency, double gaps) {
  return transparency + (RGBColour(1.0) - transparency) * gaps;
}

RGBColour MdfHit::DiffuseAlbedo() const {
  double albedo[3] = {0.0, 0.0, 0.0};

  if (HasBlock())
    shaded.diffuse_albedo(albedo);
  return rgb_colour(albedo);
}

RGBColour MdfHit::SpecularAlbedo() const {
  double albedo[3] = {0.0, 0.0, 0.0};

  if (HasBlock())
    shaded.specular_albedo(albedo);
  return rgb_colour(albedo);
}

RGBColour MdfHit::ConservedAlbedo() const {
  return HasBlock() && shaded.of().cloth ? RGBColour(0.0) : SpecularAlbedo();
}

} // namespace pov
