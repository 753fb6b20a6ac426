#include "sim/contact/surface_contact.h"

#include "sim/base/parallel.h"
#include "sim/embedding/trilinear.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double stiffness = 100;  // k / (E A / s): depth s/100 under a pressure E
constexpr double wave_factor =
    2;  // of speed over wave speed, where bodies meet faster than that
constexpr double slip_speed = 1e-3;    // [m/s]
constexpr double neighbourhood = 2.5;  // left out of self-contact, in domain edges
constexpr double fold_distance =
    1.7;  // of domain centres that are no neighbours: nothing touches beyond, in domain edges
constexpr double fold_reach = 0.5;  // that is then left to move, in domain edges
constexpr double shell_depth =
    2.5;  // of domains that a vertex may be found in, in domain edges
constexpr double extrapolation = 0.6;       // of a domain's map, in domain edges
constexpr double share_of_thickness = 0.4;  // that bodies may approach in a step
constexpr double least_margin =
    0.25;  // around bodies where vertices are looked at, in domain edges
constexpr int vertex_chunk = 256;
constexpr int restrain_sweeps = 4;

struct Bounds {
    Vec3 low = Vec3::Constant(infinity), high = Vec3::Constant(-infinity);

    void add(const Vec3& x) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }

    bool contains(const Vec3& x, double margin) const {
        return ((x - low).array() >= -margin).all() && ((high - x).array() >= -margin).all();
    }

    double distance(const Bounds& other) const {
        return (other.low - high).cwiseMax(low - other.high).cwiseMax(0.0).norm();
    }
};

Bounds bounds_of(const SurfaceBody& body, const Field& x) {
    Bounds bounds;
    for (int c = 0; c < body.lattice->n_corners(); ++c)
        bounds.add(unpadded(x[body.begin + c]));
    return bounds;
}

std::array<Vec3, 8> domain_corners(const SurfaceBody& body, int p, const Field& x) {
    std::array<Vec3, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = unpadded(x[body.begin + body.lattice->corners[p][a]]);
    return corners;
}

Vec3 mean(const std::array<Vec3, 8>& corners) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : corners)
        sum += x / 8;
    return sum;
}

/// Domains that a vertex may be found in before it is pushed out.
std::vector<int> shell_of(const SurfaceBody& body) {
    const Lattice& lattice = *body.lattice;
    std::vector<int> shell;
    for (int p = 0; p < lattice.n_domains(); ++p) {
        const auto& cell = lattice.cell[p];
        const Vec3 centre =
            lattice.origin
            + lattice.edge * (Vec3(cell[0], cell[1], cell[2]) + Vec3::Constant(0.5));
        Vec3 ignored;
        if (body.surface.distance.at(centre, ignored) > -shell_depth * lattice.edge)
            shell.push_back(p);
    }
    return shell;
}

Vec3 carried_point(const std::array<int, 8>& corners,
                   const std::array<double, 8>& weights,
                   const Field& x) {
    Vec3p sum{};
    for (int a = 0; a < 8; ++a)
        sum += weights[a] * x[corners[a]];
    return unpadded(sum);
}

/// Local coordinates of a point in a deformed domain, by Newton's method; how far outside [0,1]³ they are.
double invert_trilinear(const std::array<Vec3, 8>& corners, const Vec3& point, Vec3& xi) {
    xi = Vec3::Constant(0.5);
    for (int iteration = 0; iteration < 8; ++iteration) {
        const auto w = trilinear_weights(xi);
        Vec3 at = Vec3::Zero();
        for (int a = 0; a < 8; ++a)
            at += w[a] * corners[a];
        const Mat3 gradient = trilinear_gradient(xi, 1, corners);
        const double J = gradient.determinant();
        if (!(J > 0))
            return infinity;
        const Vec3 step = gradient.inverse() * (point - at);
        xi += step;
        if (!(xi.cwiseAbs().maxCoeff() < 4))
            return infinity;
        if (step.squaredNorm() < 1e-24)
            break;
    }
    return (-xi).cwiseMax(xi - Vec3::Ones()).cwiseMax(0.0).maxCoeff();
}

