// SPDX-License-Identifier: AGPL-3.0-or-later

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"
#include "backend/mdf/relief.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "backend/bounding/bbox.h"
#include "backend/mdf/notes.h"
#include "backend/mdf/surface.h"
#include "backend/mdf/vectors.h"
#include "backend/parser/parse.h"
#include "backend/render/trace.h"
#include "backend/scene/scene.h"
#include "backend/scene/threaddata.h"
#include "backend/shape/blob.h"
#include "backend/shape/csg.h"
#include "backend/shape/mesh.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

namespace {

void collect_blocks(const TEXTURE *texture, MdfBlocks &blocks) {
  for (; texture != NULL; texture = reinterpret_cast<const TEXTURE *>(texture->Next)) {
    if (texture->Type == PLAIN_PATTERN && texture->Finish != NULL && texture->Finish->Mdf != NULL)
      blocks.insert(texture->Finish);
    if (texture->Type == BITMAP_PATTERN)
      for (const TEXTURE *m = texture->Materials; m != NULL; m = m->Next_Material)
        collect_blocks(m, blocks);
    if (texture->Blend_Map != NULL)
      for (int i = 0; i < texture->Blend_Map->Number_Of_Entries; i++)
        collect_blocks(texture->Blend_Map->Blend_Map_Entries[i].Vals.Texture, blocks);
  }
}

} // namespace

void Collect_Mdf_Blocks(const ObjectBase *object, bool parts, MdfBlocks &blocks) {
  collect_blocks(object->Texture, blocks);
  collect_blocks(object->Interior_Texture, blocks);
  if (const Mesh *mesh = dynamic_cast<const Mesh *>(object))
    for (long i = 0; i < mesh->Number_Of_Textures; i++)
      collect_blocks(mesh->Textures[i], blocks);
  if (const Blob *blob = dynamic_cast<const Blob *>(object))
    for (int i = 0; i < blob->Data->Number_Of_Components; i++)
      collect_blocks(blob->Element_Texture[i], blocks);
  if (!parts || !(object->Type & IS_COMPOUND_OBJECT))
    return;
  const std::vector<ObjectPtr> &children = static_cast<const CompoundObject *>(object)->children;
  for (size_t i = 0; i < children.size(); i++)
    Collect_Mdf_Blocks(children[i], true, blocks);
}

namespace {

// From where the scene is seen.
struct Eye {
  explicit Eye(const Camera &camera)
      : place(camera.Location), direction(camera.Direction),
        parallel(camera.Type == ORTHOGRAPHIC_CAMERA) {}
  const Vector3d place, direction;
  const bool parallel;

  bool sees(const Vector3d &point, const Vector3d &normal) const {
    return dot(normal, parallel ? direction : point - place) < 0.0;
  }
};

// Takes the slopes of bumps, by finish, where POV-Ray lights a texture. A sheet's are not the same
// from behind: those that turn away from the camera only count where no others are.
class SlopeTrace : public Trace {
public:
  SlopeTrace(const shared_ptr<SceneData> &scene, TraceThreadData *thread, CooperateFunctor &c,
             MediaFunctor &m, RadiosityFunctor &r, const Eye &eye)
      : Trace(scene, thread, QUALITY_9, c, m, r), camera(eye), weight(1.0) {}

