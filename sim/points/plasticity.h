// How snow yields. [SSC13 §5]
#pragma once

#include "sim/points/material_points.h"

namespace sim {

/// The singular values of F are brought into [1 - compression_limit, 1 + stretch_limit], F = U σ Vᵀ becomes F Y with
/// Y = V (σ'/σ) Vᵀ; the volume that it loses goes over to J_plastic, so that J J_plastic stays. The rest of the plastic part is
/// forgotten, as nothing depends on it. So does F_n, from which a motion has led to F: the same motion leads from F_n Y to
/// F Y. Where a point was turned inside out its smallest stretch is taken as positive; where it was flat, as one
/// of 1e-9. What is not finite stays as it is.
void yield(const SnowOptions& snow,
           Matrix3<double>& F,
           Matrix3<double>& F_n,
           double& J_plastic);

/// The same, to rounding, of those among n points `yielding` that are snow, several side by side; returns whether any of
/// them did.   F, F_n, J_plastic (#P)
bool yield(const MaterialPoints& points,
           const int* yielding,
           int n,
           Matrix3<double>* F,
           Matrix3<double>* F_n,
           double* J_plastic);

}  // namespace sim
