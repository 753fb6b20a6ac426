// A closed region of space that answers "inside or outside, and how deep": shapes by formula, meshes by an
// OpenVDB level set.
#pragma once

#include "assets/generators/shape.h"
#include "assets/mesh/triangle_mesh.h"

#include <memory>
#include <string>
#include <vector>

namespace assets {

class Solid {
  public:
    virtual ~Solid() = default;

    /// Signed distance to the surface, negative inside; exact within `band` of the surface, beyond it at
    /// least `band` with the right sign.   [m]
    virtual double signed_distance(const Vec3& x) const = 0;

    /// The same, but where it is more than `enough`, anything more than `enough` up to it: often cheaper.   [m]
    virtual double distance_up_to(const Vec3& x, double /*enough*/) const {
        return signed_distance(x);
    }

    Vec3 min{0, 0, 0}, max{0, 0, 0};  // bounds [m]
};

/// The surface of a source as triangles, and what was repaired on import. Curved shapes are meshed from an
/// OpenVDB level set with voxels of `spacing`, their vertices then moved onto the exact surface; boxes are
/// tessellated exactly with edges no longer than `spacing`.   [m]
struct Surface {
    TriangleMesh mesh;
    std::vector<std::string> repairs;
    bool closed = true;
};

Surface make_surface(const Source& source, double spacing);

/// The solid of a source. A mesh that is not closed throws Error(Input) saying how many edges are open, unless
/// its holes are flat and small enough to be closed by fans (then that repair is listed in `repairs`).
/// `voxel` and `band` set the level set of meshes.   [m]
std::unique_ptr<Solid> make_solid(const Source& source,
                                  double voxel,
                                  double band,
                                  std::vector<std::string>* repairs = nullptr);

}  // namespace assets
