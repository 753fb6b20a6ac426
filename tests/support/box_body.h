// A box of whole domains of one material.
#pragma once

#include "sim/scene.h"

#include <array>

namespace tests {

inline sim::Region region(const char* name, sim::Selector select, double young_modulus = 1e6) {
    sim::Region result;
    result.name = name;
    result.select = std::move(select);
    result.young_modulus = young_modulus;
    result.poisson_ratio = 0.3;
    result.density = 1000;
    return result;
}

inline sim::Selector all() {
    return {sim::Selector::All{}, {}};
}

/// The side of a plane opposite to its normal.
inline sim::Selector behind(const Vec3& point, const Vec3& normal) {
    return {sim::Selector::HalfSpace{point, normal}, {}};
}

inline sim::Body body_of(const assets::Shape& shape, double domain_size) {
    sim::Body body;
    body.name = "body";
    body.domain_size = domain_size;
    body.source.geometry = shape;
    body.regions = {region("all", all())};
    body.skins = {{"outside", {}}};
    return body;
}

/// n[0] × n[1] × n[2] domains of edge s with the lowest corner at `low`.
inline sim::Body box_body(const std::array<int, 3>& n,
                          double s,
                          const Vec3& low = Vec3::Zero()) {
    return body_of(assets::Box{low, low + s * Vec3(n[0], n[1], n[2])}, s);
}

}  // namespace tests
