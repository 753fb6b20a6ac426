#include "sim/simulation.h"

#include "sim/checkpoint.h"
#include "sim/collider_surface.h"
#include "sim/overlap.h"
#include "sim/report.h"
#include "sim/stepper.h"

namespace sim {

namespace {

constexpr double steps_per_frame = 10;  // where the shot gives no dt

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

    Snapshot snapshot() const {
        Snapshot result{state, {}};
        for (const AssembledBody& body : assembly.bodies)
            if (body.enrichment)
                result.enriched.push_back(body.enrichment->enriched());
        return result;
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
    return write_checkpoint(impl_->snapshot());
}

bool Simulation::is_readable(const std::vector<std::byte>& bytes) {
    return is_checkpoint(bytes);
}

void Simulation::restore(const std::vector<std::byte>& bytes) {
    Snapshot snapshot = read_checkpoint(bytes, impl_->snapshot());
    impl_->state = std::move(snapshot.state);
    auto enriched = snapshot.enriched.begin();
    for (AssembledBody& body : impl_->assembly.bodies)
        if (body.enrichment)
            body.enrichment->restore(std::move(*enriched++));
    impl_->stepper.restore_map(impl_->state);
    impl_->stepper.refresh(impl_->state);
}

}  // namespace sim
