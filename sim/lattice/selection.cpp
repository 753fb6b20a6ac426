#include "sim/lattice/selection.h"

#include "assets/generators/triangle_tree.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace sim {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Level sets of meshes have three voxels per domain edge: fill fractions then err by hundredths, at a memory cost that
// stays proportional to the surface.
constexpr double voxels_per_domain = 3;

// Corners of cut domains lie within a diagonal, 1.73 edges, of the surface.
constexpr double band_in_domains = 1.75;

Level level_of(const assets::Shape& shape) {
    return [shape](const Vec3& X) { return signed_distance(shape, X); };
}

Level level_of(const Selector::HalfSpace& half_space) {
    return [point = half_space.point, normal = Vec3(half_space.normal.normalized())](
               const Vec3& X) { return (X - point).dot(normal); };
}

std::string no_material(const Body& body,
                        const std::string& pattern,
                        const std::vector<std::string>& materials) {
    if (materials.empty())
        return fmt::format(
            "no material matches \"{}\": body \"{}\" has no named materials; select by place "
            "instead",
            pattern,
            body.name);
    return fmt::format("no material matches \"{}\"; body \"{}\" has {}: did you mean \"{}\"?",
                       pattern,
                       body.name,
                       fmt::join(materials, ", "),
                       nearest_word(pattern, materials));
}

/// max over all, or min over any: both keep the slope at most 1.
template <class Better>
Level extreme(std::vector<Level> levels, double start, Better better) {
    return [levels = std::move(levels), start, better](const Vec3& X) {
        double level = start;
        for (const Level& of : levels)
            level = better(level, of(X));
        return level;
    };
}

}  // namespace

LevelMaker::LevelMaker(const Body& body) : body_(body) {}

Level LevelMaker::make(const Selector& select) {
    struct Visitor {
        LevelMaker& maker;

        Level operator()(const Selector::All&) const {
            return [](const Vec3&) { return -infinity; };
        }

        Level operator()(const assets::Shape& shape) const { return level_of(shape); }

        Level operator()(const Selector::HalfSpace& half_space) const {
            return level_of(half_space);
        }

        Level operator()(const Selector::MeshMaterial& material) const {
            return maker.nearest_material(material.pattern);
        }

        Level operator()(const Selector::Inside& inside) const {
            return maker.inside(inside.mesh);
        }

        Level operator()(const Selector::Depth& depth) const {
            return maker.under_surface(depth.depth);
        }

        Level operator()(const Selector::AllOf& all) const {
            return extreme(maker.make_all(all.of), -infinity, [](double a, double b) {
                return std::max(a, b);
            });
        }

        Level operator()(const Selector::AnyOf& any) const {
            return extreme(maker.make_all(any.of), infinity, [](double a, double b) {
                return std::min(a, b);
            });
        }

        Level operator()(const Selector::Not& negated) const {
            assets::check(negated.of.size() == 1, "\"not\" takes exactly one selector");
            return
                [level = maker.make(negated.of.front())](const Vec3& X) { return -level(X); };
        }
    };

    return with_key(select.key, [&] { return std::visit(Visitor{*this}, select.is); });
}

std::vector<Level> LevelMaker::make_all(const std::vector<Selector>& of) {
    std::vector<Level> levels;
    for (const Selector& select : of)
        levels.push_back(make(select));
    return levels;
}

const assets::Solid& LevelMaker::solid() {
    const double s = body_.domain_size;
    const bool is_file = std::holds_alternative<assets::MeshFile>(body_.source.geometry);
    if (!solid_)
        solid_ = with_key("body." + body_.name + (is_file ? ".mesh" : ".shape"), [&] {
            return make_solid(
                body_.source, s / voxels_per_domain, band_in_domains * s, &repairs_);
        });
    return *solid_;
}

const assets::TriangleMesh& LevelMaker::surface() {
    if (!surface_)
        surface_ = std::make_unique<assets::TriangleMesh>(
            make_surface(body_.source, body_.domain_size).mesh);
    return *surface_;
}

Level LevelMaker::inside(const std::filesystem::path& mesh) {
    const double s = body_.domain_size;
    const assets::Source source{assets::MeshFile{mesh}, {}};
    const std::shared_ptr<const assets::Solid> part =
        make_solid(source, s / voxels_per_domain, band_in_domains * s, &repairs_);
    return [part](const Vec3& X) { return part->signed_distance(X); };
}

Level LevelMaker::under_surface(double depth) {
    const double s = body_.domain_size;
    const std::shared_ptr<const assets::Solid> deep =
        make_solid(body_.source, s / voxels_per_domain, depth + band_in_domains * s);
    return [deep, depth](const Vec3& X) { return -deep->signed_distance(X) - depth; };
}

Level LevelMaker::nearest_material(const std::string& pattern) {
    const assets::TriangleMesh& mesh = surface();
    std::vector<int> matching, others;
    for (std::size_t t = 0; t < mesh.triangle_group.size(); ++t)
        (matches(pattern, mesh.groups[mesh.triangle_group[t]]) ? matching : others)
            .push_back(static_cast<int>(t));
    if (matching.empty())
        throw assets::Error(assets::ErrorKind::Input, no_material(body_, pattern, mesh.groups));
    if (others.empty())
        return [](const Vec3&) { return -infinity; };
    const auto to_matching = std::make_shared<const assets::TriangleTree>(mesh, matching);
    const auto to_others = std::make_shared<const assets::TriangleTree>(mesh, others);
    // Half the difference of two distances has slope 1 at most.
    return [to_matching, to_others](const Vec3& X) {
        return (to_matching->distance(X) - to_others->distance(X)) / 2;
    };
}

}  // namespace sim
