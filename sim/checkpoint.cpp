#include "sim/checkpoint.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace sim {

namespace {

// Begins every checkpoint; counts up where what visit() passes on changes.
constexpr char format[] = "state 5";

class Writer {
  public:
    Writer() { append(format, sizeof format); }

    template <class Value>
    void number(const Value& value) {
        append(&value, sizeof value);
    }

    template <class Entry>
    void array(const std::vector<Entry>& entries) {
        static_assert(std::is_trivially_copyable_v<Entry>);
        const std::uint64_t size = entries.size();
        append(&size, sizeof size);
        append(entries.data(), size * sizeof(Entry));
    }

    std::vector<std::byte> bytes;

  private:
    void append(const void* data, std::size_t size) {
        const std::size_t before = bytes.size();
        bytes.resize(before + size);
        if (size > 0)
            std::memcpy(bytes.data() + before, data, size);
    }
};

class Reader {
  public:
    explicit Reader(const std::vector<std::byte>& bytes) : bytes_(bytes) {}

    template <class Value>
    void number(Value& value) {
        take(&value, sizeof value);
    }

    template <class Entry>
    void array(std::vector<Entry>& entries) {
        std::uint64_t size = 0;
        take(&size, sizeof size);
        assets::check(size <= (bytes_.size() - next_) / sizeof(Entry), "checkpoint is whole");
        entries.resize(size);
        take(entries.data(), size * sizeof(Entry));
    }

    bool is_at_end() const { return next_ == bytes_.size(); }

  private:
    void take(void* to, std::size_t size) {
        assets::check(size <= bytes_.size() - next_, "checkpoint is whole");
        if (size > 0)
            std::memcpy(to, bytes_.data() + next_, size);
        next_ += size;
    }

    const std::vector<std::byte>& bytes_;
    std::size_t next_ = sizeof format;
};

/// Passes everything on, in one order for both ways. How many bodies there are is known.
template <class Archive, class SomeSnapshot>
void visit(Archive& archive, SomeSnapshot& snapshot) {
    auto& state = snapshot.state;
    for (auto* number :
         {&state.time, &state.last_dt, &state.dt_limit, &state.quiet_drifts, &state.drift})
        archive.number(*number);
    archive.array(state.contacts);
    archive.array(state.top_speed);
    auto& grid = state.grid;
    for (auto* field : {&state.x,
                        &state.v,
                        &state.inner_force,
                        &state.inner_force_before,
                        &state.x_before,
                        &state.v_before,
                        &grid.made_at,
                        &grid.x,
                        &grid.v,
                        &grid.x_before,
                        &grid.v_before})
        archive.array(*field);
    archive.array(grid.free);
    archive.array(grid.held);
    archive.array(state.affine);
    for (auto& points : state.points) {
        archive.array(points.F);
        archive.array(points.J_plastic);
    }
    for (auto& enriched : snapshot.enriched)
        archive.array(enriched);
}

template <class Entry>
bool fits(const std::vector<Entry>& found, std::size_t n, bool may_be_empty = false) {
    return found.size() == n || (may_be_empty && found.empty());
}

/// Whether all that is indexed by something of the scene is as long as that.
bool is_of_same_bodies(const Snapshot& found, const Snapshot& present) {
    const State &a = found.state, &b = present.state;
    const std::size_t n = b.x.size();
    bool is_same = fits(a.x, n) && fits(a.v, n) && fits(a.inner_force, n)
                   && fits(a.inner_force_before, n) && fits(a.x_before, n, true)
                   && fits(a.v_before, a.x_before.size()) && fits(a.affine, b.affine.size())
                   && fits(a.top_speed, b.top_speed.size()) && fits(a.grid.made_at, n, true)
                   && fits(a.grid.free, a.grid.made_at.size())
                   && fits(a.grid.v, a.grid.x.size())
                   && std::all_of(a.grid.held.begin(), a.grid.held.end(), [&](int c) {
                          return c >= 0 && c < static_cast<int>(n);
                      });
    for (std::size_t k = 0; k < b.points.size(); ++k)
        is_same = is_same && fits(a.points[k].F, b.points[k].F.size())
                  && fits(a.points[k].J_plastic, b.points[k].F.size());
    for (std::size_t k = 0; k < present.enriched.size(); ++k)
        is_same = is_same && fits(found.enriched[k], present.enriched[k].size());
    return is_same;
}

}  // namespace

std::vector<std::byte> write_checkpoint(const Snapshot& snapshot) {
    Writer writer;
    visit(writer, snapshot);
    return std::move(writer.bytes);
}

bool is_checkpoint(const std::vector<std::byte>& bytes) {
    return bytes.size() >= sizeof format
           && std::memcmp(bytes.data(), format, sizeof format) == 0;
}

Snapshot read_checkpoint(const std::vector<std::byte>& bytes, const Snapshot& present) {
    assets::check(is_checkpoint(bytes), "checkpoint is of this version");
    Snapshot found;
    found.state.points.resize(present.state.points.size());
    found.enriched.resize(present.enriched.size());
    Reader reader(bytes);
    visit(reader, found);
    assets::check(reader.is_at_end() && is_of_same_bodies(found, present),
                  "checkpoint is of this scene");
    return found;
}

}  // namespace sim
