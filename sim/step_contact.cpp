// What contact adds to a step whose velocities are known: bodies that meet on the grid, and how the map lets it through.
#include "sim/contact/grid_contact.h"
#include "sim/stepper.h"

#include <algorithm>

namespace sim {

std::vector<GridPair> Stepper::pairs_on_grid() const {
    // Surface contact is between domains: points meet bodies on the grid in any case.
    std::vector<GridPair> pairs;
    const std::vector<AssembledBody>& bodies = assembly_.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (std::size_t j = i + 1; j < bodies.size(); ++j)
            if (scene_.contact.mode == Contact::Mode::Grid || bodies[i].points
                || bodies[j].points)
                pairs.push_back({{bodies[i].begin, bodies[i].end},
                                 {bodies[j].begin, bodies[j].end},
                                 std::max(bodies[i].lattice.edge, bodies[j].lattice.edge),
                                 friction_.between(int(i), int(j))});
    return pairs;
}

void Stepper::begin_contact(const Field& x) {
    impulses_.emplace(map_, inverse_mass_, potential_.step().is_free);
    grid_contact_.emplace(
        pairs_on_grid(), ContactFields{x, assembly_.mass, assembly_.volume, assembly_.outside});
}

bool Stepper::restrain_on_grid(const Field& x, double dt) {
    return grid_contact_->restrain(*impulses_, x, dt, q_moved_, moved_);
}

void Stepper::drift(const Field& x_n, double length) {
    x_end_.resize(x_n.size());
    for (std::size_t c = 0; c < x_n.size(); ++c)
        x_end_[c] = x_n[c] + length * moved_[c];
}

}  // namespace sim
