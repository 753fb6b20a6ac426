#include "sim/contact/surface_contact.h"

#include "sim/base/parallel.h"
#include "sim/contact/contact_search.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double stiffness = 40;  // k / (E A / s): depth s/40 under a pressure E
// Of speed over wave speed, where bodies meet faster than that.
constexpr double wave_factor = 32;
// At a body on its way; one that moves by more domain edges in itself is not waited for.
constexpr int most_looks = 8;
constexpr double share_of_thickness = 0.4;  // that bodies may approach in a step
// Of a gap that had to be shifted, in domain edges per second.
constexpr double rest_recovery = 0.1;
// The same, as a share of the speed at which bodies may meet.
constexpr double impact_recovery = 0.25;
constexpr double same_plane = 0.97;  // cosine between the normals of what is one plane, bent
constexpr double rounding = 1e-12;   // of speeds
// Around bodies where vertices are looked at, in domain edges.
constexpr double least_margin = 0.25;

}  // namespace

SurfaceContact::SurfaceContact(std::vector<ContactSurface> bodies,
                               const PairFriction& friction,
                               double hardness)
    : hardness_(hardness), bodies_(std::move(bodies)), near_(bodies_) {
    const int n = static_cast<int>(bodies_.size());
    for (int a = 0; a < n; ++a) {
        folds_.emplace_back(bodies_[a]);
        for (int b = 0; b < n; ++b)
            pairs_.push_back(
                {a, b, friction.between(bodies_[a].scene_body, bodies_[b].scene_body)});
    }
}

std::vector<SurfaceContact::Extent> SurfaceContact::extents(const Field& x,
                                                            const Field& v) const {
    std::vector<Extent> result(bodies_.size());
    for_chunks(static_cast<int>(bodies_.size()), 1, [&](int b, int /*end*/) {
        const int begin = bodies_[b].begin, end = begin + bodies_[b].lattice->n_corners();
        Extent& extent = result[b];
        PaddedBounds velocities;
        Vec3p sum{};
        for (int c = begin; c < end; ++c) {
            extent.bounds.add(x[c]);
            velocities.add(v[c]);
            sum += v[c];
        }
        const Vec3p mean = sum / double(end - begin);
        extent.velocity = unpadded(mean);
        extent.most_spread = (1 + rounding) * velocities.farthest({mean, mean});
    });
    return result;
}

double SurfaceContact::spread(int body, const Field& v) {
    Extent& extent = extents_[body];
    if (!extent.spread) {
        const int begin = bodies_[body].begin, end = begin + bodies_[body].lattice->n_corners();
        const Vec3p mean = padded(extent.velocity);
        double squared = 0;
        for (int c = begin; c < end; ++c)
            squared = std::max(squared, dot(v[c] - mean, v[c] - mean));
        extent.spread = std::sqrt(squared);
    }
    return *extent.spread;
}

double SurfaceContact::approach(const Pair& pair, const Field& v) {
    const Vec3 apart = extents_[pair.of_vertices].velocity - extents_[pair.of_domains].velocity;
    return apart.norm() + spread(pair.of_vertices, v) + spread(pair.of_domains, v);
}

double SurfaceContact::most_approach(const Pair& pair) const {
    const Extent &a = extents_[pair.of_vertices], &b = extents_[pair.of_domains];
    return (a.velocity - b.velocity).norm() + a.most_spread + b.most_spread;
}

double SurfaceContact::distance(const Pair& pair, const std::vector<Extent>& extents) {
    return extents[pair.of_vertices].bounds.distance(extents[pair.of_domains].bounds);
}

bool SurfaceContact::may_fold(const Pair& pair, const Start& start, double way, double dt) {
    // On its way a vertex is seen in a domain that it goes through, if looked at once per domain edge.
    const ContactSurface& body = bodies_[pair.of_domains];
    const double looks = std::ceil(way / body.lattice->edge);
    if (looks > most_looks)
        return true;
    const int n = std::max(1, static_cast<int>(looks));
    Field x(start.x.size());
    for (int k = 0; k <= n; ++k) {
        for (int c = body.begin; c < body.begin + body.lattice->n_corners(); ++c)
            x[c] = start.x[c] + (dt * k / n) * start.v[c];
        if (!folds_[pair.of_domains].strangers(x).empty())
            return true;
    }
    return false;
}

double SurfaceContact::largest_step(const Start& start, double dt) {
    if (empty())
        return infinity;
    double limit = infinity;
    for (const Pair& pair : pairs_) {
        const double apart = distance(pair, extents_);
        const ContactSurface &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
        const double thickness = std::min({b.lattice->edge, a.thickness, b.thickness}),
                     way = std::max(apart, share_of_thickness * thickness);
        if (way >= most_approach(pair) * dt)
            continue;
        const double speed = approach(pair, start.v);
        if (way < speed * dt && (!pair.is_self() || may_fold(pair, start, speed * dt, dt)))
            limit = std::min(limit, way / speed);
    }
    return limit;
}

