// Statics: the equilibrium under the loads of a moment.
#include "sim/diagnosis.h"
#include "sim/stepper.h"

#include <algorithm>

namespace sim {

namespace {

constexpr double static_tolerance = 1e-8;
constexpr int contact_passes = 20;
constexpr int most_halvings = 8;  // of the way to an equilibrium

}  // namespace

void Stepper::equilibrium(State& state, double time, const std::function<void(double)>& watch) {
    watch_ = [&] {
        if (watch)
            watch(state.time);
    };
    // The whole way in one solve, else in halves.
    double begin = state.time, length = time - state.time;
    int halvings = 0;
    for (;;) {
        NewtonSummary summary;
        const double end = halvings == 0 ? time : std::min(time, begin + length);
        if (try_equilibrium(state, begin, end, summary)) {
            watch_();
            if (end >= time)
                break;
            begin = end;
            continue;
        }
        if (++halvings > most_halvings || length == 0)
            throw diagnose(scene_, assembly_, *this, state, potential_.positions(), 0, summary);
        length /= 2;
    }
    state.time = time;
}

bool Stepper::try_equilibrium(State& state,
                              double time_begin,
                              double time_end,
                              NewtonSummary& summary) {
    prescribe(scene_, assembly_, time_begin, time_end, prescribed_);
    make_map(state, state.x);
    const int n = map_.n_dofs();
    auto& step = potential_.step();
    step.dt = 1;  // degrees of freedom are displacements
    step.x_n = state.x;
    step.mass.assign(n, 0);
    step.q_tilde.assign(n, Vec3p{});
    step.static_force = assembly_.force;
    step.is_free.assign(n, Vec3p{1, 1, 1, 0});
    dof_mass_.clear();
    for (const int c : map_.free_corner())
        dof_mass_.push_back(assembly_.mass[c][0]);
    q_.assign(n, Vec3p{});
    for (const int c : prescribed_.corners) {
        const int i = map_.dof_of_corner()[c];
        step.is_free[i] = prescribed_.is_free[c];
        q_[i] =
            (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]) * (prescribed_.target[c] - state.x[c]);
    }
    colliders_.begin_step(state.x, state.top_speed, time_end, 0);

    NewtonOptions options;
    options.tolerance = static_tolerance;
    options.first_forcing = 0.1;
    options.max_iterations = 200;
    options.before_iteration = watch_;
    if (!surfaces_.empty()) {
        const SurfaceContact::Start start = {state.x, state.v, state.top_speed, state.contacts};
        surfaces_.see(start);
        surfaces_.begin_step(start, state.x, 0);
    }
    const bool solved = minimize_with_contact(
        options, [&](int pass) { return are_surfaces_settled(pass, contact_passes); });
    summary = summary_;
    if (!solved)
        return false;

    state.x = potential_.positions();
    state.contacts = surfaces_.held(state.x);
    state.v.assign(state.x.size(), Vec3p{});
    state.time = time_end;
    reaction_.assign(state.x.size(), Vec3p{});
    for (const int c :
         prescribed_.corners)  // the potential's gradient holds the external force already
        reaction_[c] =
            potential_.corner_gradient()[c] * (Vec3p{1, 1, 1, 0} - prescribed_.is_free[c]);
    ++steps;
    return true;
}

}  // namespace sim
