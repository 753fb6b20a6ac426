// Which step comes next: as long as allowed, halved where it fails, grown back slowly.
#include "sim/base/cell_box.h"
#include "sim/diagnosis.h"
#include "sim/stepper.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace sim {

namespace {

constexpr double growth = 1.1;      // of a step after one that succeeded
constexpr double shortest = 1e-3;   // step worth trying, as a share of dt
constexpr double most_steps = 1e8;  // to one end: days, or for ever where time hardly moves
constexpr double rounding = 1e-6;   // of a number of steps
constexpr double least_kept = 0.7;  // of the longest drift: one that is no shorter goes on
constexpr int life_of_map = 8;      // of one that explicit drifts share, at most, in dt
constexpr double cells_under_map = 0.1;  // that a slaved corner may pass meanwhile
constexpr int quiet_per_drift = 2;       // since the last touch, for each drift of a step

}  // namespace

void Stepper::advance(State& state,
                      double end,
                      double dt,
                      const std::function<void(double)>& watch) {
    watch_ = [&] {
        if (watch)
            watch(state.time);
    };
    failures.clear();
    measure_speed(state);
    if (scene_.solver.steps == Steps::Explicit)
        measure_stiffening(state.x);
    try {
        while (state.time < end) {
            go_on(state, end, dt);
            watch_();
        }
    } catch (const FlownApart&) {
        throw diagnose_flown_apart(scene_, assembly_, state);
    }
}

void Stepper::go_on(State& state, double end, double dt) {
    const bool is_explicit = scene_.solver.steps == Steps::Explicit;
    const double remaining = end - state.time;
    const SurfaceContact::Start start = {state.x, state.v, state.top_speed, state.contacts};
    surfaces_.see(start);
    const double stable =
        is_explicit ? std::min({dt, limit_of_way(cells_per_step), stable_limit()}) : dt;
    const double longest_drift = std::min(stable, state.dt_limit);
    // Drifts that are near the limit of what is stable heat what swings fastest wherever they change: they do so seldom.
    const bool goes_on =
        is_explicit && state.drift <= longest_drift && state.drift > least_kept * longest_drift;
    double drift = goes_on ? state.drift : longest_drift;
    if (is_explicit) {
        prescribe(scene_, assembly_, state.time, state.time + drift, prescribed_);
        make_map(state, state.x);
    }
    const double longest = is_explicit ? longest_of_drifts(state, drift, dt) : drift;
    const double allowed =
        std::min({longest,
                  colliders_.largest_step(state.x, state.v, state.time, longest),
                  surfaces_.largest_step(start, longest),
                  relative_limit(state)});
    // Equal drifts to the end, so that the last one is no sliver, in steps of as many.
    const double n_left =
        std::max(1.0, std::ceil(remaining / std::min(drift, allowed) - rounding));
    if (!(n_left <= most_steps))
        refuse_steps(state, n_left, remaining / n_left);
    drift = remaining / n_left;
    const double n_steps =
        is_explicit ? std::ceil(n_left / std::max(1.0, std::floor(allowed / drift + rounding)))
                    : n_left;
    n_drifts_ = static_cast<int>(std::ceil(n_left / n_steps));
    const double length = n_drifts_ * drift;
    if (try_step(state, length)) {
        ++steps;
        state.dt_limit *= std::pow(growth, n_drifts_);
        state.drift = drift;
        if (n_drifts_ == n_left)
            state.time = end;
        return;
    }
    if (n_drifts_ > 1) {
        // By a touch, or too far or too fast for a map so old: single drifts try again from here, each under a map of
        // its own. What is wrong with more than that fails there too, and is told.
        state.quiet_drifts = 0;
        return;
    }
    halve(state, length, stable);
}

void Stepper::refuse_steps(const State& state, double n, double length) const {
    // Whoever asks for them, else dt itself, or what failures have left of it.
    std::string who = "dt is too short";
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        const bool is_fast = cells_per_step * ranges_[b].cell_size / speed_[b] <= 2 * length;
        const bool is_stiff =
            scene_.solver.steps == Steps::Explicit && stable_limit(b) <= 2 * length;
        if (is_fast || is_stiff)
            who = fmt::format("body \"{}\" {}",
                              scene_.bodies[b].name,
                              is_fast ? fmt::format("moves at {:.3g} m/s", speed_[b])
                                      : std::string("is so stiff and light"));
    }
    throw assets::Error(
        assets::ErrorKind::Diverged,
        fmt::format("after {:.6g} s: {:.0e} steps of {:.3g} s to the end of the frame; {}",
                    state.time,
                    n,
                    length,
                    who));
}

void Stepper::halve(State& state, double failed, double stable) {
    state.dt_limit = failed / 2;
    const bool is_expected = summary_.termination == Termination::Unstable;
    const bool is_explicit = scene_.solver.steps == Steps::Explicit;
    const assets::Error failure = diagnose(scene_,
                                           assembly_,
                                           *this,
                                           state,
                                           is_explicit ? x_end_ : potential_.positions(),
                                           failed,
                                           summary_);
    if (failed < shortest * stable)
        throw failure;
    if (!is_expected)
        failures.emplace_back(failure.what());
}

double Stepper::longest_of_drifts(const State& state, double drift, double dt) const {
    // As long as the map may serve. What has touched lately may touch again: then all drifts of the step would be in vain.
    double life = std::min(life_of_map * dt, state.quiet_drifts / quiet_per_drift * drift);
    if (!moves_grid_)
        life = std::min(life, limit_of_slaves(state.v, cells_under_map));
    for (const Pin& pin : scene_.pins) {
        if (!is_in_force(pin, state.time))
            continue;
        life = std::min(life, pin.until - state.time);
        if (std::holds_alternative<Pin::Spin>(pin.moves))  // along chords
            life = std::min(life, dt);
    }
    return drift * std::max(1.0, std::floor(life / drift + rounding));
}

bool Stepper::try_step(State& state, double dt) {
    switch (scene_.solver.steps) {
        case Steps::Explicit:
            return try_explicit(state, dt);
        case Steps::Bdf2:
            return try_bdf2(state, dt);
        default:
            return try_implicit(state, dt);
    }
}

}  // namespace sim
