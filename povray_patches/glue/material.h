// SPDX-License-Identifier: AGPL-3.0-or-later
// One `mdf { }` block, and all of a scene's. No type of POV-Ray's appears here.
#ifndef POVRAY_BACKEND_MDF_MATERIAL_H
#define POVRAY_BACKEND_MDF_MATERIAL_H

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "backend/mdf/bumpimage.h"
#include "backend/mdf/cloth.h"
#include "backend/mdf/scratches.h"
#include "shade/albedo.h"
#include "shade/maps.h"
#include "shade/shade.h"

namespace mdf {

// A table of albedos, made when a ray asks for it first: without `ambient`, radiosity and
// conserve_energy none does. Any thread may.
class LazyAlbedo {
public:
  explicit LazyAlbedo(const shade_params &p) : params(p), table(NULL) {}
  ~LazyAlbedo() { shade_bsdf_albedo_free(table.load()); }
  // Throws std::bad_alloc.
  const shade_bsdf_albedo *get() const {
    const shade_bsdf_albedo *const made = table.load(std::memory_order_acquire);
    return made != NULL ? made : make();
  }
  const shade_params params;

private:
  mutable std::atomic<shade_bsdf_albedo *> table;
  mutable std::mutex making;
  const shade_bsdf_albedo *make() const;
};

// Points step * i / count, modulo 1, of the unit square, that lie most evenly. side: of one of the
// cells that they are corners of.
struct Lattice {
  unsigned int count, step[2];
  double side[2][2];

  static Lattice of(unsigned int count);
};

// Bumps that were looked at: places of a bump image, slopes of normals, -n.x/n.z along the frame's
// x axis and -n.y/n.z along y, and what each counts.
struct Bumps {
  std::vector<float> u, v, x, y, weight;

  void add(const double uv[2], const double normal[3], double share);
  void add(const Bumps &other, double scale);
  bool any() const; // that counts
  // Throws std::bad_alloc.
  std::shared_ptr<const shade_relief> relief() const;
};

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
  unsigned int stated; // 1 << list of each choice that a block has made
  Tangent tangent;
  double axis[3];                             // for TANGENT_AXIS and _RADIAL
  double centre[3];                           // for TANGENT_RADIAL: a point of the axis
  std::shared_ptr<const BumpImage> bump;      // or NULL
  double strength;                            // of bump
  bool filtered;                              // bumps below a pixel are roughness
  bool bump_once;                             // bump is BumpImage::once() of a picture
  double bump_scale[2], bump_move[2];         // of its UV coordinates
  std::shared_ptr<const Scratches> scratches; // or NULL
  bool reflects;                              // `reflection { }`
  bool notes;                                 // told in words to the debug stream
  bool preset;                                // of the library's colours
  int samples;                                // rays at a hit, at most; 0: by the width of the lobe
  double clamp;                               // the brightest that a ray may bring; 0: anything
  bool told_slopes;                           // the block has `slopes`
  std::shared_ptr<const Cloth> cloth;         // or NULL; then params are not its own
  bool specular_pigment, kd_pigment;          // colours of the layer's pigment in place of f0, kd
  int id;                                     // position in the scene's list

  // Whether the slopes of its bumps are to be looked for.
  bool wants_slopes() const {
    return !cloth && !told_slopes && params.horizon == SHADE_HORIZON_MUTUAL;
  }
  // Whether these may differ from place to place of its image.
  bool may_be_uneven() const { return bump && !scratches; }
  // Whether what is smaller than a pixel is roughness. Of bumps that shade each other it would
  // shade itself once more: points are looked at.
  bool spreads_bumps() const {
    return ((bump && filtered) || scratches) && params.horizon != SHADE_HORIZON_MUTUAL;
  }
  bool by_axis() const { return tangent == TANGENT_AXIS || tangent == TANGENT_RADIAL; }
  bool has_pigment() const {
    return cloth ? cloth->pigment[0] || cloth->pigment[1] : specular_pigment || kd_pigment;
  }
  // Where it is kept that this row of params is the pigment's; NULL: it cannot be.
  bool *pigment_for(int row);
  // A colour is to come that a metal's own indices would leave no part: they go.
  void colour_metal();