/// Along the surface's outer normal at a vertex today, F^-T grad phi. Where a body is crushed, a vertex also nears places
/// of its own side: only what faces it can be met.
Vec3 outward(const SurfaceBody& body, const ContactVertex& vertex, const Field& x) {
    Vec3 gradient;
    body.surface.distance.at(vertex.rest, gradient);
    std::array<Vec3, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = unpadded(x[vertex.corners[a]]);
    const Mat3 F =
        trilinear_gradient(local_coordinates(vertex.weights), body.lattice->edge, corners);
    return F.inverse().transpose() * gradient;
}

}  // namespace

struct SurfaceContact::Place {
    int domain = -1;
    Vec3 xi{0, 0, 0};
    double outside = infinity;
};

SurfaceContact::SurfaceContact(std::vector<SurfaceBody> bodies, const Friction& friction)
    : bodies_(std::move(bodies)), friction_(friction) {
    const int n = static_cast<int>(bodies_.size());
    for (int a = 0; a < n; ++a) {
        shell_.push_back(shell_of(bodies_[a]));
        for (int b = 0; b < n; ++b)
            pairs_.push_back({a, b, 0});
    }
    margins_.assign(pairs_.size(), 0);
    speeds_.assign(pairs_.size(), 0);
}

void SurfaceContact::begin_step(const Field& x_n,
                                const Field& x_expected,
                                const std::vector<double>& top_speed,
                                double dt) {
    x_n_ = x_n;
    dt_ = dt;
    contacts_.clear();
    active_.clear();
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        Pair& pair = pairs_[k];
        const double speed = top_speed[pair.of_vertices] + top_speed[pair.of_domains];
        const double edge = bodies_[pair.of_domains].lattice->edge;
        margins_[k] = std::max(least_margin * edge, speed * dt);
        pair.reach -= speed * dt;
        if (pair.reach > margins_[k] || !may_touch(pair, x_n, margins_[k], pair.reach))
            continue;
        active_.push_back(static_cast<int>(k));
        speeds_[k] = speed;
        find_contacts(static_cast<int>(k), x_expected, margins_[k], contacts_);
    }
    for (Contact& contact : contacts_)
        prepare(contact);
}

bool SurfaceContact::may_touch(const Pair& pair,
                               const Field& x,
                               double margin,
                               double& reach_left) const {
    const SurfaceBody &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
    if (pair.of_vertices == pair.of_domains) {
        if (is_folded(pair.of_domains, x)) {
            reach_left = 0;
            return true;
        }
        reach_left = fold_reach * b.lattice->edge;
        return false;
    }
    const double distance = bounds_of(a, x).distance(bounds_of(b, x));
    reach_left = distance;
    return distance <= margin;
}

bool SurfaceContact::is_folded(int index, const Field& x) const {
    // Whether two domains of the shell are near each other that were not at rest.
    const SurfaceBody& body = bodies_[index];
    const double edge = body.lattice->edge, least = fold_distance * edge;
    const std::vector<int>& shell = shell_[index];
    std::vector<Vec3> centres;
    for (const int p : shell)
        centres.push_back(mean(domain_corners(body, p, x)));
    const PointGrid grid(centres, least);
    for (std::size_t i = 0; i < shell.size(); ++i) {
        bool found = false;
        const auto& cell = body.lattice->cell[shell[i]];
        grid.near(centres[i], [&](int j) {
            if (static_cast<std::size_t>(j) <= i || found)
                return;
            const auto& other = body.lattice->cell[shell[j]];
            double squared = 0;
            for (int k = 0; k < 3; ++k)
                squared += std::pow(cell[k] - other[k], 2);
            found = squared > neighbourhood * neighbourhood
                    && (centres[i] - centres[j]).squaredNorm() < least * least;
        });
        if (found)
            return true;
    }
    return false;
}

