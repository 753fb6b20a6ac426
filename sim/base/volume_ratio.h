// J = det F, of which the smallest tells where a body fails.
#pragma once

#include <cmath>

namespace sim {

/// Whether a domain or a point of J is in a worse state than one of `other`; what is no number is the worst.
inline bool is_worse(double J, double other) {
    return !std::isnan(other) && !(J >= other);
}

}  // namespace sim
