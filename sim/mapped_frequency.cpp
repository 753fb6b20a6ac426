#include "sim/mapped_frequency.h"

#include "sim/elasticity/power_method.h"

#include <algorithm>
#include <random>

namespace sim {

double highest_frequency(ElasticEnergy& energy,
                         const Lattice& lattice,
                         const CornerMap& map,
                         int body,
                         int first_corner) {
    Field x;
    for (const Vec3& X : lattice.corner_rest)
        x.push_back(padded(X));
    energy.linearize(x.data(), true);

    const std::size_t n_corners = map.dof_of_corner().size();
    const int n_dofs = map.n_dofs();
    Field at_corners(n_corners), masses(n_dofs);
    for (int c = 0; c < lattice.n_corners(); ++c)
        at_corners[first_corner + c] = padded(Vec3::Constant(lattice.corner_mass[c]));
    map.apply_transposed(at_corners, masses);
    std::vector<double> mass;
    for (const Vec3p& m : masses)
        mass.push_back(m[0]);

    std::mt19937 random(1);
    const auto number = [&] { return random() / double(std::mt19937::max()) - 0.5; };
    Field guess;
    for (int i = 0; i < n_dofs; ++i)
        guess.push_back(Vec3p{number(), number(), number(), 0});

    const Field rest(n_corners);
    Field u, f(n_corners);
    return fastest_mode(guess, mass, [&](const Field& q, Field& Kq) {
        map.move_bodies({{body}}, rest, 1, q, u);
        energy.product(&u[first_corner], &f[first_corner]);
        map.apply_transposed(f, Kq);
    });
}

}  // namespace sim
