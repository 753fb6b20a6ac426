// How snow yields. [SSC13 §5]
#pragma once

#include "sim/materials/lanes.h"
#include "sim/scene.h"

namespace sim {

/// After a step: the singular values of F are brought into [1 - compression_limit, 1 + stretch_limit]; the volume that F
/// loses goes over to J_plastic, so that J J_plastic stays. The rest of the plastic part is forgotten, as nothing depends
/// on it. Where a point was turned inside out its smallest stretch is taken as positive.
void yield(const SnowOptions& snow, Matrix3<double>& F, double& J_plastic);

}  // namespace sim
