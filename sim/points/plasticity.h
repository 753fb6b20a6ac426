// How snow yields. [SSC13 §5]
#pragma once

#include "sim/points/material_points.h"

namespace sim {

/// After a step: the singular values of F are brought into [1 - compression_limit, 1 + stretch_limit]; the volume that F
/// loses goes over to J_plastic, so that J J_plastic stays. The rest of the plastic part is forgotten, as nothing depends
/// on it. Where a point was turned inside out its smallest stretch is taken as positive.
void yield(const SnowOptions& snow, Matrix3<double>& F, double& J_plastic);

/// The same, to rounding, of those among points [begin, end) that are snow, several side by side.
void yield(const MaterialPoints& points, int begin, int end, PointState& state);

}  // namespace sim
