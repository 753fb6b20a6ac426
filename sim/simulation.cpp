#include "sim/simulation.h"

#include "assets/base/error.h"
#include "sim/collider_surface.h"
#include "sim/overlap.h"
#include "sim/report.h"
#include "sim/stepper.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace sim {

namespace {

constexpr double steps_per_frame = 10;  // where the shot gives no dt

// Begins every checkpoint; counts up where what checkpoint() writes changes.
constexpr char checkpoint_format[] = "state 3";

void append(std::vector<std::byte>& bytes, const void* data, std::size_t size) {
    const std::size_t before = bytes.size();
    bytes.resize(before + size);
    std::memcpy(bytes.data() + before, data, size);
}

}  // namespace

struct Simulation::Impl {
    Impl(Scene&& given, double frame_time)
        : scene(std::move(given)),
          dt(scene.solver.dt.value_or(frame_time / steps_per_frame)),
          assembly(scene),
          stepper(scene, assembly) {
        for (std::size_t k = 0; k < scene.colliders.size(); ++k)
            if (scene.colliders[k].is_drawn_from_cache())
                collider_surfaces.emplace_back(
                    scene.colliders[k], static_cast<int>(k), assembly.finest_edge());
        state.x = assembly.rest;
        state.v = assembly.initial_velocity;
        state.inner_force.assign(state.x.size(), Vec3p{});
        state.inner_force_before = state.inner_force;
        for (const Body& body : scene.bodies)
            state.top_speed.push_back(body.velocity.norm());
        refuse_overlap(scene, assembly, stepper.colliders(), state.x, state.time);
        stepper.start(state);
        if (scene.solver.steps == Steps::Static)
            stepper.equilibrium(state, 0);
        else
            stepper.refresh(state);
    }

    /// The arrays of the state, as a checkpoint holds them, each after its size.
    std::vector<Field*> fields() {
        MovingGrid& grid = state.grid;
        return {&state.x,
                &state.v,
                &state.inner_force,
                &state.inner_force_before,
                &state.x_before,
                &state.v_before,
                &grid.made_at,
                &grid.x,
                &grid.v,
                &grid.x_before,
                &grid.v_before};
    }

    Scene scene;
    double dt;
    Assembly assembly;
    Stepper stepper;
    std::vector<ColliderSurface> collider_surfaces;
    State state;
};

Simulation::Simulation(Scene scene, double frame_time)
    : impl_(new Impl(std::move(scene), frame_time)) {}

Simulation::~Simulation() = default;

