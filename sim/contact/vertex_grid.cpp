#include "sim/contact/vertex_grid.h"

#include "sim/base/parallel.h"

namespace sim {

namespace {

constexpr double cell_size = 1.5;  // in domain edges; more where vertices spread over many
constexpr double most_cells_per_vertex = 8;
constexpr int chunk = 512;

}  // namespace

VertexGrid::VertexGrid(const ContactSurface& surface)
    : least_cell_(cell_size * surface.lattice->edge) {
    const std::size_t n = surface.vertices.size();
    at_.resize(n);
    sorted_.resize(n);
    of_.resize(n);
    for (int axis = 0; axis < 3; ++axis) {
        now_[axis].resize(n + 3);
        rest_[axis].resize(n + 3);
    }
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
    sort(surface);
}

void VertexGrid::choose_cells(const PaddedBounds& bounds) {
    low_ = bounds.low;
    const double most = most_cells_per_vertex * static_cast<double>(at_.size()) + 64;
    for (cell_ = least_cell_;; cell_ *= 2) {
        const Vec3p n = (bounds.high - bounds.low) / cell_ + 1;
        if (n[0] * n[1] * n[2] > most)
            continue;
        for (int axis = 0; axis < 3; ++axis)
            n_[axis] = static_cast<int>(n[axis]);
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
            now_[axis][s] = at_[v][axis];
            rest_[axis][s] = surface.vertices[v].rest[axis];
        }
    }
}

}  // namespace sim