void SurfaceContact::find_contacts(int k,
                                   const Field& x,
                                   double margin,
                                   std::vector<Contact>& found) const {
    const Pair& pair = pairs_[k];
    const SurfaceBody &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
    const bool is_self = pair.of_vertices == pair.of_domains;
    const double edge = b.lattice->edge;

    // The other body's shell near this one, sorted by place.
    const Bounds region = bounds_of(a, x);
    std::vector<int> domains;
    std::vector<Vec3> centres;
    double radius = 0;
    Bounds shell_bounds;
    for (const int p : shell_[pair.of_domains]) {
        const std::array<Vec3, 8> corners = domain_corners(b, p, x);
        const Vec3 centre = mean(corners);
        double r = 0;
        for (const Vec3& corner : corners)
            r = std::max(r, (corner - centre).norm());
        if (!region.contains(centre, r + margin))
            continue;
        radius = std::max(radius, r);
        domains.push_back(p);
        centres.push_back(centre);
        shell_bounds.add(centre);
    }
    if (domains.empty())
        return;
    const double search = radius + extrapolation * edge;
    const PointGrid grid(centres, search);

    // Vertices in chunks of a fixed size, their contacts in order.
    const auto& vertices = a.surface.vertices;
    const int n = static_cast<int>(vertices.size());
    std::vector<std::vector<Contact>> parts((n + vertex_chunk - 1) / vertex_chunk);
    for_chunks(n, vertex_chunk, [&](int begin, int end) {
        for (int v = begin; v < end; ++v) {
            const ContactVertex& vertex = vertices[v];
            const Vec3 point = carried_point(vertex.corners, vertex.weights, x);
            if (!shell_bounds.contains(point, search))
                continue;
            const Place place =
                locate(b, grid, domains, x, point, is_self ? &vertex.rest : nullptr);
            if (place.domain < 0)
                continue;
            Contact contact;
            contact.vertex = &vertex;
            contact.pair = k;
            if (!linearize_depth(b, place, x, contact) || contact.phi > margin
                || (is_self && contact.normal.dot(outward(a, vertex, x)) > 0))
                continue;
            parts[begin / vertex_chunk].push_back(contact);
        }
    });
    for (const std::vector<Contact>& part : parts)
        found.insert(found.end(), part.begin(), part.end());
}

SurfaceContact::Place SurfaceContact::locate(const SurfaceBody& body,
                                             const PointGrid& grid,
                                             const std::vector<int>& domains,
                                             const Field& x,
                                             const Vec3& point,
                                             const Vec3* rest_of_self) const {
    const Lattice& lattice = *body.lattice;
    Place best;
    grid.near(point, [&](int i) {
        const int p = domains[i];
        if (rest_of_self != nullptr) {
            const auto& cell = lattice.cell[p];
            const Vec3 centre =
                lattice.origin
                + lattice.edge * (Vec3(cell[0], cell[1], cell[2]) + Vec3::Constant(0.5));
            if ((centre - *rest_of_self).norm() < neighbourhood * lattice.edge)
                return;
        }
        Vec3 xi;
        const double outside = invert_trilinear(domain_corners(body, p, x), point, xi);
        if (outside > extrapolation || outside > best.outside
            || (outside == best.outside && p > best.domain))
            return;
        best = {p, xi, outside};
    });
    return best;
}

bool SurfaceContact::linearize_depth(const SurfaceBody& body,
                                     const Place& place,
                                     const Field& x,
                                     Contact& contact) const {
    const Lattice& lattice = *body.lattice;
    const auto& cell = lattice.cell[place.domain];
    const Vec3 X = lattice.origin + lattice.edge * (Vec3(cell[0], cell[1], cell[2]) + place.xi);
    Vec3 gradient;
    contact.phi = body.surface.distance.at(X, gradient);
    const Mat3 F =
        trilinear_gradient(place.xi, lattice.edge, domain_corners(body, place.domain, x));
    if (!(F.determinant() > 0) || !(gradient.squaredNorm() > 0.01))
        return false;  // on the middle of a body no side is nearer than another
    contact.normal = F.inverse().transpose() * gradient;
    contact.weights = trilinear_weights(place.xi);
    contact.edge = lattice.edge;
    for (int a = 0; a < 8; ++a)
        contact.corners[a] = body.begin + lattice.corners[place.domain][a];
    return true;
}