  void Look(Intersection &isect, const Ray &ray, double counts) {
    TraceTicket ticket(1, 0.0);
    Colour colour;
    weight = counts;
    ComputeTextureColour(isect, colour, ray, 1.0, false, ticket);
  }
  // What was seen since the last time counts so much.
  void Weigh(double scale) {
    for (Slopes::const_iterator i = now.begin(); i != now.end(); ++i)
      all[i->first].add(i->second.bumps, scale);
    now.clear();
  }
  // The most points of a finish since then.
  double Points() const {
    double most = 0.0;
    for (Slopes::const_iterator i = now.begin(); i != now.end(); ++i)
      most = max(most, i->second.points);
    return most;
  }
  const mdf::Bumps &Of(const FINISH *finish) { return all[finish]; }

protected:
  virtual void ComputeLightedTexture(Colour &, const TEXTURE *texture,
                                     vector<const TEXTURE *> &warps, const Vector3d &ipoint,
                                     const Vector3d &rawnormal, const Ray &ray, COLC,
                                     Intersection &isect, TraceTicket &ticket) {
    for (; texture != NULL; texture = reinterpret_cast<const TEXTURE *>(texture->Next)) {
      if (texture->Finish->Mdf == NULL || texture->Finish->Mdf->cloth)
        continue;
      MdfHit hit;
      hit.Prepare(texture->Finish, isect, ray, rawnormal,
                  LayerNormal(texture, warps, ipoint, rawnormal, ray, isect), warps, ipoint, 1.0,
                  threadData);
      const double share = ticket.mdfTo - ticket.mdfFrom;
      Seen &seen = now[texture->Finish];
      const bool facing = camera.sees(Vector3d(isect.IPoint), rawnormal);
      hit.Look(facing ? weight * share : BEHIND * weight * share, seen.bumps);
      seen.points += facing ? share : 0.0;
    }
  }

private:
  struct Seen {
    Seen() : points(0.0) {}
    mdf::Bumps bumps;
    double points;
  };
  typedef std::map<const FINISH *, Seen> Slopes;
  static constexpr double BEHIND = 1e-6;
  const Eye camera;
  Slopes now;
  std::map<const FINISH *, mdf::Bumps> all;
  double weight;
};

// Points of a cube, as evenly as can be: multiples of the powers of the root of x^5 = x + 1.
void even(unsigned int i, double u[4]) {
  double step = 1.0;

  for (int axis = 0; axis < 4; axis++) {
    step /= 1.1673039782614187;
    u[axis] = std::fmod(0.5 + step * (i + 1.0), 1.0);
  }
}

// A direction about an axis, by its cosine with that and an angle.
Vector3d direction_about(const Vector3d &axis, double cosine, double turn) {
  const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0)), angle = 2.0 * M_PI * turn;
  const Vector3d x = glue::any_tangent(axis);

  return cosine * axis + sine * std::cos(angle) * x + sine * std::sin(angle) * cross(axis, x);
}

// Rays at an object. Lines that cross its bounding sphere as likely in any place and direction
// meet the same number of points on each piece of a surface that nothing hides. So points lie
// evenly on any shape, and where a CSG object has been cut away there are none. An object that has
// no end or stands about the camera (a floor, a room) is looked at from there; near and far count
// alike.
class Aim {
public:
  Aim(const ObjectBase *object, const Vector3d &camera)
      : low(object->BBox.Lower_Left), size(object->BBox.Lengths), eye(camera),
        radius(0.5 * size.length()) {
    bool about = true;
    for (int i = X; i <= Z; i++)
      about = about && low[i] <= eye[i] && eye[i] <= low[i] + size[i];
    from_eye = about || Test_Flag(object, INFINITE_FLAG) || !std::isfinite(radius);
  }
  bool around() const { return from_eye; }
  double scale() const { return from_eye ? 1.0 : radius * radius; }
  void ray(unsigned int number, Ray &ray) const {
    double u[4];
    even(number, u);
    const Vector3d out = direction_about(glue::axis_vector(Z), 2.0 * u[0] - 1.0, u[1]);
    const Vector3d origin = from_eye ? eye : low + 0.5 * size + (1.001 * radius) * out;
    const Vector3d along = from_eye ? out : direction_about(-out, std::sqrt(1.0 - u[2]), u[3]);
    Assign_Vector(ray.Origin, *origin);
    Assign_Vector(ray.Direction, *along);
  }

private:
  const Vector3d low, size, eye;
  const double radius;
  bool from_eye;
};

bool is_before(const FINISH *a, const FINISH *b) {
  return a->Mdf->id < b->Mdf->id;
}

// Looks at so many points of an object; now and then something else may be done.
template <class Pause>
void look_at(const ObjectPtr &object, const Vector3d &eye, double points, SlopeTrace &trace,
             const Pause &pause) {
  const Aim aim(object, eye);
  std::vector<double> depths;
  double far_off = 0.0; // what stands around the camera: some way on from the middle of it

  for (unsigned int n = 0; aim.around() && n < 256; n++) {
    Ray ray(Ray::OtherRay);
    Intersection isect;
    aim.ray(n, ray);
    if (trace.FindIntersection(object, isect, ray))
      depths.push_back(isect.Depth);
  }
  if (!depths.empty()) {
    std::nth_element(depths.begin(), depths.begin() + (long)depths.size() / 2, depths.end());
    far_off = 8.0 * depths[depths.size() / 2];
  }
  unsigned int rays = 0;
  while (rays < 16.0 * points && trace.Points() < points) {
    Ray ray(Ray::OtherRay);
    Intersection isect;
    aim.ray(rays++, ray);
    if (trace.FindIntersection(object, isect, ray))
      trace.Look(isect, ray, far_off > 0.0 ? min(isect.Depth / far_off, 1.0) : 1.0);
    if (rays % 256 == 0)
      pause();
  }
  trace.Weigh(aim.scale() / rays);
}

} // namespace

