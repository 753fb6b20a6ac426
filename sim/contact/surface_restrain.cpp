#include "sim/contact/surface_contact.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int restrain_sweeps = 4;

double inverse_mass_of(const ContactPoint& contact, const Field& m) {
    double sum = 0;
    for (int a = 0; a < 8; ++a)
        sum += std::pow(contact.vertex->weights[a], 2) / m[contact.vertex->corners[a]][0]
               + std::pow(contact.weights[a], 2) / m[contact.corners[a]][0];
    return sum;
}

void add_impulse(const ContactPoint& contact, const Vec3& impulse, const Field& m, Field& v) {
    const Vec3p j = padded(impulse);
    for (int a = 0; a < 8; ++a) {
        const int c = contact.vertex->corners[a], o = contact.corners[a];
        v[c] += contact.vertex->weights[a] / m[c][0] * j;
        v[o] -= contact.weights[a] / m[o][0] * j;
    }
}

}  // namespace

bool SurfaceContact::restrain(const Field& x, const Field& m, double dt, Field& v) const {
    bool any = false;
    for (int sweep = 0; sweep < restrain_sweeps; ++sweep)
        for (const Contact& contact : contacts_) {
            const Vec3 rate = contact.separation(v);
            const double depth = contact.depth(contact.separation(x) + dt * rate);
            if (!(depth > 0))
                continue;
            any = true;
            // The impulse that ends the step where they touch, and friction of what slides then.
            const Vec3& n = contact.normal;
            const double inverse_mass = inverse_mass_of(contact, m);
            const double push = depth / (dt * inverse_mass);
            const Vec3 slip = rate - n * n.dot(rate);
            const Friction& friction = pairs_[contact.pair].friction;
            const double most = friction.stick ? std::numeric_limits<double>::infinity()
                                               : friction.coefficient * push;
            const double hold =
                std::min(1 / inverse_mass, most / std::max(slip.norm(), 1e-300));
            add_impulse(contact, push * n - hold * slip, m, v);
        }
    return any;
}

}  // namespace sim
