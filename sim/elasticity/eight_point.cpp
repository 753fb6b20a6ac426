#include "sim/elasticity/eight_point.h"

#include "sim/base/parallel.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>

namespace sim {

namespace {

constexpr int n = 24, chunk = 64, corner_chunk = 1024;

/// Sets negative eigenvalues of K to zero. Nearly all K have none: then a Cholesky factor exists once the six zero ones of
/// rigid motion are lifted above rounding.
void project(float* stiffness) {
    using Matrix = Eigen::Matrix<double, n, n>;
    Eigen::Map<Eigen::Matrix<float, n, n>> stored(stiffness);
    const Matrix K = stored.cast<double>();
    constexpr double rounding = 1e-6;  // of single precision, relative to the mean eigenvalue
    if (Eigen::LLT<Matrix>(K + rounding * K.trace() / n * Matrix::Identity()).info()
        == Eigen::Success)
        return;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(K);
    stored = (eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal()
              * eigen.eigenvectors().transpose())
                 .cast<float>();
}

}  // namespace

EightPoint::EightPoint(const Lattice& lattice, const Body& body)
    : gradients_(lattice.edge),
      corners_(lattice.corners),
      wave_compliances_(wave_compliances(lattice)) {
    for (int p = 0; p < lattice.n_domains(); ++p)
        domains_.push_back({body.regions[lattice.region[p]].model,
                            lattice.domain_volume(p),
                            lattice.mu[p],
                            lattice.lambda[p]});
    begin_.assign(lattice.n_corners() + 1, 0);
    for (const auto& corners : corners_)
        for (const int c : corners)
            ++begin_[c + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(begin_.back());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (int p = 0; p < lattice.n_domains(); ++p)
        for (int a = 0; a < 8; ++a)
            entries_[next[corners_[p][a]]++] = 8 * p + a;
    parts_.resize(8 * corners_.size());
    stiffness_.resize(corners_.size() * n * n);
}

CornerValues EightPoint::values_of(int p, const Vec3p* field) const {
    CornerValues values;
    for (int a = 0; a < 8; ++a)
        for (int i = 0; i < 3; ++i)
            values[8 * i + a] = field[corners_[p][a]][i];
    return values;
}

void EightPoint::keep(int p, const CornerValues& values) {
    for (int a = 0; a < 8; ++a)
        parts_[8 * p + a] = Vec3p{values[a], values[8 + a], values[16 + a], 0};
}

void EightPoint::gather(Vec3p* field) const {
    for_chunks(static_cast<int>(begin_.size()) - 1, corner_chunk, [&](int first, int last) {
        for (int c = first; c < last; ++c) {
            Vec3p sum{};
            for (int k = begin_[c]; k < begin_[c + 1]; ++k)
                sum += parts_[entries_[k]];
            field[c] = sum;
        }
    });
}

double EightPoint::energy_and_gradient(const Vec3p* x, Vec3p* gradient) {
    const int n_domains = static_cast<int>(domains_.size());
    const double energy = sum_chunks(n_domains, chunk, [&](int first, int last) {
        double sum = 0;
        for (int p = first; p < last; ++p) {
            CornerValues forces{};
            sum += fbar_gradient(gradients_, domains_[p], values_of(p, x), forces);
            keep(p, forces);
        }
        return sum;
    });
    gather(gradient);
    return energy;
}

void EightPoint::linearize(const Vec3p* x, bool is_projected) {
    for_chunks(static_cast<int>(domains_.size()), chunk, [&](int first, int last) {
        for (int p = first; p < last; ++p) {
            float* K = &stiffness_[static_cast<std::size_t>(n) * n * p];
            fbar_stiffness(gradients_, domains_[p], values_of(p, x), K);
            if (is_projected)
                project(K);
        }
    });
}

void EightPoint::product(const Vec3p* u, Vec3p* product) {
    for_chunks(static_cast<int>(domains_.size()), chunk, [&](int first, int last) {
        for (int p = first; p < last; ++p) {
            CornerValues forces;
            fbar_product(
                &stiffness_[static_cast<std::size_t>(n) * n * p], values_of(p, u), forces);
            keep(p, forces);
        }
    });
    gather(product);
}

void EightPoint::diagonal(Vec3p* diagonal) {
    for_chunks(static_cast<int>(domains_.size()), chunk, [&](int first, int last) {
        for (int p = first; p < last; ++p) {
            const float* K = &stiffness_[static_cast<std::size_t>(n) * n * p];
            CornerValues values;
            double largest = 0;
            for (int k = 0; k < n; ++k)
                largest = std::max(largest, values[k] = K[(n + 1) * k]);
            for (double& value : values)  // negative where K is indefinite
                value = std::max(value, 1e-3 * largest);
            keep(p, values);
        }
    });
    gather(diagonal);
}

double EightPoint::stiffening(const Vec3p* x) const {
    double most = 1;
    for (std::size_t p = 0; p < domains_.size(); ++p)
        most = std::max(most,
                        wave_compliances_[p]
                            * fbar_wave_modulus(
                                gradients_, domains_[p], values_of(static_cast<int>(p), x)));
    return most;
}

EightPoint::SmallestJ EightPoint::smallest_J(const Vec3p* x) const {
    SmallestJ smallest{2e300, -1};
    for (std::size_t p = 0; p < domains_.size(); ++p) {
        const double J = fbar_smallest_J(gradients_, values_of(static_cast<int>(p), x));
        if (is_worse(J, smallest.J))
            smallest = {J, static_cast<int>(p)};
    }
    return smallest;
}

}  // namespace sim
