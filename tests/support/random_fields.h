// Random vectors from a fixed seed, products and differences of fields.
#pragma once

#include "sim/base/field.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tests {

using Random = std::mt19937;

inline double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

inline Vec3 random_vector(Random& random, double size = 1) {
    return {between(random, -size, size),
            between(random, -size, size),
            between(random, -size, size)};
}

inline sim::Field random_field(std::size_t n, Random& random, double size = 1) {
    sim::Field field(n);
    for (sim::Vec3p& v : field)
        v = sim::padded(random_vector(random, size));
    return field;
}

inline double dot(const sim::Field& a, const sim::Field& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += sim::dot(a[i], b[i]);
    return sum;
}

inline sim::Field sum(const sim::Field& a, double factor, const sim::Field& b) {
    sim::Field result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = a[i] + factor * b[i];
    return result;
}

inline double longest(const sim::Field& u) {
    double squared = 0;
    for (const sim::Vec3p& v : u)
        squared = std::max(squared, sim::dot(v, v));
    return std::sqrt(squared);
}

inline double largest_difference(const sim::Field& a, const sim::Field& b) {
    return longest(sum(a, -1, b));
}

}  // namespace tests
