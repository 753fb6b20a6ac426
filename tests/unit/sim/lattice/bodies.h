// Bodies of plain shapes for the lattice's tests.
#pragma once

#include "sim/lattice/lattice.h"

#include <string>
#include <utility>

inline sim::Region region(std::string name, sim::Selector select, double young_modulus = 1e6) {
    sim::Region made;
    made.select = std::move(select);
    made.select.key = "body.b.region." + name + ".select";
    made.name = std::move(name);
    made.young_modulus = young_modulus;
    made.poisson_ratio = 0.3;
    made.density = 1000;
    return made;
}

inline sim::Selector all() {
    return {sim::Selector::All{}, {}};
}

inline sim::Selector box(const Vec3& min, const Vec3& max) {
    return {assets::Box{min, max}, {}};
}

/// A part between two planes across the x axis.
inline sim::Selector between(double x0, double x1) {
    return box({x0, -1e3, -1e3}, {x1, 1e3, 1e3});
}

inline sim::Body body(assets::Shape shape, double domain_size) {
    sim::Body made;
    made.name = std::string("b");
    made.source = {shape, {}};
    made.domain_size = domain_size;
    made.regions = {region("hard", all())};
    return made;
}
