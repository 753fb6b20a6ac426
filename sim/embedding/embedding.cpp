#include "sim/embedding/embedding.h"

#include "sim/embedding/cell_index.h"
#include "sim/embedding/trilinear.h"

#include <tbb/parallel_for.h>

namespace sim {

namespace {

// Beyond this a trilinear map folds over itself in ordinary bends.   [domain edges]
constexpr double most_extrapolation = 0.5;

}  // namespace

std::vector<Binding> bind_points(const Lattice& lattice, const std::vector<Vec3>& points) {
    const CellIndex index(lattice);
    std::vector<Binding> bindings(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        const Vec3 point = (points[i] - lattice.origin) / lattice.edge;
        const int domain = index.nearest_part(point);
        const std::array<int, 3>& cell = lattice.cell[domain];
        const Vec3 xi = (point - Vec3(cell[0], cell[1], cell[2]))
                            .cwiseMax(-most_extrapolation)
                            .cwiseMin(1 + most_extrapolation);
        bindings[i] = {domain, trilinear_weights(xi)};
    });
    return bindings;
}

Vec3 carried(const Lattice& lattice, const Binding& binding, std::span<const Vec3> corners) {
    Vec3 x = Vec3::Zero();
    for (int a = 0; a < 8; ++a)
        x += binding.weights[a] * corners[lattice.corners[binding.domain][a]];
    return x;
}

Mat3 deformation_gradient(const Lattice& lattice, int domain, std::span<const Vec3> corners) {
    return trilinear_gradient(
        Vec3::Constant(0.5), lattice.edge, corners_of(lattice, domain, corners));
}

Mat3 deformation_gradient(const Lattice& lattice,
                          const Binding& binding,
                          std::span<const Vec3> corners) {
    return trilinear_gradient(local_coordinates(binding.weights),
                              lattice.edge,
                              corners_of(lattice, binding.domain, corners));
}

}  // namespace sim
