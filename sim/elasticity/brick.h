// A block of domains in structure-of-arrays form, the unit of work of the elastic kernels.
#pragma once

#include "sim/materials/lanes.h"
#include "sim/scene.h"

#include <array>
#include <vector>

namespace sim {

/// A brick is a dense box of lattice cells with its own copy of the corners. lane_count slots in a row, slot o being the
/// domain whose lowest corner has local index o, form a batch: their corners a lie at o + step[a], so every access is one
/// contiguous vector and no index is stored. Slots without a domain, row ends among them, have zero volume and moduli and
/// take part as undeformed.
///
/// Rows of slots run along the lattice's x, y or z, the brick's axes being the lattice's in turn: a rotation, which no
/// isotropic law sees. F and what follows from it are in the brick's axes.
struct Brick {
    int n_local = 0;             // local corners, padded: whole batches that stay inside
    int first_local = 0;         // of this brick among those of all bricks
    std::array<int, 8> step{};   // local index offset of corner a
    std::vector<int> batch;      // first slot of each batch that holds a domain
    std::vector<int> domain;     // (lane_count #batches) domain of each slot, -1 where none
    std::vector<unsigned> laws;  // (#batches) bit m set where a slot has model m

    std::vector<Lanes> volume;      // (#batches) filled volume V [m³]
    std::vector<Lanes> mu, lambda;  // (#batches) [Pa]
    std::vector<Lanes> law;         // (#batches) sim::Model as a number
    std::vector<Lanes> hourglass;   // (#batches) stiffness of the bilinear hourglass modes [N/m]
    std::vector<Lanes> weight;      // (#batches) V mu [J]

    // (45 #batches) ∂P/∂F over mu, upper triangle. The one array that a product of K reads once and cannot keep in a
    // cache is in single precision: Newton's direction is inexact anyway, the gradient that it serves is not.
    std::vector<FloatLanes> stiffness;
};

/// What a pass over a brick reads and writes: structure of arrays, n_local entries per component.
struct BrickFields {
    const double* in[3];  // corner positions x or displacements u [m]
    double* out[3];       // added to: gradient [N], product K u [N], or the diagonal of K [N/m]
    double* out_right
        [3];  // the same for corners on the right of a domain, one entry to the left of their place: a sum
    // that overlaps the one just stored would wait for it to reach the cache
};

/// ∂E/∂x is added to `out`; returns the energy E = Σ V Ψ(F) + E_hg [J], +infinity where a law forbids the state.
double add_brick_gradient(const Brick& brick, double edge, const BrickFields& fields);

/// ∂P/∂F of every domain at corners `in`, exact (may be indefinite).
void linearize_brick(Brick& brick, double edge, const BrickFields& fields);

/// Replaces ∂P/∂F by its positive semi-definite projection, domain by domain, where it is indefinite.
void project_brick(Brick& brick, double edge, const BrickFields& fields);

/// K u is added to `out`.
void add_brick_product(const Brick& brick, double edge, const BrickFields& fields);

/// The diagonal of K, up to terms that cancel between equal neighbours, is added to `out`.
void add_brick_diagonal(const Brick& brick, double edge, const BrickFields& fields);

/// J = det F of each slot of a batch at corners `in`; 1 for empty slots.
Lanes brick_J(const Brick& brick, int batch, double edge, const BrickFields& fields);

}  // namespace sim
