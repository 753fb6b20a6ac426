// The elastic energy of one body on its lattice: one point per domain, and a rotation-invariant hourglass energy.
#pragma once

#include "sim/elasticity/brick.h"
#include "sim/elasticity/elastic_energy.h"

#include <array>
#include <vector>

namespace sim {

/// E(x) = Σ_p V_p Ψ_p(F_p) + E_hg, with F_p = Σ_a x_a b_aᵀ at the centre of domain p (b_a = (±1, ±1, ±1)/(4s)), and
///
///   E_hg = Σ_p eps mu_p V_p/8 Σ_g |F_g - F_p|²   over the eight Gauss points g,
///
/// which vanishes on affine motion and is quadratic in x. In the modes h_m of a domain it is diagonal:
/// eps mu V / (24 s²) (Σ bilinear h_m² + 1/2 trilinear h_m²).
/// eps = (1+nu)/2 gives a domain bent along a lattice axis its exact stiffness E I, as incompatible modes would: the
/// mode u_x = ξζ stores eps mu 2/3, the beam E/6.
///
/// It runs in parallel itself, with the same result for any number of threads: bricks that share corners add to them one colour after the other.
class Elasticity : public ElasticEnergy {
  public:
    Elasticity(const Lattice& lattice, const Body& body);

    double energy_and_gradient(const Vec3p* x, Vec3p* gradient) override;
    void linearize(const Vec3p* x, bool project) override;
    void product(const Vec3p* u, Vec3p* product) override;
    void diagonal(Vec3p* diagonal) override;
    double stiffening(const Vec3p* x) const override;
    SmallestJ smallest_J(const Vec3p* x) const override;

    /// Whether gradients are taken of two batches at a time, which changes no bit of them.
    bool takes_pairs = has_pair_registers();

  private:
    /// A brick's corners and sums as its kernels want them, small enough for the second-level cache.
    struct Scratch {
        std::array<std::vector<double>, 3> in, out;  // per component, #local

        BrickFields fields(int n_local);
    };

    void fill_brick(const Lattice& lattice, const Body& body, const std::vector<int>& domains);
    static void add_batch(const Lattice& lattice,
                          const Body& body,
                          const Batch& batch,
                          Brick& brick);
    void add_wave_compliances(const Lattice& lattice);
    void load(const Brick& brick, const Vec3p* values, Scratch& scratch) const;
    void store(const Brick& brick, const Scratch& scratch, Vec3p* values) const;
    template <class Kernel>
    double for_bricks(const Vec3p* in, Vec3p* out, const Kernel& kernel);

    double edge_ = 0;
    std::vector<Brick> bricks_;     // by colour
    std::vector<int> color_start_;  // first brick of each colour, and their number
    // (#local of all bricks) -1 past the last one of a brick.
    std::vector<int> corner_of_local_;
    // (#local of all bricks) whether a brick before has written to the corner.
    std::vector<char> adds_;
};

}  // namespace sim