// Once the scene is read: what each block with `horizon mutual` that says no slopes has on its
// objects. Those that share a texture share its slopes. Where an image's bumps may be uneven, by
// what some points say, more are looked at.
void Parser::Find_Mdf_Slopes() {
  const double MOST = 4096.0, FINEST = 65536.0, ALL = 1 << 20, MAY_BE_UNEVEN = 0.2;
  const double LEAST = 1e-10; // what rounding alone may leave
  struct Bumpy {
    ObjectPtr object;
    MdfBlocks blocks;
  };
  typedef std::vector<Bumpy> Objects;
  mdf::Scene &scene = *sceneData->mdfScene;
  Objects bumpy;
  std::vector<const FINISH *> wanted; // as they stand in the scene
  MdfBlocks met;

  if (scene.empty())
    return;
  for (size_t i = 0; i < sceneData->objects.size(); i++) {
    Bumpy one = {sceneData->objects[i], MdfBlocks()};
    bool bumps = false;
    Collect_Mdf_Blocks(one.object, true, one.blocks);
    const size_t before = wanted.size();
    for (MdfBlocks::const_iterator f = one.blocks.begin(); f != one.blocks.end(); ++f)
      if ((*f)->Mdf->wants_slopes()) {
        bumps = true;
        if (met.insert(*f).second)
          wanted.push_back(*f);
      }
    std::sort(wanted.begin() + (long)before, wanted.end(), is_before);
    if (bumps)
      bumpy.push_back(one);
  }
  if (bumpy.empty())
    return;

  TraceThreadData own(sceneData);
  Trace::CooperateFunctor cooperate;
  Trace::MediaFunctor media;
  Trace::RadiosityFunctor radiosity;
  const Eye eye(sceneData->parsedCamera);
  SlopeTrace trace(sceneData, &own, cooperate, media, radiosity, eye);
  SlopeTrace finer(sceneData, &own, cooperate, media, radiosity, eye);
  const auto look = [&](const Objects &all, double points, SlopeTrace &by) {
    for (Objects::const_iterator i = all.begin(); i != all.end(); ++i)
      look_at(i->object, eye.place, points, by, [this]() { Cooperate(); });
  };
  const double few = max(min(ALL / (double)bumpy.size(), MOST), 128.0);
  look(bumpy, few, trace);

  double slopes[5];
  std::map<const FINISH *, std::shared_ptr<const shade_relief>> found;
  const auto is_uneven = [&](const FINISH *f) {
    return f->Mdf->may_be_uneven() && found.count(f) > 0 &&
           shade_relief_whole(found[f].get(), slopes) > MAY_BE_UNEVEN;
  };
  for (size_t i = 0; i < wanted.size(); i++)
    found[wanted[i]] = trace.Of(wanted[i]).relief();
  Objects again;
  for (Objects::const_iterator i = bumpy.begin(); i != bumpy.end(); ++i)
    if (std::any_of(i->blocks.begin(), i->blocks.end(), is_uneven))
      again.push_back(*i);
  const double many = min(ALL / (double)max(again.size(), (size_t)1), FINEST);
  if (many > few) {
    look(again, many, finer);
    for (size_t i = 0; i < wanted.size(); i++)
      if (is_uneven(wanted[i]))
        found[wanted[i]] = finer.Of(wanted[i]).relief();
  }

  for (size_t i = 0; i < wanted.size(); i++) {
    FINISH *const finish = const_cast<FINISH *>(wanted[i]); // of a texture, which is the scene's
    const std::string name = finish->Mdf->name;
    if (!trace.Of(finish).any()) // nothing of it is to be seen
      continue;
    shade_relief_whole(found[finish].get(), slopes);
    if (!(slopes[2] + slopes[4] > LEAST)) {
      Warn_Mdf("'horizon mutual' (" + name + ") is 'horizon hard' here: its texture has no bumps.");
      continue;
    }
    finish->Mdf = scene.on_bumps(finish->Mdf, found[finish]);
    const std::string note = "mdf block at " + name + "\n" + Mdf_Slopes_Note(*finish->Mdf);
    if (finish->Mdf->notes && scene.first_warning(note))
      Debug_Info("%s", note.c_str());
  }
}

} // namespace pov
