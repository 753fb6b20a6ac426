#include "sim/contact/fold_watch.h"

#include "sim/base/parallel.h"
#include "sim/contact/contact_search.h"
#include "sim/contact/point_grid.h"
#include "sim/embedding/trilinear.h"
#include "sim/materials/signed_svd.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

constexpr int vertex_chunk = 256;
constexpr double continued = 0.25;  // of domains beyond themselves, in domain edges
constexpr double watched = 0.75;    // that distances are looked at up to, in domain edges
constexpr double rounding = 1e-9;   // of distances, in domain edges
constexpr int n_directions = 13;

double squared_norm(const Vec3p& x) {
    return dot(x, x);
}

/// Axes, and diagonals of the faces and of the cube.
const std::array<Vec3, n_directions> directions = [] {
    std::array<Vec3, n_directions> made;
    for (int n = 0; n < n_directions; ++n) {
        const int code = n + 14;  // one half of the 26 neighbours of a cell
        made[n] = Vec3(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1).normalized();
    }
    return made;
}();

/// A continued domain from outside: its extent in each direction, and a ball.
struct Hull {
    Vec3 centre{0, 0, 0}, rest_centre{0, 0, 0};
    double radius = 0;
    std::array<double, n_directions> low{}, high{};

    Hull(const std::array<Vec3, 8>& corners, const Vec3& at_rest) : rest_centre(at_rest) {
        for (const Vec3& x : corners)
            centre += x / 8;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        constexpr double end = 1 + continued;
        for (int a = 0; a < 8; ++a) {
            const auto w = trilinear_weights(
                {a & 1 ? end : -continued, a & 2 ? end : -continued, a & 4 ? end : -continued});
            Vec3 x = Vec3::Zero();
            for (int b = 0; b < 8; ++b)
                x += w[b] * corners[b];
            radius = std::max(radius, (x - centre).norm());
            for (int k = 0; k < n_directions; ++k) {
                const double along = directions[k].dot(x);
                low[k] = std::min(low[k], along);
                high[k] = std::max(high[k], along);
            }
        }
    }

    /// At most the distance of x; not above zero only where neither the ball nor any direction parts them.   [m]
    double distance(const Vec3& x) const {
        double most = (x - centre).norm() - radius;
        for (int k = 0; k < n_directions; ++k) {
            const double along = directions[k].dot(x);
            most = std::max({most, along - high[k], low[k] - along});
        }
        return most;
    }
};

}  // namespace

/// Seen from a frame that flies and turns with a body, it does not move when it does that alone.
struct FoldWatch::OwnFrame {
    Vec3p centre{};
    std::array<Vec3p, 3> column{};  // of the rotation into the frame

    /// The rotation is that of the polar decomposition of Σ x (X - X_mean)^T, `from_rest_centre` being X - X_mean.
    OwnFrame(const Field& x, int begin, const Field& from_rest_centre) {
        std::array<Vec3p, 3> sum{};
        for (std::size_t c = 0; c < from_rest_centre.size(); ++c) {
            const Vec3p at = x[begin + c];
            centre += at;
            for (int k = 0; k < 3; ++k)
                sum[k] += from_rest_centre[c][k] * at;
        }
        centre /= double(from_rest_centre.size());
        Mat3 covariance;
        covariance << unpadded(sum[0]), unpadded(sum[1]), unpadded(sum[2]);
        const auto [U, stretch, V] = signed_svd(covariance);
        const Mat3 inverse = V * U.transpose();
        for (int k = 0; k < 3; ++k)
            column[k] = padded(inverse.col(k));
    }

    Vec3p seen(const Vec3p& x) const {
        const Vec3p from_centre = x - centre;
        return from_centre[0] * column[0] + from_centre[1] * column[1]
               + from_centre[2] * column[2];
    }

    Vec3 seen(const Vec3& x) const { return unpadded(seen(padded(x))); }

    std::array<Vec3, 8> seen(std::array<Vec3, 8> corners) const {
        for (Vec3& x : corners)
            x = seen(x);
        return corners;
    }
};

FoldWatch::FoldWatch(const ContactSurface& surface) : surface_(&surface) {
    for (const ContactVertex& vertex : surface.vertices) {
        double sum = 0;
        for (const double w : vertex.weights)
            sum += std::abs(w);
        of_vertex_ = std::max(of_vertex_, sum);
    }
    Vec3 rest_centre = Vec3::Zero();
    for (const Vec3& X : surface.lattice->corner_rest)
        rest_centre += X / surface.lattice->n_corners();
    for (const Vec3& X : surface.lattice->corner_rest)
        from_rest_centre_.push_back(padded(X - rest_centre));
}