void Simulation::advance_to(double time, const std::function<void(double)>& watch) {
    Stepper& stepper = impl_->stepper;
    State& state = impl_->state;
    stepper.newton_iterations = stepper.cg_iterations = stepper.steps = 0;
    if (impl_->scene.solver.steps == Steps::Static)
        stepper.equilibrium(state, time, watch);
    else
        stepper.advance(state, time, impl_->dt, watch);
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

const std::vector<std::string>& Simulation::failures() const {
    return impl_->stepper.failures;
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
    for (const ColliderSurface& surface : impl_->collider_surfaces)
        result.push_back(surface.cached());
    return result;
}

std::vector<assets::SurfaceFrame> Simulation::deformed_surfaces() const {
    std::vector<assets::SurfaceFrame> result;
    for (const AssembledBody& body : impl_->assembly.bodies) {
        const std::vector<Vec3> corners = corners_of(body, impl_->state.x);
        const bool shows_enriched = body.method == Method::Enriched;
        for (const EmbeddedSurface& surface : body.surfaces)
            result.push_back(surface.deformed(
                body.lattice,
                corners,
                shows_enriched ? body.enrichment->enriched() : std::vector<char>{}));
    }
    for (const ColliderSurface& surface : impl_->collider_surfaces)
        result.push_back(surface.at(impl_->state.time));
    return result;
}

std::vector<PointCloud> Simulation::point_clouds() const {
    std::vector<PointCloud> clouds;
    for (std::size_t b = 0; b < impl_->assembly.bodies.size(); ++b)
        if (const AssembledBody& body = impl_->assembly.bodies[b]; body.points)
            clouds.push_back({static_cast<int>(b),
                              impl_->scene.bodies[b].name,
                              body.points->spacing,
                              corners_of(body, impl_->state.x),
                              body.points->region,
                              stretches(impl_->state.points[b])});
    return clouds;
}

std::vector<std::byte> Simulation::checkpoint() const {
    std::vector<std::byte> bytes;
    append(bytes, checkpoint_format, sizeof checkpoint_format);
    const State& state = impl_->state;
    const double n_contacts = static_cast<double>(state.contacts.size());
    for (const double number :
         {state.time, state.last_dt, state.dt_limit, state.quiet_drifts, n_contacts})
        append(bytes, &number, sizeof(double));
    append(bytes, state.contacts.data(), state.contacts.size() * sizeof(HeldContact));
    append(bytes, state.top_speed.data(), state.top_speed.size() * sizeof(double));
    for (const Field* field : impl_->fields()) {
        const std::uint64_t size = field->size();
        append(bytes, &size, sizeof size);
        append(bytes, field->data(), size * sizeof(Vec3p));
    }
    append(bytes, state.grid.free.data(), state.grid.free.size());
    const std::uint64_t n_held = state.grid.held.size();
    append(bytes, &n_held, sizeof n_held);
    append(bytes, state.grid.held.data(), n_held * sizeof(int));
    for (const AssembledBody& body : impl_->assembly.bodies)
        if (body.enrichment)
            append(
                bytes, body.enrichment->enriched().data(), body.enrichment->enriched().size());
    append(bytes, state.affine.data(), state.affine.size() * sizeof(Gradient));
    for (const PointState& points : state.points) {
        append(bytes, points.F.data(), points.F.size() * sizeof(Matrix3<double>));
        append(bytes, points.J_plastic.data(), points.J_plastic.size() * sizeof(double));
    }
    return bytes;
}

bool Simulation::is_readable(const std::vector<std::byte>& bytes) {
    const std::size_t size = sizeof checkpoint_format;
    return bytes.size() >= size && std::memcmp(bytes.data(), checkpoint_format, size) == 0;
}

void Simulation::restore(const std::vector<std::byte>& bytes) {
    assets::check(is_readable(bytes), "checkpoint of this version");
    std::size_t next = sizeof checkpoint_format;
    State& state = impl_->state;
    const auto take = [&](void* to, std::size_t size) {
        assets::check(next + size <= bytes.size(), "checkpoint of another scene");
        std::memcpy(to, bytes.data() + next, size);
        next += size;
    };
    double n_contacts = 0;
    for (double* number :
         {&state.time, &state.last_dt, &state.dt_limit, &state.quiet_drifts, &n_contacts})
        take(number, sizeof(double));
    assets::check(n_contacts * sizeof(HeldContact) <= bytes.size(),
                  "checkpoint of another scene");
    state.contacts.resize(static_cast<std::size_t>(n_contacts));
    take(state.contacts.data(), state.contacts.size() * sizeof(HeldContact));
    take(state.top_speed.data(), state.top_speed.size() * sizeof(double));
    for (Field* field : impl_->fields()) {
        std::uint64_t size = 0;
        take(&size, sizeof size);
        assets::check(size <= bytes.size() / sizeof(Vec3p), "checkpoint of another scene");
        field->resize(size);
        take(field->data(), size * sizeof(Vec3p));
    }
    assets::check(state.x.size() == impl_->assembly.mass.size(), "checkpoint of another scene");
    state.grid.free.resize(state.grid.made_at.size());
    take(state.grid.free.data(), state.grid.free.size());
    std::uint64_t n_held = 0;
    take(&n_held, sizeof n_held);
    assets::check(n_held <= state.x.size(), "checkpoint of another scene");
    state.grid.held.resize(n_held);
    take(state.grid.held.data(), n_held * sizeof(int));
    for (AssembledBody& body : impl_->assembly.bodies) {
        if (!body.enrichment)
            continue;
        std::vector<char> enriched(body.lattice.n_domains());
        take(enriched.data(), enriched.size());
        body.enrichment->restore(std::move(enriched));
    }
    take(state.affine.data(), state.affine.size() * sizeof(Gradient));
    for (PointState& points : state.points) {
        take(points.F.data(), points.F.size() * sizeof(Matrix3<double>));
        take(points.J_plastic.data(), points.J_plastic.size() * sizeof(double));
    }
    assets::check(next == bytes.size(), "checkpoint of another scene");
    impl_->stepper.restore_map(state);
    impl_->stepper.refresh(state);
}

}  // namespace sim