void SurfaceContact::prepare(Contact& contact) const {
    const ContactVertex& vertex = *contact.vertex;
    const double scale = std::max(1.0, wave_factor * speeds_[contact.pair] / vertex.wave_speed);
    contact.stiffness = stiffness * scale * vertex.young_modulus * vertex.area / contact.edge;
    contact.start = separation(contact, x_n_);
    const double depth = depth_of(contact, contact.start);
    contact.touched = depth > 0;
    contact.slip_length = slip_speed * dt_;
    const double force = friction_.coefficient * contact.stiffness * depth;
    if (!contact.touched || !(contact.slip_length > 0) || !(friction_.stick || force > 0))
        return;
    contact.grip_force = friction_.stick ? infinity : force;
    contact.grip_stiffness = friction_.stick ? contact.stiffness : force / contact.slip_length;
    if (friction_.stick)
        contact.slip_length = infinity;
}

double SurfaceContact::relinearize(const Field& x) {
    std::map<std::pair<const ContactVertex*, int>, double> depth_before;
    for (const Contact& contact : contacts_)
        if (const double depth = depth_of(contact, separation(contact, x)); depth > 0)
            depth_before[{contact.vertex, contact.pair}] = depth;
    contacts_.clear();
    for (const int k : active_)
        find_contacts(k, x, margins_[k], contacts_);
    for (Contact& contact : contacts_)
        prepare(contact);
    double worst = 0;
    for (const Contact& contact : contacts_) {
        const double depth = depth_of(contact, separation(contact, x));
        const auto before = depth_before.find({contact.vertex, contact.pair});
        const double was = before == depth_before.end() ? 0 : before->second;
        worst = std::max(worst, std::abs(depth - was) / contact.edge);
        if (before != depth_before.end())
            depth_before.erase(before);
    }
    for (const auto& [key, depth] : depth_before)  // no longer near
        worst = std::max(worst, depth / bodies_[pairs_[key.second].of_domains].lattice->edge);
    return worst;
}

double SurfaceContact::largest_step(const Field& x,
                                    const std::vector<double>& top_speed,
                                    double dt) const {
    double limit = infinity;
    for (const Pair& pair : pairs_) {
        const double speed = top_speed[pair.of_vertices] + top_speed[pair.of_domains];
        double reach_left = 0;
        if (pair.reach > speed * dt || !may_touch(pair, x, speed * dt, reach_left))
            continue;
        const SurfaceBody &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
        const double thickness =
            std::min({b.lattice->edge, a.surface.thickness, b.surface.thickness});
        limit = std::min(limit, std::max(reach_left, share_of_thickness * thickness) / speed);
    }
    return limit;
}

Vec3 SurfaceContact::separation(const Contact& contact, const Field& x) {
    return carried_point(contact.vertex->corners, contact.vertex->weights, x)
           - carried_point(contact.corners, contact.weights, x);
}

void SurfaceContact::scatter(const Contact& contact, const Vec3& f, Field& field) {
    const Vec3p force = padded(f);
    for (int a = 0; a < 8; ++a) {
        field[contact.vertex->corners[a]] += contact.vertex->weights[a] * force;
        field[contact.corners[a]] -= contact.weights[a] * force;
    }
}

double SurfaceContact::add_gradient(const Field& x, Field& gradient) const {
    double energy = 0;
    for (const Contact& contact : contacts_) {
        const Vec3 apart = separation(contact, x);
        const double depth = depth_of(contact, apart);
        if (!(depth > 0) && !(contact.grip_force > 0))
            continue;
        energy += contact.stiffness / 2 * depth * depth;
        Vec3 g = -contact.stiffness * depth * contact.normal;
        if (contact.grip_force > 0) {
            const Vec3 unit = contact.normal.normalized(), u = apart - contact.start;
            const Vec3 slip = u - unit * unit.dot(u);
            const double y = slip.norm();
            const bool holds = y < contact.slip_length;
            energy += holds ? contact.grip_stiffness / 2 * y * y
                            : contact.grip_force * (y - contact.slip_length / 2);
            g += (holds ? contact.grip_stiffness : contact.grip_force / y) * slip;
        }
        scatter(contact, g, gradient);
    }
    return energy;
}

