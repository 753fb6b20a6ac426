// Shots of the paper's experiments, run and asked.
#pragma once

#include "shots/shot_file.h"
#include "sim/simulation.h"

#include <catch2/catch.hpp>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace tests {

/// The shot file `name` by `method`, with overrides "key.path=value" on top.
inline shots::Shot load(const std::string& name,
                        const std::string& method,
                        std::vector<std::string> overrides = {}) {
    overrides.push_back("solver.method=" + method);
    return shots::load_shot(SOURCE_ROOT "/shots/" + name + ".toml", overrides);
}

inline sim::ProbeRow probe(const sim::Simulation& simulation, const std::string& name) {
    for (const sim::ProbeRow& row : simulation.probes())
        if (row.name == name)
            return row;
    FAIL("no probe " << name);
    return {};
}

/// Mean stretch of each region that the shot probes.
inline std::map<std::string, double> stretches(const sim::Simulation& simulation) {
    std::map<std::string, double> of;
    for (const sim::ProbeRow& row : simulation.probes())
        if (row.is_region)
            of[row.name] = row.stretch;
    return of;
}

/// The same of a shot at `frame`.
inline std::map<std::string, double> stretches(const shots::Shot& shot, int frame) {
    sim::Simulation simulation(shot.scene, 1 / shot.fps);
    simulation.advance_to(shot.time_of(frame));
    return stretches(simulation);
}

/// Domains that share a face with a domain of another region.
inline int count_boundary_domains(const sim::Lattice& lattice) {
    std::map<std::array<int, 3>, int> region_at;
    for (int p = 0; p < lattice.n_domains(); ++p)
        region_at[lattice.cell[p]] = lattice.region[p];
    const auto differs = [&](std::array<int, 3> cell, int axis, int step, int region) {
        cell[axis] += step;
        const auto neighbour = region_at.find(cell);
        return neighbour != region_at.end() && neighbour->second != region;
    };
    int count = 0;
    for (const auto& [cell, region] : region_at) {
        bool is_boundary = false;
        for (int axis = 0; axis < 3; ++axis)
            is_boundary |= differs(cell, axis, -1, region) || differs(cell, axis, 1, region);
        count += is_boundary;
    }
    return count;
}

}  // namespace tests
