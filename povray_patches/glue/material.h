// SPDX-License-Identifier: AGPL-3.0-or-later
// One `mdf { }` block, and all of a scene's. No type of POV-Ray's appears here.
#ifndef POVRAY_BACKEND_MDF_MATERIAL_H
#define POVRAY_BACKEND_MDF_MATERIAL_H

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shade/shade.h"
#include "backend/mdf/bumpimage.h"

namespace mdf {

struct Material {
  Material();

  enum Tangent {
    TANGENT_DEFAULT, // dP/du where the object has UV coordinates, else its x axis
    TANGENT_FROM_UV, // the same, but asked for: the parser warns where there are none
    TANGENT_AXIS     // a direction in the object's own space
  };

  std::string name; // where it was written: "file:line"
  shade_params params;
  shade_bsdf bsdf; // of params; made by Scene::add
  Tangent tangent;
  double axis[3];                        // for TANGENT_AXIS
  std::shared_ptr<const BumpImage> bump; // or NULL
  double strength;                       // of bump
  int id;                                // position in the scene's list
};

// Tangents of a mesh: for each corner the unit vector along dP/du and the
// handedness, as shade_mesh_tangents gives them. Empty: the mesh has no UVs.
typedef std::vector<float> MeshTangents;

// What all the blocks of a scene need to keep. FINISH is copied and freed as
// plain memory, so it only points to a Material here. Filled by the parser's
// thread; the render threads read it.
class Scene {
public:
  // Makes the block ready and keeps it until the scene ends.
  const Material *add(const Material &material);
  bool empty() const { return materials.empty(); }

  // {"version": …, "renderer": …, "materials": […]}, for a dump's header.
  std::string json(const std::string &renderer) const;

  std::map<std::string, std::shared_ptr<const BumpImage>> images; // by path
  std::map<const void *, MeshTangents> meshes;                    // by MESH_DATA

  // True the first time it is asked about a block and a subject.
  bool first_warning(const Material *material, const char *subject);

private:
  std::vector<std::shared_ptr<const Material>> materials;
  std::map<std::pair<const Material *, std::string>, bool> warned;
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

  // S = f cos E for light from the unit direction L with the irradiance E
  // at normal incidence, RGB.
  void light(const double L[3], const double E[3], double S[3]) const;

private:
  const Material *material;
  double frame[3][3]; // T, N x T, N
  double eye[3], normal[3];

  void to_local(const double world[3], double local[3]) const;
};

} // namespace mdf

#endif
