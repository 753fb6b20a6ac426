// Why a step could not be solved: where, what, and the likely cause.
#pragma once

#include "assets/base/error.h"
#include "sim/stepper.h"

namespace sim {

/// Names time, body, region, place and the likely cause, with one thing to try. `trial`: the corner positions that the
/// solver gave up at; `dt` = 0 for an equilibrium.
assets::Error diagnose(const Scene& scene,
                       Assembly& assembly,
                       const Stepper& stepper,
                       const State& state,
                       const Field& trial,
                       double dt,
                       const NewtonSummary& summary);

/// Where FlownApart was thrown in the step after `state`: names its time, and body, region, place and speed of what was fastest.
assets::Error diagnose_flown_apart(const Scene& scene,
                                   const Assembly& assembly,
                                   const State& state);

}  // namespace sim
