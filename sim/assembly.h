// All bodies of a scene side by side in one field of corners, with what acts on them.
#pragma once

#include "assets/base/error.h"
#include "sim/base/field.h"
#include "sim/contact/collider_contact.h"
#include "sim/elasticity/elastic_energy.h"
#include "sim/embedding/embedding.h"
#include "sim/enrichment/enrichment.h"
#include "sim/lattice/lattice.h"
#include "sim/point_bodies.h"
#include "sim/points/material_points.h"
#include "sim/scene.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sim {

/// A body cut into domains, or made of points; [begin, end) of the scene's corners are its corners or points.
struct AssembledBody {
    Lattice lattice;
    int begin = 0, end = 0;
    Method method;
    Kernel kernel;
    double cell_size = 0;          // of its background grid [m]
    double highest_frequency = 0;  // that its corners swing with at rest; 0 of points [rad/s]
    std::unique_ptr<ElasticEnergy> elasticity;  // of domains
    std::optional<Enrichment> enrichment;       // of Method::Enriched
    std::optional<MaterialPoints> points;       // in place of both
    std::vector<EmbeddedSurface> surfaces;      // none of points
    bool has_weight_alone = true;               // no other force acts on it

    AssembledBody(const Body& body,
                  Lattice made,
                  int first_corner,
                  const SolverOptions& solver);
};

/// A pin's corners in the scene's field; of a body of points, the points of the domains at these corners.
struct AssembledPin {
    std::vector<int> corners, points;
};

/// A probe bound to its body.
struct AssembledProbe {
    int body = 0;
    Binding point;                // of a material point of domains
    int region = -1;              // else the region's index
    std::vector<NearPoint> near;  // of a material point in a body of points
};

struct Assembly {
    explicit Assembly(const Scene& scene);

    std::vector<AssembledBody> bodies;
    std::vector<AssembledPin> pins;
    std::vector<AssembledProbe> probes;
    Field rest;                        // (#C) [m]
    Field mass;                        // (#C) in x, y and z [kg]
    std::vector<double> inverse_mass;  // (#C) [1/kg]
    std::vector<double> volume;        // (#C) at rest [m³]
    Field initial_velocity;            // (#C) [m/s]
    Field force;                       // (#C) gravity and dead loads [N]
    std::vector<double> outside;       // (#C) distance out of the body's surface at rest [m]
    Vec3 gravity{0, 0, 0};             // [m/s²]
    std::vector<std::string> notes;

    int n_corners() const { return static_cast<int>(rest.size()); }

    /// The smallest domain's edge [m].
    double finest_edge() const;

    /// Index of the body that holds a corner.
    int body_of(int corner) const;

    /// Corners that may touch a collider, with their penalty stiffness.
    std::vector<ContactCorner> contact_corners() const;

  private:
    void add_body(const Body& body, const SolverOptions& solver);
    void add_corners(const Body& body, const Lattice& lattice);
    void add_points(const Body& body, const Lattice& lattice, const MaterialPoints& points);
    void add_force(const Scene& scene, const DeadLoad& load);
    void add_pin(const Scene& scene, const Pin& pin);
    void add_probe(const Scene& scene, const Probe& probe);
};

/// Index of a name in a list of things with names; the shot file has been checked, so it is there.
template <class Named>
int index_of(const std::vector<Named>& list, const std::string& name) {
    for (std::size_t k = 0; k < list.size(); ++k)
        if (list[k].name == name)
            return static_cast<int>(k);
    assets::check(false, ("no such name: " + name).c_str());
    return -1;
}

}  // namespace sim
