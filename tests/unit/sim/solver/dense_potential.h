// Potentials with dense derivatives, given by formulas.
#pragma once

#include "sim/solver/potential.h"

#include <Eigen/Dense>

#include <functional>
#include <vector>

namespace tests {

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline sim::Field to_field(const VectorXd& v) {
    sim::Field field(v.size() / 3);
    for (std::size_t i = 0; i < field.size(); ++i)
        field[i] = sim::padded(v.segment<3>(3 * i));
    return field;
}

inline VectorXd to_vector(const sim::Field& field) {
    VectorXd v(3 * field.size());
    for (std::size_t i = 0; i < field.size(); ++i)
        v.segment<3>(3 * i) = sim::unpadded(field[i]);
    return v;
}

struct Functions {
    std::function<double(const VectorXd&)> value;
    std::function<VectorXd(const VectorXd&)> gradient;
    std::function<MatrixXd(const VectorXd&)> hessian;
};

class DensePotential : public sim::Potential {
  public:
    explicit DensePotential(Functions f) : f_(std::move(f)) {}

    double value_and_gradient(const sim::Field& q, sim::Field& gradient) override {
        ++evaluations;
        gradient = to_field(f_.gradient(to_vector(q)));
        return f_.value(to_vector(q));
    }

    void linearize(const sim::Field& q, bool project) override {
        A_ = f_.hessian(to_vector(q));
        projections += project;
        if (project) {
            const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A_);
            A_ = eigen.eigenvectors()
                 * eigen.eigenvalues().cwiseMax(least_projected).asDiagonal()
                 * eigen.eigenvectors().transpose();
        }
        VectorXd inverse = VectorXd::Ones(A_.rows());
        for (int i = 0; i < A_.rows(); ++i)
            inverse[i] = A_(i, i) > 0 ? 1 / A_(i, i) : 1;
        for (const int i : held)
            inverse[i] = 0;
        inverse_diagonal_ = to_field(inverse);
    }

    double hessian_product(const sim::Field& p, sim::Field& product) override {
        product = to_field(A_ * to_vector(p));
        return to_vector(p).dot(to_vector(product));
    }

    const sim::Field& inverse_diagonal() const override { return inverse_diagonal_; }

    double gradient_scale() const override { return scale; }

    double gradient_noise() const override { return noise; }

    double value_noise() const override { return 0; }

    std::vector<int> held;         // components
    double least_projected = 0.1;  // eigenvalue that the projection leaves, as inertia does
    double scale = 1, noise = 0;
    int evaluations = 0, projections = 0;

  private:
    Functions f_;
    MatrixXd A_;
    sim::Field inverse_diagonal_;
};

/// q·A q / 2 - b·q.
inline Functions quadratic(const MatrixXd& A, const VectorXd& b) {
    return {[=](const VectorXd& q) { return q.dot(A * q) / 2 - b.dot(q); },
            [=](const VectorXd& q) -> VectorXd { return A * q - b; },
            [=](const VectorXd& /*q*/) { return A; }};
}

/// A symmetric matrix with eigenvalues from `low` to `high`.
inline MatrixXd symmetric(int n, double low, double high) {
    MatrixXd random(n, n);
    for (int k = 0; k < n * n; ++k)
        random.data()[k] = std::sin(1.0 + 7.3 * k * k);
    const MatrixXd Q = random.householderQr().householderQ();
    return Q * VectorXd::LinSpaced(n, low, high).asDiagonal() * Q.transpose();
}

}  // namespace tests
