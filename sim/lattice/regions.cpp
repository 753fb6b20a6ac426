#include "sim/lattice/regions.h"

#include "assets/base/error.h"

namespace sim {

RegionLayers::RegionLayers(const Body& body, LevelMaker& maker)
    : tolerance_(selection_tolerance * body.domain_size) {
    assets::check(!body.regions.empty(), "a body has at least one region");
    const Region& base = body.regions.front();
    if (!std::holds_alternative<Selector::All>(base.select.is))
        throw assets::Error(assets::ErrorKind::Input,
                            "the first region of body \"" + body.name
                                + "\" must select \"all\"; region \"" + base.name
                                + "\" selects a part: put it after one that selects all",
                            base.select.key);
    for (const Region& region : body.regions)
        level_.push_back(maker.make(region.select));
}

int RegionLayers::at(const Vec3& X) const {
    for (int r = static_cast<int>(level_.size()) - 1; r > 0; --r)
        if (selects(r, X))
            return r;
    return 0;
}

int RegionLayers::of_ball(const Vec3& center, double radius) const {
    for (int r = static_cast<int>(level_.size()) - 1; r > 0; --r) {
        const double level = level_[r](center);
        if (level < -radius)
            return r;
        if (level <= radius + tolerance_)
            return -1;
    }
    return 0;
}

}  // namespace sim
