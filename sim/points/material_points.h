// A body made of material points, in place of domains: what traditional MPM moves.
#pragma once

#include "sim/lattice/lattice.h"
#include "sim/materials/lanes.h"
#include "sim/scene.h"

#include <vector>

namespace sim {

/// One point for each domain that the body would be cut into, at the centroid of the filled part of its cube and with
/// all that fills it. All but `spacing` and `snow` (#P), in the order of the domains.
struct MaterialPoints {
    double spacing = 0;              // edge s of the cubes [m]
    std::vector<Vec3> rest;          // [m]
    std::vector<double> mass;        // [kg]
    std::vector<double> volume;      // at rest [m³]
    std::vector<double> mu, lambda;  // share-weighted, of snow before it hardens [Pa]
    std::vector<int> region;
    std::vector<SnowOptions> snow;  // (#regions)
    std::vector<Model> model;       // (#regions)

    int size() const { return static_cast<int>(rest.size()); }

    bool is_snow(int p) const { return model[region[p]] == Model::Snow; }
};

MaterialPoints seed_points(const Lattice& lattice, const Body& body);

/// What points remember; (#P) each. Part of every checkpoint.
struct PointState {
    std::vector<Matrix3<double>> F;  // elastic part of the deformation gradient
    std::vector<double> J_plastic;   // volume ratio of the rest, J_P; 1 but for snow

    explicit PointState(int n = 0)
        : F(n, Matrix3<double>{{1, 0, 0, 0, 1, 0, 0, 0, 1}}), J_plastic(n, 1.0) {}
};

}  // namespace sim
