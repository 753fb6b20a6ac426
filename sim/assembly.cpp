#include "sim/assembly.h"

#include "assets/base/error.h"
#include "sim/elasticity/highest_frequency.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

// k / (E s): depth below 1e-3 s under 10% of E as pressure.
constexpr double contact_stiffness = 100;

Vec3 centre_of_mass(const std::vector<double>& masses, const std::vector<Vec3>& places) {
    Vec3 sum = Vec3::Zero();
    double mass = 0;
    for (std::size_t c = 0; c < masses.size(); ++c) {
        sum += masses[c] * places[c];
        mass += masses[c];
    }
    return sum / mass;
}

}  // namespace

AssembledBody::AssembledBody(const Body& body,
                             Lattice made,
                             int first_corner,
                             const SolverOptions& solver)
    : lattice(std::move(made)),
      begin(first_corner),
      end(first_corner + lattice.n_corners()),
      method(method_of(solver, body)),
      kernel(kernel_of(solver, body)),
      cell_size(solver.grid_ratio * lattice.edge) {
    if (method == Method::Mpm) {
        points = seed_points(lattice, body);
        end = begin + points->size();
        return;
    }
    elasticity = make_elastic_energy(lattice, body, solver.quadrature);
    highest_frequency = sim::highest_frequency(*elasticity, lattice);
    if (method == Method::Enriched)
        enrichment.emplace(lattice, solver.enrich, cell_size);
    for (const Skin& skin : body.skins)
        surfaces.emplace_back(lattice, body, skin);
}

Assembly::Assembly(const Scene& scene) {
    bodies.reserve(scene.bodies.size());
    for (const Body& body : scene.bodies)
        add_body(body, scene.solver);

    force.assign(n_corners(), Vec3p{});
    for (const Force& item : scene.forces) {
        if (const auto* load = std::get_if<DeadLoad>(&item))
            add_force(scene, *load);
        else
            gravity += std::get<Gravity>(item).acceleration;
    }
    for (AssembledBody& body : bodies)
        for (int c = body.begin; c < body.end; ++c) {
            body.has_weight_alone &= dot(force[c], force[c]) == 0;
            force[c] += mass[c] * padded(gravity);
        }

    for (const Pin& pin : scene.pins)
        add_pin(scene, pin);
    for (const Probe& probe : scene.probes)
        add_probe(scene, probe);
}

void Assembly::add_body(const Body& body, const SolverOptions& solver) {
    std::vector<std::string> repairs;
    Lattice lattice = make_lattice(body, &repairs, slivers_for(method_of(solver, body)));
    bodies.emplace_back(body, std::move(lattice), n_corners(), solver);
    for (const std::string& repair : repairs)
        notes.push_back("body \"" + body.name + "\": " + repair);
    if (const auto& points = bodies.back().points)
        add_points(body, bodies.back().lattice, *points);
    else
        add_corners(body, bodies.back().lattice);
}

void Assembly::add_corners(const Body& body, const Lattice& lattice) {
    const Vec3 centre = centre_of_mass(lattice.corner_mass, lattice.corner_rest);
    for (int c = 0; c < lattice.n_corners(); ++c) {
        const Vec3& X = lattice.corner_rest[c];
        rest.push_back(padded(X));
        mass.push_back(padded(Vec3::Constant(lattice.corner_mass[c])));
        inverse_mass.push_back(1 / lattice.corner_mass[c]);
        volume.push_back(lattice.corner_volume[c]);
        initial_velocity.push_back(padded(body.velocity + body.spin.cross(X - centre)));
        outside.push_back(lattice.corner_outside[c]);
    }
}

void Assembly::add_points(const Body& body,
                          const Lattice& lattice,
                          const MaterialPoints& points) {
    const Vec3 centre = centre_of_mass(points.mass, points.rest);
    for (int p = 0; p < points.size(); ++p) {
        rest.push_back(padded(points.rest[p]));
        mass.push_back(padded(Vec3::Constant(points.mass[p])));
        inverse_mass.push_back(1 / points.mass[p]);
        volume.push_back(points.volume[p]);
        initial_velocity.push_back(
            padded(body.velocity + body.spin.cross(points.rest[p] - centre)));
        // A point stands for a little cube, which ends at the body's surface.
        outside.push_back(std::max(lattice.centre_outside[p], -points.spacing / 2));
    }
}

