// Points and fine surfaces carried by domains.
#pragma once

#include "assets/frames/frame_cache.h"
#include "assets/mesh/triangle_mesh.h"
#include "sim/lattice/lattice.h"

#include <array>
#include <span>
#include <vector>

namespace sim {

/// Trilinear weights of the eight corners of the domain that holds a rest point.
struct Binding {
    int domain = -1;
    std::array<double, 8> weights{};  // sum to 1; outside [0,1] where extrapolated
};

/// Binds points to the domain that holds them, else to the nearest domain, extrapolated by no more than half a
/// domain (the point is first moved to that limit). Of domains that hold parts not connected to each other, the one
/// whose material is nearest.   (n)
std::vector<Binding> bind_points(const Lattice& lattice, const std::vector<Vec3>& points);

/// x = Σ_a w_a x_a.   [m]
Vec3 carried(const Lattice& lattice, const Binding& binding, std::span<const Vec3> corners);

/// F of a domain from its corners at local coordinates (0.5,0.5,0.5), or at those of `binding`.   (3×3)
Mat3 deformation_gradient(const Lattice& lattice, int domain, std::span<const Vec3> corners);
Mat3 deformation_gradient(const Lattice& lattice,
                          const Binding& binding,
                          std::span<const Vec3> corners);

/// A fine surface of a body, bound once.
class EmbeddedSurface {
  public:
    /// Vertices are split where faces meet at more than 40 degrees, so that normals keep crisp edges crisp. Throws
    /// Error(Input) where the skin's source cannot be read, or no part of it is near the body.
    EmbeddedSurface(const Lattice& lattice, const Body& body, const Skin& skin);

    /// Topology, rest positions and region colours (sRGB of the shot made linear) for the cache.
    const assets::CachedSurface& cached() const { return cached_; }

    /// Positions by trilinear weights, normals by F^-T of the smooth trilinear map, attributes "stretch" (largest
    /// principal stretch) and "region" (index). `enriched` (#D, may be empty) becomes the attribute "enriched".
    assets::SurfaceFrame deformed(const Lattice& lattice,
                                  std::span<const Vec3> corners,
                                  const std::vector<char>& enriched) const;

  private:
    assets::CachedSurface cached_;
    std::vector<Vec3> rest_normals_;  // (#V) unit
    std::vector<Binding> bindings_;   // (#V)
    std::vector<float> region_;       // (#V) index, as the attribute
};

}  // namespace sim
