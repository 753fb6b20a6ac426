#include "sim/simulation.h"

#include "assets/base/error.h"
#include "sim/report.h"
#include "sim/stepper.h"

#include <cmath>
#include <cstring>

namespace sim {

namespace {

constexpr double steps_per_frame = 10;  // where the shot gives no dt

void append(std::vector<std::byte>& bytes, const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

}  // namespace

struct Simulation::Impl {
    Impl(Scene&& given, double frame_time)
        : scene(std::move(given)),
          dt(scene.solver.dt.value_or(frame_time / steps_per_frame)),
          assembly(scene),
          stepper(scene, assembly) {
        state.x = assembly.rest;
        state.v = assembly.initial_velocity;
        state.inner_impulse.assign(state.x.size(), Vec3p{});
        if (scene.solver.steps == Steps::Static)
            stepper.equilibrium(state, 0);
        else
            stepper.refresh(state);
    }

    /// The arrays of the state, as a checkpoint holds them.
    std::array<Field*, 3> fields() { return {&state.x, &state.v, &state.inner_impulse}; }

    Scene scene;
    double dt;
    Assembly assembly;
    Stepper stepper;
    State state;
};

Simulation::Simulation(Scene scene, double frame_time)
    : impl_(new Impl(std::move(scene), frame_time)) {}

Simulation::~Simulation() = default;

void Simulation::advance_to(double time) {
    auto& [scene, dt, assembly, stepper, state] = *impl_;
    stepper.newton_iterations = stepper.cg_iterations = stepper.steps = 0;
    if (scene.solver.steps == Steps::Static) {
        stepper.equilibrium(state, time);
        return;
    }
    const double begin = state.time;
    const int n = std::max(1, static_cast<int>(std::ceil((time - begin) / dt - 1e-6)));
    for (int k = 0; k < n; ++k) {
        stepper.step(state, (time - begin) / n);
        state.time = k + 1 == n ? time : begin + (time - begin) * (k + 1) / n;
    }
}

double Simulation::time() const {
    return impl_->state.time;
}

const Scene& Simulation::scene() const {
    return impl_->scene;
}

const Lattice& Simulation::lattice(int body) const {
    return impl_->assembly.bodies[body].lattice;
}

const std::vector<std::string>& Simulation::notes() const {
    return impl_->assembly.notes;
}

Stats Simulation::stats() const {
    return stats_of(impl_->assembly, impl_->stepper, impl_->state);
}

std::vector<ProbeRow> Simulation::probes() const {
    return probes_of(impl_->scene, impl_->assembly, impl_->state);
}

std::vector<PinRow> Simulation::pins() const {
    return pins_of(impl_->scene, impl_->assembly, impl_->stepper, impl_->state);
}

std::vector<assets::CachedSurface> Simulation::surfaces() const {
    std::vector<assets::CachedSurface> result;
    for (const AssembledBody& body : impl_->assembly.bodies)
        for (const EmbeddedSurface& surface : body.surfaces)
            result.push_back(surface.cached());
    return result;
}

std::vector<assets::SurfaceFrame> Simulation::deformed_surfaces() const {
    std::vector<assets::SurfaceFrame> result;
    for (const AssembledBody& body : impl_->assembly.bodies) {
        const std::vector<Vec3> corners = corners_of(body, impl_->state.x);
        const bool shows_enriched = impl_->scene.solver.method == Method::Enriched;
        for (const EmbeddedSurface& surface : body.surfaces)
            result.push_back(surface.deformed(
                body.lattice,
                corners,
                shows_enriched ? body.enrichment.enriched() : std::vector<char>{}));
    }
    return result;
}

std::vector<std::byte> Simulation::checkpoint() const {
    std::vector<std::byte> bytes;
    append(bytes, &impl_->state.time, sizeof(double));
    append(bytes, &impl_->state.last_dt, sizeof(double));
    for (const Field* field : impl_->fields())
        append(bytes, field->data(), field->size() * sizeof(Vec3p));
    return bytes;
}

void Simulation::restore(const std::vector<std::byte>& bytes) {
    State& state = impl_->state;
    const std::size_t field_size = state.x.size() * sizeof(Vec3p);
    assets::check(bytes.size() == 2 * sizeof(double) + 3 * field_size,
                  "checkpoint of another scene");
    const std::byte* next = bytes.data();
    const auto take = [&](void* to, std::size_t size) {
        std::memcpy(to, next, size);
        next += size;
    };
    take(&state.time, sizeof(double));
    take(&state.last_dt, sizeof(double));
    for (Field* field : impl_->fields())
        take(field->data(), field_size);
    impl_->stepper.refresh(state);
}

}  // namespace sim