void SurfaceContact::see_end(const Field& x) {
    const std::vector<Extent> there = extents(x, x);
    for (std::size_t b = 0; b < extents_.size(); ++b) {
        extents_[b].bounds.add(there[b].bounds.low);
        extents_[b].bounds.add(there[b].bounds.high);
    }
}

void SurfaceContact::begin_step(const Start& start, const Field& x_expected, double dt) {
    n_linearized_ = 0;
    x_n_ = start.x;
    held_ = start.held;
    dt_ = dt;
    for (Pair& pair : pairs_) {
        const double edge = bodies_[pair.of_domains].lattice->edge, least = least_margin * edge;
        // Speeds that widen no margin, of a pair that is not within it, change nothing.
        const bool matters = most_approach(pair) * dt > least
                             || (!pair.is_self() && distance(pair, extents_) <= least);
        const double speed = matters ? approach(pair, start.v) : 0;
        pair.margin = std::max(least, speed * dt);
        pair.recovery =
            std::max(rest_recovery * edge, pair.is_self() ? 0 : impact_recovery * speed) * dt;
        pair.top_speed = start.top_speed[bodies_[pair.of_vertices].scene_body]
                         + start.top_speed[bodies_[pair.of_domains].scene_body];
        pair.is_near = !pair.is_self() && distance(pair, extents_) <= pair.margin;
    }
    find(x_expected);
}

void SurfaceContact::find(const Field& x) {
    contacts_.clear();
    rows_.clear();
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        for (const ContactPoint& point : found(pairs_[k], x))
            contacts_.push_back(prepared(point, static_cast<int>(k)));
}

std::vector<ContactPoint> SurfaceContact::found(const Pair& pair, const Field& x) {
    const ContactSurface &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
    if (pair.is_self())
        return find_contacts(a, folds_[pair.of_domains].strangers(x), b, x, x_n_, pair.margin);
    if (!pair.is_near)
        return {};
    return find_listed_contacts(a, near(pair, x), b, x, x_n_, pair.margin);
}

const NearDomains& SurfaceContact::near(const Pair& pair, const Field& x) {
    const double edge = bodies_[pair.of_domains].lattice->edge;
    return near_.near(pair.of_vertices, pair.of_domains, x, pair.margin / edge);
}

SurfaceContact::Contact SurfaceContact::prepared(const ContactPoint& point, int k) const {
    Contact contact;
    static_cast<ContactPoint&>(contact) = point;
    const Pair& pair = pairs_[k];
    const ContactVertex& vertex = *contact.vertex;
    contact.pair = k;
    contact.index = static_cast<int>(&vertex - bodies_[pair.of_vertices].vertices.data());
    const double scale = std::max(1.0, wave_factor * pair.top_speed / vertex.wave_speed);
    contact.stiffness =
        hardness_ * stiffness * scale * vertex.young_modulus * vertex.area / contact.edge;

    const Vec3 start = contact.separation(x_n_);
    if (const double depth = contact.depth(start); depth > 0) {
        const double held = std::sqrt(2 * held_energy(k, contact.index) / contact.stiffness);
        contact.start_depth = std::min(depth, held + pair.recovery);
        contact.gap += depth - contact.start_depth;
    }
    contact.start_gap = contact.gap + contact.normal.dot(start);
    contact.grip = Grip::of(
        pair.friction, contact.stiffness, contact.start_depth, dt_, contact.normal, start);
    return contact;
}

double SurfaceContact::held_energy(int pair, int vertex) const {
    const auto found = std::lower_bound(held_.begin(),
                                        held_.end(),
                                        std::pair(pair, vertex),
                                        [](const HeldContact& held, auto key) {
                                            return std::pair(held.pair, held.vertex) < key;
                                        });
    const bool is_held = found != held_.end() && found->pair == pair && found->vertex == vertex;
    return is_held ? found->energy : 0;
}

std::vector<HeldContact> SurfaceContact::held(const Field& x) const {
    std::vector<HeldContact> result;
    for (const Contact& contact : contacts_)
        if (const double depth = contact.depth(contact.separation(x)); depth > 0)
            result.push_back(
                {contact.pair, contact.index, contact.stiffness / 2 * depth * depth});
    return result;
}

