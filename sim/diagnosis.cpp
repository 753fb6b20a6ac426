#include "sim/diagnosis.h"

#include "sim/base/cell_box.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace sim {

namespace {

struct Worst {
    int body = 0, domain = 0;
    double J = 0;
    Vec3 place{0, 0, 0};
};

/// The most compressed domain of all bodies.
Worst most_compressed(Assembly& assembly, const Stepper& stepper, const Field& x) {
    Worst worst;
    worst.J = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < assembly.bodies.size(); ++b) {
        AssembledBody& body = assembly.bodies[b];
        if (body.points) {
            const auto found = stepper.points(static_cast<int>(b))->smallest_trial_J();
            if (found.point >= 0 && is_worse(found.J, worst.J))
                worst = {static_cast<int>(b),
                         found.point,
                         found.J,
                         unpadded(x[body.begin + found.point])};
            continue;
        }
        const auto found = body.elasticity->smallest_J(&x[body.begin]);
        if (found.domain < 0 || !is_worse(found.J, worst.J))
            continue;
        Vec3 place = Vec3::Zero();
        for (const int c : body.lattice.corners[found.domain])
            place += unpadded(x[body.begin + c]) / 8;
        worst = {static_cast<int>(b), found.domain, found.J, place};
    }
    return worst;
}

std::string cause(const Scene& scene, const NewtonSummary& summary, double dt, double J) {
    if (dt == 0 && scene.pins.empty())
        return "nothing holds the body, so there is no equilibrium; pin it, or use steps = "
               "\"implicit\"";
    if (scene.solver.steps == Steps::SemiImplicit)
        return fmt::format(
            "one linearised solve is not enough for such a motion in a step of {:g} s; "
            "try --set solver.steps=implicit, or a smaller solver.dt",
            dt);
    if (summary.termination == Termination::NotFinite || !(J > 0))
        return dt > 0 ? fmt::format(
                   "pins or speeds squash domains flat within one step; try --set "
                   "solver.dt={:g}",
                   dt / 4)
                      : std::string(
                          "the pins move too far between two frames; use more frames, or move "
                          "them less");
    if (summary.termination == Termination::Unstable)
        return "an explicit step this short is still unstable: a domain is crushed or its "
               "modulus "
               "far above its density; try --set solver.steps=implicit";
    return dt > 0 ? fmt::format("the step is too long for the motion; try --set solver.dt={:g}",
                                dt / 4)
                  : std::string(
                      "the load is more than the body can carry in equilibrium, or it buckles; "
                      "try a smaller load, or steps = \"implicit\" with damping");
}

/// Index of a region of a body that has this corner, or is this point.
int region_of(const AssembledBody& body, int corner) {
    if (body.points)
        return body.points->region[corner];
    const auto has_corner = [&](const auto& corners) {
        return std::find(corners.begin(), corners.end(), corner) != corners.end();
    };
    const auto& domains = body.lattice.corners;
    const auto found = std::find_if(domains.begin(), domains.end(), has_corner);
    return body.lattice.region[found - domains.begin()];
}

}  // namespace

assets::Error diagnose(const Scene& scene,
                       Assembly& assembly,
                       const Stepper& stepper,
                       const State& state,
                       const Field& trial,
                       double dt,
                       const NewtonSummary& summary) {
    const Worst worst =
        most_compressed(assembly, stepper, trial.size() == state.x.size() ? trial : state.x);
    const Body& body = scene.bodies[worst.body];
    const Region& region =
        body.regions[assembly.bodies[worst.body].lattice.region[worst.domain]];
    return {assets::ErrorKind::Diverged,
            fmt::format("no solution {} {:.6g} s: {} (residual {:.2g} after {} Newton and {} "
                        "CG iterations).\n"
                        "  worst domain: body \"{}\", region \"{}\", at ({:.4g}, {:.4g}, "
                        "{:.4g}), J = {:.3g}\n"
                        "  likely cause: {}",
                        dt > 0 ? "for the step after" : "for the equilibrium after",
                        state.time,
                        to_string(summary.termination),
                        summary.residual,
                        summary.iterations,
                        summary.linear_iterations,
                        body.name,
                        region.name,
                        worst.place.x(),
                        worst.place.y(),
                        worst.place.z(),
                        worst.J,
                        cause(scene, summary, dt, worst.J))};
}

assets::Error diagnose_flown_apart(const Scene& scene,
                                   const Assembly& assembly,
                                   const State& state) {
    // What is not finite is fastest.
    const auto is_slower = [](const Vec3p& a, const Vec3p& b) {
        const auto squared = [](const Vec3p& v) {
            const double square = dot(v, v);
            return std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
        };
        return squared(a) < squared(b);
    };
    const auto fastest = std::max_element(state.v.begin(), state.v.end(), is_slower);
    const int c = static_cast<int>(fastest - state.v.begin());
    const int b = assembly.body_of(c);
    const AssembledBody& body = assembly.bodies[b];
    const Vec3 at = unpadded(state.x[c]);
    return {assets::ErrorKind::Diverged,
            fmt::format("after {:.6g} s: {}\n"
                        "  fastest: body \"{}\", region \"{}\", at ({:.4g}, {:.4g}, {:.4g}), "
                        "{:.3g} m/s\n"
                        "  likely cause: a velocity, force or pin far beyond the size of the "
                        "scene",
                        state.time,
                        FlownApart().what(),
                        scene.bodies[b].name,
                        scene.bodies[b].regions[region_of(body, c - body.begin)].name,
                        at.x(),
                        at.y(),
                        at.z(),
                        std::sqrt(dot(*fastest, *fastest)))};
}

}  // namespace sim