  // Of params, made by Scene::add: all of it, and each part alone. They add up.
  shade_bsdf bsdf, specular, diffuse;
  bool has_diffuse;
  bool diffuse_only; // nothing is specular
  bool lambert;      // all of it is Lambert's law, but for what moves normals
  bool rejects;      // light from below the perturbed normal gives nothing,
  bool bends;        // unless that normal has been bent for the eye
  // Of the diffuse part, where its albedo is not simply params.kd; else NULL.
  std::shared_ptr<const LazyAlbedo> albedo;
  std::shared_ptr<const LazyAlbedo> specular_albedo;
  // The cloth, once an object shows it (Scene::use); else NULL.
  std::shared_ptr<const PreparedCloth> prepared_cloth;
  // The bump image from afar, likewise.
  std::shared_ptr<const shade_slope_map> slopes;
  std::shared_ptr<const ScratchField> field; // of scratches
  // How steep the bumps are near each place of the image, where they are uneven; else NULL.
  std::shared_ptr<const shade_relief> relief;
  // The specular part in black, where its colour is the pigment's: `specular` is then in white,
  // and what either reflects is mixed. Every Fresnel term of a colour is linear in it, and so is
  // all that is reflected once. What is reflected more than once is not: each point has its own
  // then.
  shade_bsdf black;
  bool linear;
  std::shared_ptr<const LazyAlbedo> black_albedo;

  // The specular part, no alpha below that of the level. A path that has left a rough surface
  // sees sharp lobes so: it seldom finds a light in them, and then a dazzling one.
  enum { LEVELS = 4 };
  shade_bsdf regularized[LEVELS];
  shade_bsdf regularized_black[LEVELS]; // as `black`
  double roughness;                     // what it asks of the lobes behind: half its mean alpha
  int rays;                             // `samples`, or the choice for them
  Lattice lattice;                      // of that many points
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
  // Whether any block is a cloth, or has a diffuse part in a pigment's colours.
  bool has_cloth() const;
  bool has_painted() const;
  bool has_bumps() const; // from an image, or scratches
  bool has_scratches() const;
  bool has_reliefs() const;
  // Whether any block looks different by how wide a ray is.
  bool uses_footprints() const { return by_width; }
  // Whether any block has `reflection { }`.
  bool reflects() const { return reflecting; }
  // Makes what only a block needs that is seen. Throws std::bad_alloc.
  void use(const Material *material);
  // The same block on bumps like these: itself for the first, others for more. What looks the
  // same is one. Before the first hit.
  const Material *on_bumps(const Material *material,
                           const std::shared_ptr<const shade_relief> &bumps);

  // {"version": …, "renderer": …, "materials": […]}, for a dump's header.
  std::string json(const std::string &renderer) const;

  std::map<std::string, std::shared_ptr<const BumpImage>> images; // by path
  std::map<const void *, std::shared_ptr<const Shape>> meshes;    // by MESH_DATA
  std::map<Shape::Kind, std::shared_ptr<const Shape>> shapes;     // all others

  // True the first time it is asked about a text.
  bool first_warning(const std::string &text) { return warned.insert(text).second; }

private:
  std::vector<std::shared_ptr<Material>> materials;
  bool by_width = false, reflecting = false;
  // equal blocks share one: scenes copy them in loops
  std::vector<std::shared_ptr<const LazyAlbedo>> albedos;
  ClothCache cloths;
  ScratchFieldCache scratch_fields;
  std::map<int, std::vector<const Material *>> bumped; // of on_bumps(), by id

  void prepare(Material &material);
  std::shared_ptr<const LazyAlbedo> albedo_of(const shade_params &params);
  std::set<std::string> warned;
};

// One of the specular lobes of a point, about the normal of what it is of; world space.
struct LobeSeen {
  double share, normal[3], alpha[2], angle; // how far its grooves are turned from T
};

// A point of a surface with an mdf { } block, seen from one direction.
// All vectors are unit, in world space; N faces the eye, T is orthogonal to N.
// POV-Ray's space is left-handed, but a mirror does not change a BRDF: the
// frame's y axis is the formula N x T, and every vector goes through it alike. On cloth, whose
// pattern has a hand, it is the other way, but where it is seen as in a mirror.
class ShadedPoint {
public:
  enum Part { ALL, SPECULAR, DIFFUSE }; // ALL: where no colour is the pigment's