double SurfaceContact::relinearize(const Field& x) {
    const std::vector<Contact> before = std::move(contacts_);
    find(x);
    const double worst = mismatch(before, contacts_, x);
    if (++n_linearized_ > 1)
        keep(before);
    return worst;
}

double SurfaceContact::mismatch(const std::vector<Contact>& before,
                                const std::vector<Contact>& after,
                                const Field& x) {
    // One that is in only one of them has no depth in the other.
    double worst = 0;
    auto old = before.begin(), now = after.begin();
    while (old != before.end() || now != after.end()) {
        const auto key = old == before.end()  ? now->key()
                         : now == after.end() ? old->key()
                                              : std::min(old->key(), now->key());
        const auto deepest = [&](auto& contact, const auto& end) {
            double depth = 0;
            for (; contact != end && contact->key() == key; ++contact)
                depth = std::max(depth, contact->depth(contact->separation(x)) / contact->edge);
            return depth;
        };
        const double depth_before = deepest(old, before.end());
        worst = std::max(worst, std::abs(deepest(now, after.end()) - depth_before));
    }
    return worst;
}

void SurfaceContact::keep(const std::vector<Contact>& before) {
    std::vector<Contact> kept;
    auto now = contacts_.begin();
    for (const Contact& old : before) {
        while (now != contacts_.end() && now->key() < old.key())
            ++now;
        const bool is_same = now != contacts_.end() && now->key() == old.key()
                             && now->normal.dot(old.normal) > same_plane;
        if (!is_same)
            kept.push_back(old);
    }
    contacts_.insert(contacts_.end(), kept.begin(), kept.end());
    std::stable_sort(contacts_.begin(),
                     contacts_.end(),
                     [](const Contact& a, const Contact& b) { return a.key() < b.key(); });
}

double SurfaceContact::add_gradient(const Field& x, Field& gradient) const {
    double energy = 0;
    for (const Contact& contact : contacts_) {
        const Vec3 apart = contact.separation(x);
        const double depth = contact.depth(apart);
        if (!(depth > 0) && !contact.grip.holds())
            continue;
        energy += contact.stiffness / 2 * depth * depth;
        Vec3 g = -contact.stiffness * depth * contact.normal;
        if (contact.grip.holds())
            energy += contact.grip.add_gradient(apart, g);
        contact.scatter(g, gradient);
    }
    return energy;
}

void SurfaceContact::linearize(const Field& x) {
    rows_.clear();
    for (Contact& contact : contacts_) {
        const Vec3 apart = contact.separation(x);
        const bool touches = contact.depth(apart) > 0;
        if (!touches && !contact.grip.holds())
            continue;
        Mat3 H = Mat3::Zero();
        if (touches)
            H += contact.stiffness * contact.normal * contact.normal.transpose();
        if (contact.grip.holds()) {
            contact.grip.linearize(apart);
            H += contact.grip.hessian();
        }
        rows_.push_back({&contact, H});
    }
}

void SurfaceContact::add_product(const Field& u, Field& product) const {
    for (const Row& row : rows_)
        row.contact->scatter(row.hessian * row.contact->separation(u), product);
}

void SurfaceContact::add_diagonal(Field& diagonal) const {
    for (const auto& [contact, hessian] : rows_) {
        const Vec3p d = padded(hessian.diagonal());
        for (int a = 0; a < 8; ++a) {
            const double w = contact->vertex->weights[a], N = contact->weights[a];
            diagonal[contact->vertex->corners[a]] += w * w * d;
            diagonal[contact->corners[a]] += N * N * d;
        }
    }
}

bool SurfaceContact::touches(const Field& x) const {
    return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
        return contact.depth(contact.separation(x)) > 0;
    });
}

bool SurfaceContact::has_changed_touch(const Field& x) const {
    return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
        return (contact.depth(contact.separation(x)) > 0) != (contact.start_depth > 0);
    });
}

SurfaceContact::Report SurfaceContact::report(const Field& x) {
    Report report;
    const Field at_rest(x.size());
    const std::vector<Extent> all = extents(x, at_rest);
    for (const Pair& pair : pairs_) {
        const ContactSurface &a = bodies_[pair.of_vertices], &b = bodies_[pair.of_domains];
        const double margin = reach * b.lattice->edge;
        std::vector<int> vertices;
        if (pair.is_self())
            vertices = folds_[pair.of_domains].strangers(x);
        else if (distance(pair, all) <= margin)
            vertices = a.all_vertices();
        for (const ContactPoint& contact : find_contacts(a, vertices, b, x, x, margin)) {
            report.penetration = std::max(report.penetration, -contact.gap / contact.edge);
            report.gap = std::min(report.gap, std::max(0.0, contact.gap) / contact.edge);
        }
    }
    return report;
}

}  // namespace sim
