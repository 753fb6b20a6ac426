// The fastest mode of K u = w² M u.
#pragma once

#include "sim/base/field.h"

#include <functional>
#include <vector>

namespace sim {

/// w of it from a first guess u, by the power method: from below, 1% short as a rule. M is diagonal [kg]; what has no mass
/// stays where it is.   product(u, K u) [N]; u, mass (same size).   [rad/s]
double fastest_mode(Field u,
                    const std::vector<double>& mass,
                    const std::function<void(const Field& u, Field& Ku)>& product);

}  // namespace sim