void SurfaceContact::linearize(const Field& x) {
    for (Contact& contact : contacts_) {
        const Vec3 apart = separation(contact, x);
        Mat3& H = contact.hessian = Mat3::Zero();
        if (depth_of(contact, apart) > 0)
            H += contact.stiffness * contact.normal * contact.normal.transpose();
        if (contact.grip_force > 0) {
            const Vec3 unit = contact.normal.normalized();
            const Mat3 P = Mat3::Identity() - unit * unit.transpose();
            const Vec3 slip = P * (apart - contact.start);
            const double y = slip.norm();
            if (y < contact.slip_length)
                H += contact.grip_stiffness * P;
            else
                H += contact.grip_force / y * (P - slip * slip.transpose() / (y * y));
        }
    }
}

void SurfaceContact::add_product(const Field& u, Field& product) const {
    for (const Contact& contact : contacts_)
        scatter(contact, contact.hessian * separation(contact, u), product);
}

void SurfaceContact::add_diagonal(Field& diagonal) const {
    for (const Contact& contact : contacts_) {
        const Vec3p d = padded(contact.hessian.diagonal());
        for (int a = 0; a < 8; ++a) {
            const double w = contact.vertex->weights[a], N = contact.weights[a];
            diagonal[contact.vertex->corners[a]] += w * w * d;
            diagonal[contact.corners[a]] += N * N * d;
        }
    }
}

bool SurfaceContact::has_touch(const Field& x) const {
    return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
        return contact.touched || depth_of(contact, separation(contact, x)) > 0;
    });
}

void SurfaceContact::restrain(const Field& x, const Field& m, double dt, Field& v) const {
    for (int sweep = 0; sweep < restrain_sweeps; ++sweep)
        for (const Contact& contact : contacts_) {
            const Vec3 rate = separation(contact, v), n = contact.normal;
            const double gap = contact.phi + n.dot(separation(contact, x) + dt * rate);
            if (!(gap < 0))
                continue;
            double inverse_mass = 0;
            for (int a = 0; a < 8; ++a)
                inverse_mass +=
                    std::pow(contact.vertex->weights[a], 2) / m[contact.vertex->corners[a]][0]
                    + std::pow(contact.weights[a], 2) / m[contact.corners[a]][0];
            const double push = -gap / (dt * n.squaredNorm() * inverse_mass);
            const Vec3 unit = n.normalized();
            const Vec3 slip = rate - unit * unit.dot(rate);
            const double most =
                friction_.stick ? infinity : friction_.coefficient * push * n.norm();
            const double hold =
                std::min(1 / inverse_mass, most / std::max(slip.norm(), 1e-300));
            const Vec3p impulse = padded(push * n - hold * slip);
            for (int a = 0; a < 8; ++a) {
                const int c = contact.vertex->corners[a], o = contact.corners[a];
                v[c] += contact.vertex->weights[a] / m[c][0] * impulse;
                v[o] -= contact.weights[a] / m[o][0] * impulse;
            }
        }
}

SurfaceContact::Report SurfaceContact::report(const Field& x) const {
    Report report;
    std::vector<Contact> found;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const double margin = reach * bodies_[pairs_[k].of_domains].lattice->edge;
        double ignored = 0;
        if (may_touch(pairs_[k], x, margin, ignored))
            find_contacts(static_cast<int>(k), x, margin, found);
    }
    for (const Contact& contact : found) {
        report.penetration = std::max(report.penetration, -contact.phi / contact.edge);
        report.gap = std::min(report.gap, std::max(0.0, contact.phi) / contact.edge);
    }
    return report;
}

}  // namespace sim
