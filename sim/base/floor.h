// Vectors of fields rounded down.
#pragma once

#include "sim/base/field.h"

#include <immintrin.h>

namespace sim {

/// In one instruction, which GCC does not make of four std::floor.
inline Vec3p floor_of(const Vec3p& v) {
    return _mm256_floor_pd(v);
}

}  // namespace sim
