// The choice of a law at run time: once per batch of elements, not per element.
#pragma once

#include "sim/materials/fixed_corotated.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/stable_neo_hookean.h"
#include "sim/scene.h"

#include <stdexcept>

namespace sim {

/// visitor(law) with the law of `model`, so that
///   visit(model, [&](auto law) __attribute__((always_inline)) { psi = law.energy_density(F, mu, lambda); });
/// compiles one loop per law. The lambda is marked so that it takes its caller's instruction set.
/// Throws std::logic_error for what is no Model.
template <class Visitor>
[[gnu::always_inline]] inline decltype(auto) visit(Model model, Visitor&& visitor) {
    switch (model) {
        case Model::NeoHookean:
            return visitor(NeoHookean{});
        case Model::StableNeoHookean:
            return visitor(StableNeoHookean{});
        case Model::FixedCorotated:
        case Model::Snow:
            // Between two steps; what a step leaves behind is not the law's business.
            return visitor(FixedCorotated{});
    }
    throw std::logic_error("sim::visit: the model is unknown");
}

}  // namespace sim
