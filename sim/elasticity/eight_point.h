// The elastic energy of one body with eight Gauss points per domain: the accuracy reference.
#pragma once

#include "sim/elasticity/elastic_energy.h"
#include "sim/elasticity/fbar.h"

#include <vector>

namespace sim {

/// E(x) = Σ_p V_p/8 Σ_g Ψ_p(F̄_g), F̄_g = F_g (J_c/J_g)^⅓: the volume change at the centre stands for that of the domain, so
/// that nearly incompressible materials do not lock. [SNPD96, as an energy: the gradient is exact, and K symmetric] A state
/// with J <= 0 at any point is forbidden for every law.
///
/// K is kept domain by domain, 24×24 in single precision. Its negative eigenvalues are set to zero where it is to be
/// projected.
class EightPoint : public ElasticEnergy {
  public:
    EightPoint(const Lattice& lattice, const Body& body);

    double energy_and_gradient(const Vec3p* x, Vec3p* gradient) override;
    void linearize(const Vec3p* x, bool project) override;
    void product(const Vec3p* u, Vec3p* product) override;
    void diagonal(Vec3p* diagonal) override;
    double stiffening(const Vec3p* x) const override;
    SmallestJ smallest_J(const Vec3p* x) const override;

  private:
    CornerValues values_of(int p, const Vec3p* field) const;
    void keep(int p, const CornerValues& values);
    void gather(Vec3p* field) const;

    CubeGradients gradients_;
    std::vector<std::array<int, 8>> corners_;  // (#D)
    std::vector<FbarDomain> domains_;          // (#D)
    std::vector<double> wave_compliances_;     // (#D)
    std::vector<int> begin_, entries_;  // of corner c: [begin_[c], begin_[c + 1]) of 8 p + a
    std::vector<Vec3p> parts_;          // (8 #D) what domains add to their corners
    std::vector<float> stiffness_;      // (576 #D) [N/m]
};

}  // namespace sim
