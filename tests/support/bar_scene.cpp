#include "tests/support/bar_scene.h"

namespace tests {

namespace {

sim::Region region(const char* name,
                   const BarOptions& options,
                   double young_modulus,
                   sim::Selector select) {
    sim::Region result;
    result.name = name;
    result.model = options.model;
    result.young_modulus = young_modulus;
    result.poisson_ratio = 0.3;
    result.density = 1000;
    result.select = std::move(select);
    return result;
}

}  // namespace

sim::Scene bar_scene(const BarOptions& options) {
    const double s = options.domain_size;
    const auto& n = options.n_domains;
    const double length = n[0] * s;
    sim::Body body;
    body.name = "bar";
    body.domain_size = s;
    body.source.geometry = assets::Shape{
        assets::Box{{0, -n[1] * s / 2, -n[2] * s / 2}, {length, n[1] * s / 2, n[2] * s / 2}}};
    body.regions.push_back(
        region("ends", options, options.end_modulus, {sim::Selector::All{}, {}}));
    if (options.middle_modulus != options.end_modulus)
        body.regions.push_back(region("middle",
                                      options,
                                      options.middle_modulus,
                                      {assets::Box{{options.segment_ends[0] * s, -1, -1},
                                                   {options.segment_ends[1] * s, 1, 1}},
                                       {}}));
    body.skins.push_back({"outside", {}});

    sim::Scene scene;
    scene.solver = options.solver;
    scene.contact.mode = options.contact;
    scene.bodies.push_back(body);
    scene.forces.push_back(sim::Gravity{{0, 0, -10}});
    scene.pins.push_back({"wall",
                          "bar",
                          {sim::Selector::HalfSpace{{0, 0, 0}, {1, 0, 0}}, {}},
                          sim::Pin::Fixed{}});
    scene.probes.push_back({"tip", "bar", Vec3(length, 0, 0)});
    return scene;
}

}  // namespace tests
