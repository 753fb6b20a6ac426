// What contact adds to a step whose velocities are known: bodies that meet on the grid, and how the map lets it through.
#include "sim/contact/grid_contact.h"
#include "sim/stepper.h"

#include <algorithm>

namespace sim {

namespace {

// Where corners are slaved the map gives in part only what contact asks for, so it asks again.
constexpr int passes_where_slaved = 4;

}  // namespace

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

void Stepper::begin_contact_on_grid(const Field& x) {
    grid_contact_.emplace(
        pairs_on_grid(),
        ContactFields{
            x, assembly_.mass, assembly_.volume, assembly_.outside, prescribed_.is_free});
}

bool Stepper::exchange_contact(const Field& x, double dt) {
    GridContact& contact = *grid_contact_;
    if (contact.is_empty())
        return false;
    bool have_met = false;
    corner_.resize(moved_.size());
    for (int pass = 0; pass < (map_.is_identity() ? 1 : passes_where_slaved); ++pass) {
        Field& wanted = corner_;
        for (const int c : contact.corners())
            wanted[c] = moved_[c];
        if (!contact.exchange(x, dt, wanted))
            break;
        have_met = true;
        move_through_grid(contact.corners(), wanted);
    }
    return have_met;
}

void Stepper::move_through_grid(const std::vector<int>& corners, Field& wanted) {
    // A slaved corner can only move as its grid does. Were it given more, the next step would not know of it, ask for
    // the same again, and pile up speed: so a change goes through the map, T M⁻¹ Tᵀ m, free corners as it is. Only
    // `corners` are given another velocity, mostly few; in place of it `wanted` then holds the momentum to gain.
    const Field& is_free = potential_.step().is_free;
    q_change_.resize(map_.n_dofs());
    for (const int c : corners)
        wanted[c] = assembly_.mass[c] * (wanted[c] - moved_[c]) * prescribed_.is_free[c];
    map_.apply_transposed_of(corners, wanted, q_change_);
    for (int i = 0; i < map_.n_dofs(); ++i) {
        q_change_[i] *= inverse_mass_[i] * is_free[i];
        q_moved_[i] += q_change_[i];
    }
    map_.add_applied(q_change_, moved_);
}

void Stepper::drift(const Field& x_n, double length) {
    x_end_.resize(x_n.size());
    for (std::size_t c = 0; c < x_n.size(); ++c)
        x_end_[c] = x_n[c] + length * moved_[c];
}

}  // namespace sim