void FoldWatch::see(const Field& x, const OwnFrame& frame) {
    seen_.resize(surface_->lattice->n_corners());
    for (std::size_t c = 0; c < seen_.size(); ++c)
        seen_[c] = frame.seen(x[surface_->begin + c]);
}

double FoldWatch::most_change(double enough) const {
    if (looked_at_.empty())
        return std::numeric_limits<double>::infinity();
    double squared = 0;
    for (std::size_t c = 0; c < seen_.size(); ++c)
        squared = std::max(squared, squared_norm(seen_[c] - looked_at_[c]));
    // A vertex moves with its corners, a domain with its centre and, seen from there, a continued corner by up to the sum
    // of its weights times what its corners do.
    const double moved = std::sqrt(squared), of_centres = (of_vertex_ + 1) * moved,
                 of_continued = std::pow(1 + 2 * continued, 3);
    if (of_centres + of_continued * 2 * moved < enough)
        return of_centres + of_continued * 2 * moved;
    return of_centres + of_continued * most_strained();
}

double FoldWatch::most_strained() const {
    double squared = 0;
    for (const int p : surface_->shell) {
        std::array<Vec3p, 8> moved;
        Vec3p sum{};
        for (int a = 0; a < 8; ++a) {
            const int c = surface_->lattice->corners[p][a];
            moved[a] = seen_[c] - looked_at_[c];
            sum += moved[a];
        }
        for (int a = 0; a < 8; ++a)
            squared = std::max(squared, squared_norm(moved[a] - sum / 8.0));
    }
    return std::sqrt(squared);
}

const std::vector<int>& FoldWatch::strangers(const Field& x) {
    // Steps ask twice for where the last one has ended.
    const auto first = x.begin() + surface_->begin,
               last = first + surface_->lattice->n_corners();
    const auto is_same = [](const Vec3p& a, const Vec3p& b) {
        return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
    };
    if (!std::equal(asked_.begin(), asked_.end(), first, last, is_same)) {
        asked_.assign(first, last);
        found_ = find_strangers(x);
    }
    return found_;
}

std::vector<int> FoldWatch::find_strangers(const Field& x) {
    const double edge = surface_->lattice->edge;
    const OwnFrame frame(x, surface_->begin, from_rest_centre_);
    see(x, frame);
    double change = most_change(watched * edge) + rounding * edge;
    if (!(change < watched * edge)) {
        near_ = look_around(frame, x);
        looked_at_ = seen_;
        change = rounding * edge;
    }
    std::vector<int> found;
    for (const Near& near : near_) {
        if (near.distance > change || (!found.empty() && found.back() == near.vertex))
            continue;
        const Hull hull(frame.seen(surface_->domain_corners(near.domain, x)), Vec3::Zero());
        if (hull.distance(frame.seen(surface_->vertices[near.vertex].position(x))) <= 0)
            found.push_back(near.vertex);
    }
    return found;
}

std::vector<FoldWatch::Near> FoldWatch::look_around(const OwnFrame& frame,
                                                    const Field& x) const {
    const double edge = surface_->lattice->edge, stranger = neighbourhood * edge;
    std::vector<Hull> hulls;
    std::vector<Vec3> centres;
    Field balls;  // around hulls and what is watched of their surroundings: centre, radius²
    double largest = 0;
    for (const int p : surface_->shell) {
        const Hull& hull = hulls.emplace_back(frame.seen(surface_->domain_corners(p, x)),
                                              surface_->domain_centre(p));
        const double reach = hull.radius + watched * edge;
        centres.push_back(hull.centre);
        balls.push_back(padded(hull.centre) + Vec3p{0, 0, 0, reach * reach});
        largest = std::max(largest, reach);
    }
    const PointGrid grid(centres, largest);
    const int n = static_cast<int>(surface_->vertices.size());
    std::vector<std::vector<Near>> parts((n + vertex_chunk - 1) / vertex_chunk);
    for_chunks(n, vertex_chunk, [&](int begin, int end) {
        for (int v = begin; v < end; ++v) {
            const Vec3 at = frame.seen(surface_->vertices[v].position(x)),
                       rest = surface_->vertices[v].rest;
            const Vec3p at_padded = padded(at);
            grid.near(at, [&](int i) {
                const Vec3p apart = at_padded - balls[i];
                if (dot(apart, apart) >= balls[i][3]
                    || (hulls[i].rest_centre - rest).squaredNorm() < stranger * stranger)
                    return;
                const double distance = hulls[i].distance(at);
                if (distance < watched * edge)
                    parts[begin / vertex_chunk].push_back({v, surface_->shell[i], distance});
            });
        }
    });
    std::vector<Near> result;
    for (const std::vector<Near>& part : parts)
        result.insert(result.end(), part.begin(), part.end());
    return result;
}

}  // namespace sim
