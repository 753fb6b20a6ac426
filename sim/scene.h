// What happens in a shot, as plain data: the simulation's input. Only shots/ parses text into it.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/generators/shape.h"

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sim {

enum class Method { Mpm, Domains, Enriched, Fem };
enum class Kernel { Linear, Quadratic, Cubic };
enum class Transfer { Flip, Apic };
enum class Steps { Explicit, SemiImplicit, Implicit, Bdf2, Static };
enum class Model { NeoHookean, StableNeoHookean, FixedCorotated, Snow };

/// What makes the fixed corotated law one of snow: with J_P the volume that was lost or won for good, moduli grow by
/// exp(hardening (1 - J_P)), and stretches beyond 1 - compression_limit or 1 + stretch_limit stay. [SSC13 §5]
struct SnowOptions {
    double hardening = 10, compression_limit = 2.5e-2, stretch_limit = 7.5e-3;
};

/// A part of a body at rest. Geometric selectors are boolean functions of the rest position; MeshMaterial and
/// Depth depend on the body's own surface.
struct Selector {
    struct All {};

    struct HalfSpace {  // the side opposite to the normal: (x - point)·normal <= 0
        Vec3 point{0, 0, 0}, normal{0, 0, 1};
    };

    struct MeshMaterial {
        std::string pattern;  // shell-style: "*" and "?"
    };

    struct Inside {  // of a closed mesh
        std::filesystem::path mesh;
    };

    struct Depth {
        double depth = 0;  // within this distance under the surface [m]
    };

    struct AllOf {
        std::vector<Selector> of;
    };

    struct AnyOf {
        std::vector<Selector> of;
    };

    struct Not {
        std::vector<Selector> of;  // exactly one
    };

    std::variant<All, assets::Shape, HalfSpace, MeshMaterial, Inside, Depth, AllOf, AnyOf, Not>
        is;
    std::string key;  // the shot file's path of this selector, for error messages
};

struct Region {
    std::string name;
    Selector select;
    Model model = Model::NeoHookean;
    double young_modulus = 0;       // [Pa], > 0
    double poisson_ratio = 0;       // -1 < nu < 1/2
    double density = 0;             // [kg/m³], > 0
    SnowOptions snow;               // of Model::Snow
    Vec3f color{0.8f, 0.8f, 0.8f};  // sRGB as typed in the shot file, 0..1
};

/// A fine surface that the body carries.
struct Skin {
    std::string name;
    std::optional<assets::Source> source;  // empty: the body's own surface
};

struct Body {
    std::string name;
    assets::Source source;
    double domain_size = 0;        // edge s of a domain [m]
    Vec3 velocity{0, 0, 0};        // initial [m/s]
    Vec3 spin{0, 0, 0};            // initial angular velocity about the centre of mass [rad/s]
    std::vector<Region> regions;   // layers: later wins; the first selects all
    std::vector<Skin> skins;       // at least one
    std::optional<Method> method;  // instead of the solver's
    std::optional<Kernel> kernel;  // instead of the solver's
};

/// Prescribed motion of the corners of the selected part.
struct Pin {
    struct Fixed {};

    struct Velocity {
        Vec3 velocity{0, 0, 0};  // [m/s]
    };

    struct Spin {
        Vec3 axis{0, 0, 1}, point{0, 0, 0};
        double rate = 0;  // [rad/s], right-handed about axis
    };

    std::string name, body;
    Selector select;
    std::variant<Fixed, Velocity, Spin> moves;
    double until = std::numeric_limits<double>::infinity();  // released then [s]
    std::array<bool, 3> only{true, true, true};              // the axes constrained
};

struct Gravity {
    Vec3 acceleration{0, 0, 0};  // [m/s²]
};

struct DeadLoad {
    std::string body;
    Selector select;
    Vec3 total{0, 0, 0};  // [N], spread over the selected corners by their volume share
};

using Force = std::variant<Gravity, DeadLoad>;

/// Coulomb friction; `Stick` never slides, a coefficient of 0 slips.
struct Friction {
    bool stick = false;
    double coefficient = 0;
};

struct PlaneShape {
    Vec3 point{0, 0, 0}, normal{0, 0, 1};  // solid on the side opposite to the normal
};

/// Where a collider is at a time, turned about its pivot: R = Rz Ry Rx of the angles.
struct ColliderKey {
    double time = 0;          // [s]
    Vec3 translate{0, 0, 0};  // [m]
    Vec3 rotate{0, 0, 0};     // [rad]
};

struct Collider {
    std::variant<PlaneShape, assets::Shape, assets::MeshFile> shape;  // a mesh is closed
    Friction friction;
    std::vector<ColliderKey> keys = {};  // by ascending time; none: it stands still
    std::optional<Vec3> pivot = {};      // that keys turn it about [m]; none: its centre

    /// Planes, and spheres and boxes that stand still, are drawn from the shot file; others from the frame cache.
    bool is_drawn_from_cache() const {
        const auto* simple = std::get_if<assets::Shape>(&shape);
        const bool is_simple = simple != nullptr
                               && (std::holds_alternative<assets::Sphere>(*simple)
                                   || std::holds_alternative<assets::Box>(*simple));
        return !std::holds_alternative<PlaneShape>(shape) && (!is_simple || !keys.empty());
    }
};

struct ContactPair {
    std::array<std::string, 2> bodies;  // the same twice: a body with itself
    Friction friction;
};

/// Between bodies: by their surfaces inside the solve, with themselves too, or on the background grid, which is cheaper and
/// lets them up to two domains into each other (grid_contact.h, grid_hold.h).
struct Contact {
    enum class Mode { Surface, Grid } mode = Mode::Surface;
    Friction friction;
    std::vector<ContactPair> pairs = {};  // with a friction of their own; later wins
};

struct Probe {
    std::string name, body;
    std::variant<Vec3, std::string> at;  // a material point at rest [m], or a region's name
};

/// Which domains of an enriched body get corners of their own; any of these. See Enrichment.
struct EnrichmentCriteria {
    bool interface = true, thin = true, mixed_cell = false, strain = false;
};

/// One point per domain with hourglass energy, or eight with F-bar: the accuracy reference, several times as dear.
enum class Quadrature { OnePoint, EightPoint };

struct SolverOptions {
    Method method = Method::Enriched;
    std::optional<Kernel> kernel;  // empty: quadratic for material points, else linear
    Transfer transfer = Transfer::Flip;
    // FLIP keeps exp(-pic_rate dt) of what a grid at rest cannot see per step [1/s]
    double pic_rate = 5;
    EnrichmentCriteria enrich;
    Steps steps = Steps::Implicit;
    Quadrature quadrature = Quadrature::OnePoint;
    // Largest step, of explicit ones largest drift: several share a map while no surfaces touch. Empty: a tenth of a
    // frame.   [s]
    std::optional<double> dt;
    double grid_ratio = 2;  // background cell / domain edge, >= 1
    double damping = 0;     // mass-proportional [1/s]
};

struct Scene {
    SolverOptions solver;
    std::vector<Body> bodies;
    std::vector<Pin> pins;
    std::vector<Force> forces;
    std::vector<Collider> colliders;
    Contact contact;
    std::vector<Probe> probes;
};

/// The method of a body: its own, mpm for snow, else the solver's.
inline Method method_of(const SolverOptions& solver, const Body& body) {
    const bool is_snow = !body.regions.empty() && body.regions.front().model == Model::Snow;
    return body.method.value_or(is_snow ? Method::Mpm : solver.method);
}

inline Kernel kernel_of(const SolverOptions& solver, const Body& body) {
    const bool is_of_points = method_of(solver, body) == Method::Mpm;
    const Kernel usual = is_of_points ? Kernel::Quadratic : Kernel::Linear;
    return body.kernel.value_or(solver.kernel.value_or(usual));
}

}  // namespace sim
