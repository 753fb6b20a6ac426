#include "sim/contact/vertex_grid.h"

#include "sim/base/parallel.h"

namespace sim {

namespace {

constexpr double cell_size = 1.5;  // in domain edges; more where vertices spread over many
constexpr double most_cells_per_vertex = 8;
constexpr int chunk = 512;
constexpr double single_rounding = 0x1p-21;  // a few roundings of single precision

}  // namespace

VertexGrid::VertexGrid(const ContactSurface& surface)
    : least_cell_(cell_size * surface.lattice->edge) {
    const std::size_t n = surface.vertices.size();
    at_.resize(n);
    sorted_.resize(n);
    of_.resize(n);
    for (int axis = 0; axis < 3; ++axis) {
        now_[axis].resize(n + n_lanes - 1);
        rest_[axis].resize(n + n_lanes - 1);
    }
    PaddedBounds rest;
    for (const ContactVertex& vertex : surface.vertices)
        rest.add(padded(vertex.rest));
    rest_low_ = rest.low;
    rest_extent_ = rest.farthest(rest);
}

void VertexGrid::place(const ContactSurface& surface, const Field& corners) {
    const int n = static_cast<int>(at_.size());
    for_chunks(n, chunk, [&](int begin, int end) {
        for (int v = begin; v < end; ++v) {
            const ContactVertex& vertex = surface.vertices[v];
            at_[v] = Vec3p{};
            for (int a = 0; a < 8; ++a)
                at_[v] += vertex.weights[a] * corners[vertex.corners[a] - surface.begin];
        }
    });
    PaddedBounds bounds;
    for (const Vec3p& x : at_)
        bounds.add(x);
    choose_cells(bounds);
    rounding_ = single_rounding * (bounds.farthest(bounds) + rest_extent_ + 4 * least_cell_);
    sort(surface);
}

void VertexGrid::choose_cells(const PaddedBounds& bounds) {
    low_ = bounds.low;
    const double most = most_cells_per_vertex * static_cast<double>(at_.size()) + 64;
    for (double cell = least_cell_;; cell *= 2) {
        const Vec3p n = (bounds.high - bounds.low) / cell + 1;
        if (n[0] * n[1] * n[2] > most)
            continue;
        for (int axis = 0; axis < 3; ++axis) {
            n_[axis] = static_cast<int>(n[axis]);
            last_[axis] = n_[axis] - 1;
        }
        inverse_cell_ = 1 / cell;
        return;
    }
}

void VertexGrid::sort(const ContactSurface& surface) {
    const int n = static_cast<int>(at_.size());
    start_.assign(n_[0] * n_[1] * n_[2] + 2, 0);
    for (int v = 0; v < n; ++v) {
        const auto [i, j, k] = cell_of(at_[v]);
        of_[v] = i + n_[0] * (j + n_[1] * k);
        ++start_[of_[v] + 2];
    }
    for (std::size_t c = 1; c < start_.size(); ++c)
        start_[c] += start_[c - 1];
    // Each start moves on to where the next cell begins.
    for (int v = 0; v < n; ++v) {
        const int s = start_[of_[v] + 1]++;
        sorted_[s] = v;
        for (int axis = 0; axis < 3; ++axis) {
            now_[axis][s] = static_cast<float>(at_[v][axis] - low_[axis]);
            rest_[axis][s] =
                static_cast<float>(surface.vertices[v].rest[axis] - rest_low_[axis]);
        }
    }
}

}  // namespace sim
