// The laws at material points, four points side by side.
#pragma once

#include "sim/grid/corner_map.h"
#include "sim/materials/lanes.h"
#include "sim/points/stretch_limits.h"

#include <functional>
#include <vector>

namespace sim {

/// What a point is made of, in the order that lanes are loaded in.
struct alignas(32) PointLaw {
    double volume = 0;          // at rest [m³]
    double mu = 0, lambda = 0;  // [Pa]
    double model = 0;           // Model as a number
};

/// Points of a body in the order in which the grid visits them. Point of slave s: corner[s] - first_corner.
struct PointsOfSlaves {
    const int* corner = nullptr;
    int first_corner = 0;
    const PointLaw* law = nullptr;         // (#P)
    unsigned models = 0;                   // bit m set where a point has model m
    const Matrix3<double>* F_n = nullptr;  // (#P) at the start of the step
};

/// A range of slaves of one body; batches of four start at its first.
struct SlaveRange {
    int begin = 0, end = 0;

    int n_batches() const { return (end - begin + lane_count - 1) / lane_count; }
};

/// ∂P/∂F seen from the velocity gradients, of a batch: what δ(dt ∇v) does to P F_nᵀ, over V mu.
struct PointStiffness {
    FloatLanes A[45];  // upper triangle, see packed()
};

/// Which points of a body yield. Called for those of a batch of which any may have left its limits.
struct Yielding {
    const StretchLimits* limits = nullptr;  // (#regions)
    const int* region = nullptr;            // (#P)
    std::function<void(const int* point, int n)> yield;
};

/// F = (1 + dt ∇v) F_n from the gradients in `values`.   F (#P)
void deform(const PointsOfSlaves& points,
            const SlaveRange& range,
            double dt,
            const Gradient* values,
            Matrix3<double>* F);

/// Sets `values` to V P(F) F_nᵀ and returns Σ V Ψ(F) [J], +infinity where a law forbids F.   F (#P)
double take_stresses(const PointsOfSlaves& points,
                     const SlaveRange& range,
                     const Matrix3<double>* F,
                     Gradient* values);

/// Both for F = (1 + ∇u) F_n, where points yield in between if `yielding` is not null: F, F_n and laws are then those that
/// `yield` has left.
double deform_and_take_stresses(const PointsOfSlaves& points,
                                const SlaveRange& range,
                                const Yielding* yielding,
                                Matrix3<double>* F,
                                Gradient* values);

/// Stiffness at F = (1 + dt ∇v) F_n of each batch, and V mu of its points [J]; `project`: positive semi-definite.
void take_stiffness(const PointsOfSlaves& points,
                    const SlaveRange& range,
                    double dt,
                    const Gradient* values,
                    bool project,
                    PointStiffness* stiffness,
                    Lanes* weight);

/// Replaces gradients δ∇u by δ(V P F_nᵀ).
void multiply(const PointStiffness* stiffness,
              const Lanes* weight,
              const SlaveRange& range,
              Gradient* values);

/// Sets entry (i, j) of `values` to the stiffness of the (i, j) component against itself.
void take_diagonal(const PointStiffness* stiffness,
                   const Lanes* weight,
                   const SlaveRange& range,
                   Gradient* values);

}  // namespace sim
