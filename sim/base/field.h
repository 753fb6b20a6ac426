// Fields of 3-vectors padded to four doubles, so that one vector instruction moves one vector.
#pragma once

#include "assets/base/vector_types.h"

#include <vector>

namespace sim {

/// (x, y, z, 0); the fourth entry stays zero in every operation of the solver.
using Vec3p = double __attribute__((vector_size(32)));

using Field = std::vector<Vec3p>;

inline Vec3p padded(const Vec3& v) {
    return Vec3p{v.x(), v.y(), v.z(), 0};
}

inline Vec3 unpadded(const Vec3p& v) {
    return {v[0], v[1], v[2]};
}

inline double dot(const Vec3p& a, const Vec3p& b) {
    const Vec3p product = a * b;
    return product[0] + product[1] + product[2];
}

}  // namespace sim
