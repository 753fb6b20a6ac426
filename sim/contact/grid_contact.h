// Contact between bodies on a background grid: an exchange of momentum after the solve.
#pragma once

#include "sim/base/field.h"
#include "sim/scene.h"

#include <vector>

namespace sim {

/// The corners [begin, end) of one body.
struct ContactBody {
    int begin = 0, end = 0;
};

/// Two bodies that may meet, and the cells of the grid on which they do.
struct GridPair {
    ContactBody first, second;
    double cell_size = 0;  // [m]
    Friction friction;
};

/// What every corner brings into contact; all indexed by corner.
struct ContactFields {
    const Field& x;                      // positions at the start of the step [m]
    const Field& mass;                   // [kg]
    const std::vector<double>& outside;  // distance out of the body's surface at rest [m]
    const Field& is_free;                // 1 in free components, 0 in prescribed ones
};

/// All corners of a pair, free ones too, deposit mass and momentum on a grid. At a node where two bodies are
/// present, approach each other, and overlap along the normal by the end of the step (largest n·x of the one against
/// smallest of the other), they exchange the impulse m1 m2 / (m1 + m2) times the approach, with Coulomb friction; each
/// corner gets Σ_i w_i dv_i back, so that momentum is exact. Normals from the mass-weighted shape gradients of both.
/// Repeated `contact_sweeps` times, pair after pair. Changes `velocity` (#C) [m/s].
void exchange_on_grid(const std::vector<GridPair>& pairs,
                      const ContactFields& corners,
                      double dt,
                      Field& velocity);

}  // namespace sim
