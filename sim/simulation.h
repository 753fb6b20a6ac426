// A scene of bodies that moves in time, and what can be asked of it.
#pragma once

#include "assets/frames/frame_cache.h"
#include "sim/lattice/lattice.h"
#include "sim/point_cloud.h"
#include "sim/scene.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sim {

/// One row of stats.csv. Energies in J, momenta in kg m/s and kg m²/s about the origin.
struct Stats {
    int steps = 0, newton_iterations = 0, cg_iterations = 0;  // since the frame before
    double kinetic_energy = 0, elastic_energy = 0,
           gravitational_energy = 0;  // elastic: of surfaces that touch too
    Vec3 linear_momentum{0, 0, 0}, angular_momentum{0, 0, 0};
    double total_mass = 0;  // on the degrees of freedom [kg]
    double smallest_J = 0;  // over all domains, now

    // Shares of a domain's edge: of surfaces into colliders and into each other, and the smallest gap between bodies, 1 where
    // it is larger.
    double collider_penetration = 0, penetration = 0, gap = 1;
};

/// One row of probes.csv: a material point, or a region's centre of mass with its mean stretch and volume.
struct ProbeRow {
    std::string name;
    Vec3 position{0, 0, 0};  // [m]
    bool is_region = false;
    double stretch = 0;  // volume-weighted mean of the largest principal stretch
    double volume = 0;   // [m³]
};

/// One row of pins.csv: what holds the body, i.e. force and moment of the pin on the body.
struct PinRow {
    std::string name;
    Vec3 force{0, 0, 0};   // [N]
    Vec3 moment{0, 0, 0};  // about the pin's point or the centre of its corners now [N m]
};

class Simulation {
  public:
    /// Voxelises, binds and checks everything. Throws Error(Input) with the key at fault.
    /// `frame_time` = 1/fps sets the step where solver.dt is empty.   [s]
    Simulation(Scene scene, double frame_time);
    ~Simulation();

    /// Steps until `time` in steps no longer than dt, halved where they fail; `Steps::Static`: equilibrium of the loads then.
    /// Throws Error(Diverged) naming place, body, region and likely cause, and whatever `watch` throws, which is told the time
    /// that has been reached, after each step and before each of Newton's iterations: then only restore() goes on.
    void advance_to(double time, const std::function<void(double time)>& watch = {});

    double time() const;
    const Scene& scene() const;
    const Lattice& lattice(int body) const;
    const std::vector<std::string>& notes()
        const;  // repairs and simplifications to be told to the user

    /// Steps of the last advance_to() that failed and were replaced by shorter ones: place, time and likely cause.
    const std::vector<std::string>& failures() const;

    Stats stats() const;
    std::vector<ProbeRow> probes() const;
    std::vector<PinRow> pins() const;

    /// Surfaces of all skins of all bodies made of domains, in order, then of the colliders that pictures need:
    /// topology, and their state now.
    std::vector<assets::CachedSurface> surfaces() const;
    std::vector<assets::SurfaceFrame> deformed_surfaces() const;

    /// The bodies made of points, in order, now. They have no skins among surfaces().
    std::vector<PointCloud> point_clouds() const;

    /// Everything that later frames depend on, in double; restore() continues bit-identically.
    std::vector<std::byte> checkpoint() const;
    void restore(const std::vector<std::byte>& checkpoint);

    /// Whether restore() can read it: not where a version of the program wrote it that keeps its state otherwise.
    static bool is_readable(const std::vector<std::byte>& checkpoint);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace sim