void Assembly::add_force(const Scene& scene, const DeadLoad& load) {
    const int b = index_of(scene.bodies, load.body);
    const Lattice& lattice = bodies[b].lattice;
    const std::vector<int> corners = select_corners(lattice, scene.bodies[b], load.select);
    if (bodies[b].points) {
        const std::vector<double> share = point_shares(lattice, corners);
        for (std::size_t p = 0; p < share.size(); ++p)
            force[bodies[b].begin + p] += padded(load.total * share[p]);
        return;
    }
    double sum = 0;
    for (const int c : corners)
        sum += lattice.corner_volume[c];
    for (const int c : corners)
        force[bodies[b].begin + c] += padded(load.total * (lattice.corner_volume[c] / sum));
}

void Assembly::add_pin(const Scene& scene, const Pin& pin) {
    const int b = index_of(scene.bodies, pin.body);
    const AssembledBody& body = bodies[b];
    AssembledPin assembled;
    std::vector<int> corners = select_corners(body.lattice, scene.bodies[b], pin.select);
    std::vector<int>& held = body.points ? assembled.points : assembled.corners;
    held = body.points ? points_at(body.lattice, corners) : std::move(corners);
    for (int& c : held)
        c += body.begin;
    pins.push_back(std::move(assembled));
}

void Assembly::add_probe(const Scene& scene, const Probe& probe) {
    AssembledProbe assembled;
    assembled.body = index_of(scene.bodies, probe.body);
    const AssembledBody& body = bodies[assembled.body];
    if (const auto* region = std::get_if<std::string>(&probe.at))
        assembled.region = index_of(scene.bodies[assembled.body].regions, *region);
    else if (body.points)
        assembled.near = near_points(*body.points, std::get<Vec3>(probe.at));
    else
        assembled.point = bind_points(body.lattice, {std::get<Vec3>(probe.at)})[0];
    probes.push_back(assembled);
}

double Assembly::finest_edge() const {
    double edge = std::numeric_limits<double>::infinity();
    for (const AssembledBody& body : bodies)
        edge = std::min(edge, body.lattice.edge);
    return edge;
}

int Assembly::body_of(int corner) const {
    const auto after = std::upper_bound(
        bodies.begin(), bodies.end(), corner, [](int c, const AssembledBody& body) {
            return c < body.begin;
        });
    return static_cast<int>(after - bodies.begin()) - 1;
}

std::vector<ContactCorner> Assembly::contact_corners() const {
    std::vector<ContactCorner> result;
    for (const AssembledBody& body : bodies) {
        const Lattice& lattice = body.lattice;
        const int index = static_cast<int>(&body - bodies.data());
        if (const auto& points = body.points) {  // any may come to the surface
            for (int p = 0; p < points->size(); ++p)
                result.push_back({body.begin + p,
                                  index,
                                  outside[body.begin + p],
                                  contact_stiffness * lattice.young_modulus(p) * lattice.edge,
                                  points->mass[p],
                                  lattice.edge});
            continue;
        }
        // Inside the body where domains are all around; a place may hold several in one direction.
        std::vector<unsigned> directions(lattice.n_corners(), 0);
        std::vector<double> modulus(lattice.n_corners(), 0);
        for (int p = 0; p < lattice.n_domains(); ++p)
            for (int a = 0; a < 8; ++a) {
                const int c = lattice.corners[p][a];
                directions[c] |= 1u << a;
                modulus[c] = std::max(modulus[c], lattice.young_modulus(p));
            }
        for (int c = 0; c < lattice.n_corners(); ++c)
            if (directions[c] != 0xff)
                result.push_back({body.begin + c,
                                  index,
                                  lattice.corner_outside[c],
                                  contact_stiffness * modulus[c] * lattice.edge,
                                  lattice.corner_mass[c],
                                  lattice.edge});
    }
    return result;
}

}  // namespace sim
