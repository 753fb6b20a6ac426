// Reads the words of one table of a shot file: type, unit, range and known names are checked, whatever decides the
// simulation is noted for the fingerprint, and words that nobody asked for are errors.
#pragma once

#include "assets/base/vector_types.h"
#include "assets/frames/frame_cache.h"
#include "assets/generators/shape.h"
#include "shots/reading/report.h"
#include "shots/reading/value.h"
#include "shots/text/units.h"

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace shots {

/// What all readers of one file share.
struct Reading {
    std::filesystem::path folder;  // of the shot file: relative mesh paths start here
    Report report;
    // Dotted key -> value of everything that decides the simulation.
    assets::Fingerprint resolved;
    std::map<std::string, assets::Shape> shapes;  // of [shapes], by name, as far as it was read
};

/// Numbers allowed: least <= x <= most and above < x < below.
struct Range {
    double least = -std::numeric_limits<double>::max(),
           most = std::numeric_limits<double>::max();
    double above = -std::numeric_limits<double>::infinity();
    double below = std::numeric_limits<double>::infinity();
};

inline constexpr Range any_number{};
inline constexpr Range positive{.above = 0};
inline constexpr Range not_negative{.least = 0};
inline constexpr Range fraction{.least = 0, .most = 1};

/// Whether what a table says belongs to the fingerprint of the simulation, or concerns the picture alone.
enum class Decides { Simulation, Picture };

/// Every reader of a word marks it as known and returns its value. Where the word is missing it returns `fallback`;
/// without one the word is required. A wrong value is reported and replaced by the fallback (or zero), so that one
/// pass finds all mistakes; the result counts only if the report holds no error.
class TableReader {
  public:
    TableReader(
        const Table& table, Location at, std::string key, Decides decides, Reading& reading);

    bool has(const std::string& name);

    /// Whether a word is there and nothing was wrong with it when it was read.
    bool good(const std::string& name) const;

    double number(const std::string& name,
                  Dimension dimension,
                  const Range& range,
                  std::optional<double> fallback = {});
    std::optional<double> optional_number(const std::string& name,
                                          Dimension dimension,
                                          const Range& range);
    int whole(const std::string& name, int least, int most, std::optional<int> fallback = {});
    bool flag(const std::string& name, bool fallback);
    Vec3 vector(const std::string& name,
                Dimension dimension,
                std::optional<Vec3> fallback = {});
    /// A vector of some length, for normals and axes.
    Vec3 direction(const std::string& name);
    /// sRGB, each 0..1.
    Vec3f color(const std::string& name, const Vec3f& fallback);
    std::string text(const std::string& name, const std::optional<std::string>& fallback = {});
    /// Letters, digits, '_' and '-' only: names become parts of keys and files.
    std::string identifier(const std::string& name);

    /// One of the words of `available`. Those of `later` are known but answered with "not available yet".
    template <typename E>
    E choice(const std::string& name,
             const std::map<std::string, E>& available,
             const std::vector<std::string>& later,
             const std::string& fallback) {
        std::vector<std::string> words;
        words.reserve(available.size());
        for (const auto& [word, value] : available)
            words.push_back(word);
        return available.at(word_of(name, words, later, fallback));
    }

    /// Several of such words in an array, each once.
    std::vector<std::string> words(const std::string& name,
                                   const std::vector<std::string>& available,
                                   const std::vector<std::string>& later,
                                   const std::vector<std::string>& fallback);

    /// A name of something else in the file; `kind` ("body") and `known` make the message.
    std::string reference(const std::string& name,
                          const std::string& kind,
                          const std::vector<std::string>& known);

    /// An existing file; its content belongs to the fingerprint.
    std::filesystem::path file(const std::string& name);

    /// The word of which `names` exactly one may and must be there; empty and a report otherwise.
    std::string one_of(const std::vector<std::string>& names);

    /// A word that belongs to the vocabulary but whose feature is not there.
    void not_available(const std::string& name);

    /// The table of that name; an empty one where there is none, so that its defaults are read all the same.
    TableReader table(const std::string& name);
    /// The same of an array of tables; empty where there is none.
    std::vector<TableReader> tables(const std::string& name);
    /// All tables inside this one, whatever their names, in the order of the file.
    std::vector<TableReader> all_tables();

    /// The same of a table that concerns the picture alone.
    TableReader picture_table(const std::string& name);

    /// The words of this table, names that the file chose, in its order.
    std::vector<std::string> names();

    /// The bare value of a word, or null; for words of several types.
    const Value* value(const std::string& name);
    /// The same where the word is required; `what` it must be makes the message.
    const Value* required(const std::string& name, const std::string& what);
    /// A reader of a table that stands at `value`, under this table's key + "." + name.
    TableReader inside(const std::string& name, const Value& value);

    /// Adds a line to the fingerprint, if this table decides the simulation.
    void record(const std::string& name, const std::string& value);
    void error(const std::string& name, const std::string& message);
    void warning(const std::string& name, const std::string& message);

    /// Reports the words that are missing, and those that no reader asked for. Call it last.
    void finish();

    /// The same where `other` has read words of this very table too.
    void finish_with(const TableReader& other);

    const std::string& key() const { return key_; }

    std::string key_of(const std::string& name) const;
    /// Last part of the key: the name of a body, or of an element.
    std::string own_name() const;

    Reading& reading() { return *reading_; }

  private:
    struct Missing {
        std::vector<std::string> names;  // any of them would do
        std::string message;
    };

    std::string word_of(const std::string& name,
                        const std::vector<std::string>& available,
                        const std::vector<std::string>& later,
                        const std::string& fallback);
    bool is_word(const Value& value,
                 const std::vector<std::string>& available,
                 const std::vector<std::string>& later,
                 const std::string& name);
    std::optional<double> number_of(const Value& value,
                                    const std::string& name,
                                    Dimension dimension,
                                    const Range& range);
    std::optional<Vec3> vector_of(const Value& value,
                                  const std::string& name,
                                  Dimension dimension,
                                  const Range& range);
    void refuse(const Value& value, const std::string& name, const std::string& message);
    void wrong_type(const Value& value, const std::string& name, const std::string& wanted);

    const Table* table_;
    Location at_;
    std::string key_;
    Decides decides_;
    Reading* reading_;
    std::vector<std::string> known_;
    std::set<std::string> refused_;
    std::vector<Missing> missing_;
};

}  // namespace shots
