#include "sim/contact/domain_map.h"

namespace sim {

namespace {

constexpr int most_iterations = 8;
constexpr double enough = 1e-12;  // of a step in u
constexpr double close = 1e-6;    // of the last one, which leaves about its square
constexpr double farthest = 3.5;  // u where the domain has been left for good

}  // namespace

double DomainMap::bend(const PaddedMatrix& at_centre, double most) const {
    Vec3p sum{};
    for (const int of_two : {3, 5, 6})
        sum += magnitude(at_centre.solve(x_[of_two]));
    sum += most * magnitude(at_centre.solve(x_[7]));
    return most * most * largest_entry(sum);
}

bool DomainMap::invert(const Vec3p& point, Vec3p& u) const {
    double squared = 0;  // of a step
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        const PaddedMatrix slope = gradient(u);
        if (!(slope.determinant > 0))
            return false;
        const Vec3p step = slope.solve(point - at(u));
        u += step;
        if (!(largest_entry(magnitude(u)) < farthest))
            return false;
        squared = dot(step, step);
        if (squared < enough * enough)
            break;
    }
    return squared < close * close;
}

}  // namespace sim
