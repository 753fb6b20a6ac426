// Selectors made ready to be asked about points.
#pragma once

#include "assets/base/error.h"
#include "assets/generators/solid.h"
#include "sim/scene.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sim {

/// A part of a body as a function of the rest position: at most 0 inside the part, positive outside, and of slope
/// at most 1, so that |level| is a distance within which the answer is the same.   [m]
using Level = std::function<double(const Vec3&)>;

/// Makes the selectors of one body ready; the body's level set and surface are read once, when first asked for.
class LevelMaker {
  public:
    explicit LevelMaker(const Body& body);

    /// Throws Error(Input) with select.key where a mesh material matches nothing, or a mesh cannot be used.
    Level make(const Selector& select);

    /// The body's solid, exact within a domain's diagonal of its surface, and what was repaired to make it.
    const assets::Solid& solid();

    const std::vector<std::string>& repairs() const { return repairs_; }

  private:
    const assets::TriangleMesh& surface();
    Level inside(const std::filesystem::path& mesh);
    Level under_surface(double depth);
    Level nearest_material(const std::string& pattern);
    std::vector<Level> make_all(const std::vector<Selector>& of);

    const Body& body_;
    std::unique_ptr<const assets::Solid> solid_;
    std::unique_ptr<const assets::TriangleMesh> surface_;
    std::vector<std::string> repairs_;
};

/// Runs `make`; an Error that names no key of the shot file leaves with `key`.
template <class Make>
auto with_key(const std::string& key, Make&& make) {
    try {
        return make();
    } catch (const assets::Error& error) {
        if (!error.key().empty())
            throw;
        throw assets::Error(error.kind(), error.what(), key);
    }
}

/// Whether `text` matches a shell-style pattern: "*" stands for any characters, "?" for one.
bool matches(const std::string& pattern, const std::string& text);

/// The one of `choices` with the least edit distance to `word`; empty where there are no choices.
std::string nearest_word(const std::string& word, const std::vector<std::string>& choices);

/// A point on the boundary of a part belongs to it: levels up to this many domain edges count as inside.
inline constexpr double selection_tolerance = 1e-6;

}  // namespace sim
