#include "sim/contact/contact_surface.h"

#include "sim/embedding/embedding.h"

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <numeric>

namespace sim {

namespace {

constexpr double spacing = 0.5;    // of samples, in domain edges
constexpr double cluster = 0.4;    // at most one vertex per cube of this edge, in domain edges
constexpr double voxel = 1.0 / 3;  // of the distance field, in domain edges
constexpr double shell_depth = 2.5;  // in domain edges

struct Sample {
    Vec3 position{0, 0, 0};
    double area = 0;
};

/// The vertices of a mesh, then points on its triangles no further apart than `distance`. Each part of a triangle
/// gives a third of its area to each of its corners.
std::vector<Sample> samples_of(const assets::TriangleMesh& mesh, double distance) {
    std::vector<Sample> samples;
    for (const Vec3& x : mesh.positions)
        samples.push_back({x, 0});
    for (const auto& triangle : mesh.triangles) {
        const Vec3 &A = mesh.positions[triangle[0]], &B = mesh.positions[triangle[1]],
                   &C = mesh.positions[triangle[2]];
        const double longest = std::max({(B - A).norm(), (C - B).norm(), (A - C).norm()});
        const int n = std::max(1, static_cast<int>(std::ceil(longest / distance)));
        const double third = (B - A).cross(C - A).norm() / 6 / (n * n);
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n - i; ++j) {
                // Of six parts around an inner point; three on an edge, one at a corner.
                const int zeros = (i == 0) + (j == 0) + (i + j == n);
                const double area = third * (zeros == 0 ? 6 : zeros == 1 ? 3 : 1);
                if (zeros == 2)
                    samples[triangle[i == n ? 1 : j == n ? 2 : 0]].area += area;
                else
                    samples.push_back({A + (B - A) * i / n + (C - A) * j / n, area});
            }
    }
    return samples;
}

/// The first sample in each cube of edge `size` stands for all of them.
std::vector<Sample> thinned(const std::vector<Sample>& samples, double size) {
    std::map<std::array<int, 3>, std::size_t> of_cube;
    std::vector<Sample> result;
    for (const Sample& sample : samples) {
        std::array<int, 3> cube;
        for (int k = 0; k < 3; ++k)
            cube[k] = static_cast<int>(std::floor(sample.position[k] / size));
        const auto [at, is_new] = of_cube.try_emplace(cube, result.size());
        if (is_new)
            result.push_back(sample);
        else
            result[at->second].area += sample.area;
    }
    return result;
}

assets::DistanceField field_of(const Body& body, double edge) {
    const double size = voxel * edge;
    return {*assets::make_solid(body.source, size, 4 * edge), size};
}

}  // namespace

ContactSurface::ContactSurface(const Body& body,
                               const Lattice& body_lattice,
                               int first_corner,
                               int index)
    : distance(field_of(body, body_lattice.edge)),
      lattice(&body_lattice),
      scene_body(index),
      begin(first_corner),
      cells(body_lattice) {
    const double s = lattice->edge;
    const assets::Surface surface = assets::make_surface(body.source, spacing * s);
    const std::vector<Sample> samples =
        thinned(samples_of(surface.mesh, spacing * s), cluster * s);
    std::vector<Vec3> points;
    Vec3 low = samples.front().position, high = low;
    for (const Sample& sample : samples) {
        points.push_back(sample.position);
        low = low.cwiseMin(sample.position);
        high = high.cwiseMax(sample.position);
    }
    thickness = (high - low).minCoeff();
    const std::vector<Binding> bindings = bind_points(*lattice, points);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const int p = bindings[i].domain;
        ContactVertex vertex;
        vertex.rest = points[i];
        vertex.domain = p;
        vertex.weights = bindings[i].weights;
        vertex.area = samples[i].area;
        vertex.young_modulus = lattice->young_modulus(p);
        vertex.wave_speed = std::sqrt(vertex.young_modulus / lattice->density[p]);
        for (int a = 0; a < 8; ++a)
            vertex.corners[a] = begin + lattice->corners[p][a];
        vertices.push_back(vertex);
        double sum = 0;
        for (const double w : vertex.weights)
            sum += std::abs(w);
        largest_weight_sum = std::max(largest_weight_sum, sum);
    }
    for (int p = 0; p < lattice->n_domains(); ++p) {
        Vec3 ignored;
        if (distance.at(domain_centre(p), ignored) > -shell_depth * s)
            shell.push_back(p);
    }
}

Vec3 ContactSurface::domain_centre(int p) const {
    const auto& cell = lattice->cell[p];
    return lattice->origin
           + lattice->edge * (Vec3(cell[0], cell[1], cell[2]) + Vec3::Constant(0.5));
}

std::array<Vec3p, 8> ContactSurface::domain_corners(int p, const Field& x) const {
    std::array<Vec3p, 8> corners;
    for (int a = 0; a < 8; ++a)
        corners[a] = x[begin + lattice->corners[p][a]];
    return corners;
}

std::vector<int> ContactSurface::all_vertices() const {
    std::vector<int> indices(vertices.size());
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
}

}  // namespace sim