  ShadedPoint() : material(NULL), lambert(false), turned(false), prepared(0) {}
  // mirrored: its cloth shows the other hand.
  void set(const Material *m, const double N[3], const double T[3], const double Ns[3],
           const double V[3], bool mirrored = false);
  // Of a material that follows Lambert's law alone where nothing moves its normal: no other vector
  // has a part in it.
  void set_lambert(const Material *m, const double N[3]) {
    material = m;
    lambert = true;
    for (int c = 0; c < 3; c++) {
      frame[2][c] = N[c];
      pigment[c] = 1.0;
    }
  }

  // The colour of the layer's pigment; white, if it is not told.
  void set_pigment(const double rgb[3]);
  // Where on its cloth this is: to be told before light comes. Returns the share of the eye's ray
  // that meets something.
  double prepare_cloth(const ClothPlace &place);
  // Bumps too small to be seen, as roughness, on a share of the point: their mean normal, world
  // space, and the covariance of their slopes, local. level: of Material::regularized, or -1. most:
  // so many lobes stand for them at most. All shares are to be told, 1 together, in MOST_LOBES
  // lobes.
  void roughen(double share, const double mean[3], const double covariance[3], int most, int level);
  bool is_rough() const { return rough != NULL; }
  // Adds the slopes of its normals, at this place of the bump image.
  void look(const double uv[2], double share, Bumps &to) const;
  // Takes the slopes near a place of the bump image, which the material has a relief of.
  void set_slopes(const double uv[2]);
  // Those of a dump.
  void slopes(double found[5]) const;
  enum { MOST_LOBES = 3 };
  // What was told, the last first. Returns how many there are.
  int lobes(LobeSeen seen[MOST_LOBES]) const;

  bool has_material() const { return material != NULL; }
  const Material &of() const { return *material; }
  bool left_handed() const { return turned; } // the frame is

  // Is this direction above the surface?
  bool above(const double L[3]) const { return over(L) > 0.0; }
  // Light from elsewhere gives nothing: it needs no shadow test.
  bool faces(const double L[3]) const {
    if (material->cloth)
      return above(L) || material->cloth->transmits();
    if (!above(L))
      return false;
    if (lambert || !material->rejects)
      return true;
    double wi[3];
    to_local(L, wi);
    if (rough == NULL)
      return faces(normal, wi);
    for (int i = 0; i < rough->count; i++)
      if (faces(rough->lobe[i].flat, wi))
        return true;
    return false;
  }

  // S = f cos E for light from the unit direction L with the irradiance E
  // at normal incidence, RGB; f is the material's, or one part of it; all of a cloth's. level: of
  // Material::regularized, or -1.
  void eval(Part part, int level, const double L[3], const double E[3], double S[3]) const;
  // Both parts of what is no cloth and not roughened, which most is.
  void eval_smooth(const double L[3], const double E[3], double S[3]) const {
    double wi[3], f[3], cosine;

    if (lambert)
      return eval_lambert(L, E, S);
    to_local(L, wi);
    const shade_bsdf *const b = here(OF_ALL, &material->bsdf);
    if (!(prepared >> OF_ALL & 1)) {
      shade_bsdf_prepare(b, normal, eye, &prepared_hit[OF_ALL]);
      prepared |= 1u << OF_ALL;
    }
    shade_bsdf_hit_eval(b, &prepared_hit[OF_ALL], wi, f, &cosine);
    for (int c = 0; c < 3; c++)
      S[c] = f[c] * cosine * E[c];
  }

  // What share of even light each part reflects, RGB. All that a cloth does counts as specular.
  void diffuse_albedo(double albedo[3]) const;
  void specular_albedo(double albedo[3]) const;

  // A direction L that light comes from, drawn for the specular part (all of a cloth) by numbers
  // in [0, 1), the third of which chooses among lobes (-1: the second does that, too; not on a
  // cloth), and what share of its light is reflected: f cos / pdf. False if there is none.
  bool sample(int level, const double u[3], double L[3], double throughput[3]) const;

private:
  const Material *material;
  bool lambert;       // of set_lambert()
  bool turned;        // the frame's y axis is the other way
  double frame[3][3]; // T, N x T, N
  double eye[3], normal[3], pigment[3];
  std::unique_ptr<shade_fabric_hit> hit; // of a cloth

