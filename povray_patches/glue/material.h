// SPDX-License-Identifier: AGPL-3.0-or-later
// One `mdf { }` block, and all of a scene's. No type of POV-Ray's appears here.
#ifndef POVRAY_BACKEND_MDF_MATERIAL_H
#define POVRAY_BACKEND_MDF_MATERIAL_H

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "backend/mdf/bumpimage.h"
#include "shade/albedo.h"
#include "shade/shade.h"

namespace mdf {

struct Material {
  Material();

  enum Tangent {
    TANGENT_DEFAULT, // dP/du where the object has UV coordinates, else what
                     // Shape says
    TANGENT_FROM_UV, // the same, but asked for: the parser warns where there
                     // are none
    TANGENT_AXIS,    // a direction in the texture's space
    TANGENT_RADIAL   // around an axis there
  };

  std::string name; // where it was written: "file:line"
  shade_params params;
  Tangent tangent;
  double axis[3];                        // for TANGENT_AXIS and _RADIAL
  double centre[3];                      // for TANGENT_RADIAL: a point of the axis
  std::shared_ptr<const BumpImage> bump; // or NULL
  double strength;                       // of bump
  bool reflects;                         // `reflection { }`
  int samples;                           // rays at a hit, at most; 0: by the width of the lobe
  double clamp;                          // the brightest that a ray may bring; 0: anything
  int id;                                // position in the scene's list

  // Of params, made by Scene::add: all of it, and each part alone. They add up.
  shade_bsdf bsdf, specular, diffuse;
  bool has_diffuse;
  // Of the diffuse part, where its albedo is not simply params.kd; else NULL.
  std::shared_ptr<const shade_bsdf_albedo> albedo;
  // Of the specular part, once an object shows it (Scene::use); else NULL.
  std::shared_ptr<const shade_bsdf_albedo> specular_albedo;

  // The specular part, no alpha below that of the level. A path that has left a rough surface
  // sees sharp lobes so: it seldom finds a light in them, and then a dazzling one.
  enum { LEVELS = 4 };
  shade_bsdf widened[LEVELS];
  double width; // what it asks of the lobes behind: half its mean alpha
  int rays;     // `samples`, or the choice for them
  // The widest level up to an alpha, or -1.
  static int level_of(double alpha);
};

// Tangents of a mesh: for each corner the unit vector along dP/du and the
// handedness, as shade_mesh_tangents gives them. Empty: the mesh has no UVs.
typedef std::vector<float> MeshTangents;

// What is known of an object's tangents.
struct Shape {
  enum Kind {
    OTHER,  // no UV coordinates: the object's x axis
    PLANE,  // nor here: the axis of the object that is nearest to it, x if it
            // can be
    CONE,   // nor here: around its own axis
    BOX,    // UV coordinates that are a function of the point
    SPHERE, // the same, u round the y axis of the object
    ROUND,  // round the y axis of the shape's own space
    TORUS,  // round that, the other way
    LATHE,
    PATCH,
    PARAMETRIC,
    MESH
  };

  explicit Shape(Kind k) : kind(k) {}
  bool has_uv() const { return kind >= BOX; }

  Kind kind;
  MeshTangents tangents; // of a mesh
};

// What all the blocks of a scene need to keep. FINISH is copied and freed as
// plain memory, so it only points to a Material here. Filled by the parser's
// thread; the render threads read it.
class Scene {
public:
  // Makes the block ready and keeps it until the scene ends.
  const Material *add(const Material &material);
  bool empty() const { return materials.empty(); }
  // Makes what only a block needs that is seen. Throws std::bad_alloc.
  void use(const Material *material);

  // {"version": …, "renderer": …, "materials": […]}, for a dump's header.
  std::string json(const std::string &renderer) const;

  std::map<std::string, std::shared_ptr<const BumpImage>> images; // by path
  std::map<const void *, std::shared_ptr<const Shape>> meshes;    // by MESH_DATA
  std::map<Shape::Kind, std::shared_ptr<const Shape>> shapes;     // all others

  // True the first time it is asked about a text.
  bool first_warning(const std::string &text) { return warned.insert(text).second; }

private:
  std::vector<std::shared_ptr<Material>> materials;
  // equal blocks share one: scenes copy them in loops
  std::vector<std::pair<shade_params, std::shared_ptr<const shade_bsdf_albedo>>> albedos;
  std::set<std::string> warned;
};

// A point of a surface with an mdf { } block, seen from one direction.
// All vectors are unit, in world space; N faces the eye, T is orthogonal to N.
// POV-Ray's space is left-handed, but a mirror does not change this BRDF: the
// frame's y axis is the formula N x T, and every vector goes through it alike.
class ShadedPoint {
public:
  ShadedPoint() : material(NULL) {}
  ShadedPoint(const Material *m, const double N[3], const double T[3], const double Ns[3],
              const double V[3]);

  bool has_material() const { return material != NULL; }
  const Material &of() const { return *material; }

  // Is this direction above the surface? Light from elsewhere gives nothing.
  bool faces(const double L[3]) const {
    return frame[2][0] * L[0] + frame[2][1] * L[1] + frame[2][2] * L[2] > 0.0;
  }

  // S = f cos E for light from the unit direction L with the irradiance E
  // at normal incidence, RGB; f is the material's, or one part of it.
  void light(const shade_bsdf &part, const double L[3], const double E[3], double S[3]) const;

  // What share of even light each part reflects, RGB.
  void diffuse_albedo(double albedo[3]) const;
  void specular_albedo(double albedo[3]) const;

  // A direction L that light comes from, drawn for the part by two numbers in [0, 1), and what
  // share of its light is reflected: f cos / pdf. False if there is none.
  bool draw(const shade_bsdf &part, const double u[2], double L[3], double reflectance[3]) const;

private:
  const Material *material;
  double frame[3][3]; // T, N x T, N
  double eye[3], normal[3];

  void to_local(const double world[3], double local[3]) const;
};

} // namespace mdf

#endif
