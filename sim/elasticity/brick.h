// A block of domains in structure-of-arrays form, the unit of work of the elastic kernels.
#pragma once

#include "sim/materials/lanes.h"
#include "sim/scene.h"

#include <array>
#include <vector>

namespace sim {

/// Domains that follow each other in all four rows of their corners: corners of lane l are l places further than those of the
/// first, so that every access is one contiguous vector. Slots without a domain, row ends among them, have zero volume and
/// moduli and take part as undeformed.
struct Batch {
    // Places of corners 0, 2, 4 and 6 of the first lane; 1, 3, 5 and 7 follow.
    std::array<int, 4> row;
    std::array<int, lane_count> domain;  // -1 where none
    bool continues = false;  // whether its rows begin where those of the batch before end
};

/// The domains of a box of cells, with their own copy of the corners in rows (BrickLayout).
///
/// Rows run along the lattice's x, y or z, the brick's axes being the lattice's in turn: a rotation, which no isotropic law sees.
/// F and what follows from it are in the brick's axes.
struct Brick {
    int n_local = 0;      // local corners, padded: whole batches that stay inside
    int first_local = 0;  // of this brick among those of all bricks
    std::vector<Batch> batch;
    std::vector<unsigned> laws;  // (#batches) bit m set where a slot has model m

    std::vector<Lanes> volume;      // (#batches) filled volume V [m³]
    std::vector<Lanes> mu, lambda;  // (#batches) [Pa]
    std::vector<Lanes> law;         // (#batches) sim::Model as a number
    std::vector<Lanes> hourglass;  // (#batches) stiffness of the bilinear hourglass modes [N/m]
    std::vector<Lanes> weight;     // (#batches) V mu [J]
    std::vector<Lanes> wave_compliance;  // (#batches) see wave_compliances() [1/Pa]

    // (45 #batches) ∂P/∂F over mu, upper triangle. The one array that a product of K reads once and cannot keep in a
    // cache is in single precision: Newton's direction is inexact anyway, the gradient that it serves is not.
    std::vector<FloatLanes> stiffness;
};

/// What a pass over a brick reads and writes: structure of arrays, n_local entries per component.
struct BrickFields {
    const double* in[3];  // corner positions x or displacements u [m]
    double* out[3];       // added to: gradient [N], product K u [N], or the diagonal of K [N/m]
};

/// Whether registers hold two batches: where they do not, halves are spilled all the time.
bool has_pair_registers();

/// ∂E/∂x is added to `out`; returns the energy E = Σ V Ψ(F) + E_hg [J], +infinity where a law forbids the state. The same to the
/// last bit whether two batches are taken at a time or one.
double add_brick_gradient(const Brick& brick,
                          double edge,
                          const BrickFields& fields,
                          bool takes_pairs);

/// ∂P/∂F of every domain at corners `in`, exact (may be indefinite).
void linearize_brick(Brick& brick, double edge, const BrickFields& fields);

/// Replaces ∂P/∂F by its positive semi-definite projection, domain by domain, where it is indefinite.
void project_brick(Brick& brick, double edge, const BrickFields& fields);

/// K u is added to `out`.
void add_brick_product(const Brick& brick, double edge, const BrickFields& fields);

/// The diagonal of K, up to terms that cancel between equal neighbours, is added to `out`.
void add_brick_diagonal(const Brick& brick, double edge, const BrickFields& fields);

/// ElasticEnergy::stiffening() of a brick.
double brick_stiffening(const Brick& brick, double edge, const BrickFields& fields);

/// J = det F of each slot (#batches) at corners `in`; 1 for empty slots.
void find_J(const Brick& brick, double edge, const BrickFields& fields, Lanes* J);

}  // namespace sim
