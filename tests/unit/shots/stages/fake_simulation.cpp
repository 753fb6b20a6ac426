#include "tests/unit/shots/stages/fake_simulation.h"

#include "assets/base/error.h"
#include "sim/simulation.h"
#include "tests/unit/assets/frames/cache_fixture.h"

#include <csignal>
#include <cstring>
#include <limits>
#include <utility>

namespace tests {

SimulationCounts& simulation_counts() {
    static SimulationCounts counts;
    return counts;
}

double& divergence_time() {
    static double time = std::numeric_limits<double>::infinity();
    return time;
}

double& interruption_time() {
    static double time = std::numeric_limits<double>::infinity();
    return time;
}

}  // namespace tests

namespace sim {

struct Simulation::Impl {
    Scene scene;
    double time = 0;
    double history = 1;  // depends on every call before, so that a resume must restore it
    std::vector<std::string> notes{"the fake is not physics"};
};

Simulation::Simulation(Scene scene, double) : impl_(std::make_unique<Impl>()) {
    impl_->scene = std::move(scene);
    ++tests::simulation_counts().built;
}

Simulation::~Simulation() = default;

void Simulation::advance_to(double time, const std::function<void(double)>&) {
    if (time >= tests::divergence_time())
        throw assets::Error(assets::ErrorKind::Diverged, "the fake diverges");
    if (time == tests::interruption_time())
        std::raise(SIGTERM);
    impl_->history = 0.7 * impl_->history + time + 1.0 / 3;
    impl_->time = time;
    ++tests::simulation_counts().advanced;
}

const std::vector<std::string>& Simulation::failures() const {
    static const std::vector<std::string> none;
    return none;
}

const std::vector<std::string>& Simulation::notes() const {
    return impl_->notes;
}

Stats Simulation::stats() const {
    Stats stats;
    stats.steps = 2;
    stats.kinetic_energy = impl_->history;
    stats.angular_momentum = {0.1, impl_->time, -1e-300};
    stats.total_mass = 8;
    stats.smallest_J = 0.5;
    return stats;
}

std::vector<ProbeRow> Simulation::probes() const {
    return {{"tip, left", {1, impl_->history, 3}, false, 0, 0},
            {"soft", {4, 5, impl_->time}, true, 1.25, 0.001}};
}

std::vector<PinRow> Simulation::pins() const {
    return {{"wall", {impl_->history, 0, 0}, {0, 0, 0.5}}};
}

std::vector<assets::CachedSurface> Simulation::surfaces() const {
    return {tests::make_surface("skin", 300)};
}

std::vector<assets::SurfaceFrame> Simulation::deformed_surfaces() const {
    auto surface = tests::move_surface(tests::make_surface("skin", 300), 1);
    surface.positions[0].x() = static_cast<float>(impl_->history);
    return {surface};
}

std::vector<PointCloud> Simulation::point_clouds() const {
    std::vector<PointCloud> clouds;
    for (std::size_t body = 0; body < impl_->scene.bodies.size(); ++body) {
        PointCloud cloud;
        cloud.body = static_cast<int>(body);
        cloud.name = impl_->scene.bodies[body].name;
        cloud.spacing = 0.1;
        cloud.positions = {{0, 0, 0}, {0.1 * impl_->history, 0, 0}, {0.05, 0.08, 0}};
        cloud.region = {0, 1, 1};
        cloud.stretch = {1, 1.5f, 1};
        clouds.push_back(cloud);
    }
    return clouds;
}

std::vector<std::byte> Simulation::checkpoint() const {
    const double values[] = {impl_->time, impl_->history};
    std::vector<std::byte> state(sizeof values);
    std::memcpy(state.data(), values, sizeof values);
    return state;
}

bool Simulation::is_readable(const std::vector<std::byte>& state) {
    return state.size() == 2 * sizeof(double);
}

void Simulation::restore(const std::vector<std::byte>& state) {
    double values[2];
    std::memcpy(values, state.data(), sizeof values);
    impl_->time = values[0];
    impl_->history = values[1];
    ++tests::simulation_counts().restored;
}

}  // namespace sim