  // Each lobe that light may be asked of, prepared for the eye by the first light: most points
  // need one of them.
  enum Lobe {
    OF_ALL,
    OF_DIFFUSE,
    OF_SPECULAR,
    OF_BLACK,
    OF_REGULARIZED,
    OF_REGULARIZED_BLACK,
    LOBES
  };

  // The lobes where bumps are uneven: with the slopes near the point, each made when it is asked
  // of.
  struct Near {
    double slopes[5];
    unsigned int made; // bit 1 << lobe
    shade_bsdf lobe[LOBES];
  };
  std::unique_ptr<Near> near;
  const shade_bsdf *here(Lobe of, const shade_bsdf *b) const { return near ? near_bsdf(of, b) : b; }
  const shade_bsdf *near_bsdf(Lobe of, const shade_bsdf *b) const;

  // The material where slopes widen it, in a frame along its own axes.
  struct Wider {
    shade_params params;
    shade_bsdf own[2];         // specular, and the same in black
    const shade_bsdf *bsdf[2]; // these, or the material's
    double angle, c, s;        // its cosine and sine
    void turn(const double v[3], double turned[3]) const;
    void back(const double turned[3], double v[3]) const;
    void turn_slopes();
  };
  struct RoughLobe {
    const Wider *of;
    double share, flat[3], normal[3], eye[3]; // the normal, local and as `of` has it
    mutable shade_bsdf_hit prepared_hit[OF_BLACK + 1];
    mutable unsigned int prepared;
  };
  struct Rough {
    Rough() : parts(0), count(0) {}
    Wider part[2]; // told by roughen()
    RoughLobe lobe[MOST_LOBES];
    int parts, count;
  };
  std::unique_ptr<Rough> rough;

  // Whether a horizon that bends normals may have bent this one: where the eye's mirror image is
  // all but below the surface (shade.h, horizon).
  bool is_bent(const double n[3]) const {
    const double cosine = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
    return !(2.0 * cosine * n[2] - eye[2] > 0.0101);
  }
  // The same as above of one normal; one below the surface is raised.
  bool faces(const double n[3], const double wi[3]) const {
    return !(n[2] > 0.0) || (material->bends && is_bent(n)) ||
           n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2] > 0.0;
  }
  // Of set_lambert(), where no colour is the pigment's.
  void eval_lambert(const double L[3], const double E[3], double S[3]) const {
    const double share = std::max(over(L), 0.0) / M_PI;
    for (int c = 0; c < 3; c++)
      S[c] = material->params.kd[c] * share * E[c];
  }
  // How far this direction is above the surface.
  double over(const double L[3]) const {
    return frame[2][0] * L[0] + frame[2][1] * L[1] + frame[2][2] * L[2];
  }
  void to_local(const double world[3], double local[3]) const {
    for (int row = 0; row < 3; row++)
      local[row] = frame[row][0] * world[0] + frame[row][1] * world[1] + frame[row][2] * world[2];
  }
  void to_world(const double local[3], double world[3]) const;
  mutable shade_bsdf_hit prepared_hit[LOBES];
  mutable unsigned int prepared; // bit 1 << lobe

  void eval_lobe(Lobe lobe, const shade_bsdf *given, const double wi[3], double f[3]) const;
  void eval_rough(Lobe lobe, const double wi[3], double f[3]) const;
  void specular(bool in_black, int level, const double wi[3], double f[3]) const;
  bool sample_rough(const double u[3], double wi[3], double f[3], double *pdf) const;
  void tint(const double black[3], double white[3]) const;
  // The material at a level in the pigment's colour, where that is not mixed.
  struct Painted {
    int level;
    shade_bsdf bsdf;
    shade_bsdf_hit hit;
  };
  mutable std::unique_ptr<Painted> painted;
  void eval_painted(int level, const double wi[3], double f[3]) const;
  void paint_diffuse(double f[3]) const;
};

} // namespace mdf

#endif
