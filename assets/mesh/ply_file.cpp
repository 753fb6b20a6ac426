#include "assets/mesh/ply_file.h"

#include "assets/mesh/file_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <optional>

namespace assets {
namespace {

namespace fs = std::filesystem;

enum class Encoding { Text, LittleEndian, BigEndian };
enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

struct Property {
    std::string name;
    Type type{};
    std::optional<Type> length_type;  // of a list
};

struct Element {
    std::string name;
    uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::Text;
    std::vector<Element> elements;
};

template <class T>
std::optional<T> find(const std::map<std::string, T, std::less<>>& names,
                      std::string_view word) {
    const auto known = names.find(word);
    return known == names.end() ? std::nullopt : std::optional<T>(known->second);
}

std::optional<Type> type_named(std::string_view word) {
    static const std::map<std::string, Type, std::less<>> types = {{"char", Type::Int8},
                                                                   {"int8", Type::Int8},
                                                                   {"uchar", Type::Uint8},
                                                                   {"uint8", Type::Uint8},
                                                                   {"short", Type::Int16},
                                                                   {"int16", Type::Int16},
                                                                   {"ushort", Type::Uint16},
                                                                   {"uint16", Type::Uint16},
                                                                   {"int", Type::Int32},
                                                                   {"int32", Type::Int32},
                                                                   {"uint", Type::Uint32},
                                                                   {"uint32", Type::Uint32},
                                                                   {"float", Type::Float},
                                                                   {"float32", Type::Float},
                                                                   {"double", Type::Double},
                                                                   {"float64", Type::Double}};
    return find(types, word);
}

std::optional<Encoding> encoding_named(std::string_view word) {
    static const std::map<std::string, Encoding, std::less<>> encodings = {
        {"ascii", Encoding::Text},
        {"binary_little_endian", Encoding::LittleEndian},
        {"binary_big_endian", Encoding::BigEndian}};
    return find(encodings, word);
}

// One line "property type name" or "property list type type name".
std::optional<Property> property_of(std::string_view line) {
    Property property;
    std::string_view word = next_word(line);
    if (word == "list") {
        property.length_type = type_named(next_word(line));
        if (!property.length_type)
            return std::nullopt;
        word = next_word(line);
    }
    const std::optional<Type> type = type_named(word);
    property.name = next_word(line);
    if (!type || property.name.empty())
        return std::nullopt;
    property.type = *type;
    return property;
}

// Takes in one line of the header; false if it is none.
bool add_line(std::string_view line, Header& header) {
    const std::string_view keyword = next_word(line);
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info")
        return true;
    if (keyword == "format") {
        const std::optional<Encoding> encoding = encoding_named(next_word(line));
        header.encoding = encoding.value_or(Encoding::Text);
        return encoding.has_value();
    }
    if (keyword == "element") {
        Element& element = header.elements.emplace_back();
        element.name = next_word(line);
        const std::optional<double> count = number(next_word(line));
        if (!count || !(*count >= 0 && *count <= std::numeric_limits<int>::max()))
            return false;
        element.count = static_cast<uint64_t>(*count);
        return true;
    }
    if (keyword != "property" || header.elements.empty())
        return false;
    const std::optional<Property> property = property_of(line);
    if (property)
        header.elements.back().properties.push_back(*property);
    return property.has_value();
}

Header read_header(std::string_view& content, const fs::path& file) {
    if (trimmed(next_line(content)) != "ply")
        throw_damaged(file, "it does not begin as a ply file does");
    Header header;
    while (!content.empty()) {
        const std::string_view line = trimmed(next_line(content));
        if (line == "end_header")
            return header;
        if (!add_line(line, header))
            throw_damaged(file,
                          fmt::format("'{}' in its header is not understood", printable(line)));
    }
    throw_damaged(file, "its header does not end");
}

// Hands out the values after the header.
class Values {
  public:
    Values(std::string_view content, Encoding encoding, const fs::path& file)
        : content_(content), encoding_(encoding), file_(file) {}

    double next(Type type) {
        if (encoding_ == Encoding::Text) {
            const std::string_view word = next_word(content_);
            const std::optional<double> value = number(word);
            if (word.empty())
                throw_damaged(file_, "it ends early");
            if (!value)
                throw_damaged(file_, fmt::format("'{}' is not a number", printable(word)));
            return *value;
        }
        switch (type) {
            case Type::Int8:
                return next_binary<int8_t>();
            case Type::Uint8:
                return next_binary<uint8_t>();
            case Type::Int16:
                return next_binary<int16_t>();
            case Type::Uint16:
                return next_binary<uint16_t>();
            case Type::Int32:
                return next_binary<int32_t>();
            case Type::Uint32:
                return next_binary<uint32_t>();
            case Type::Float:
                return next_binary<float>();
            case Type::Double:
                return next_binary<double>();
        }
        return 0;  // unreachable: all types are above
    }

    /// Reads a property's entries, one where it is no list.
    void next(const Property& property, std::vector<double>& entries) {
        const double n = property.length_type ? next(*property.length_type) : 1;
        entries.clear();
        for (double i = 0; i < n; ++i)
            entries.push_back(next(property.type));
    }

  private:
    template <class T>
    double next_binary() {
        if (content_.size() < sizeof(T))
            throw_damaged(file_, "it ends early");
        std::array<char, sizeof(T)> bytes{};
        std::memcpy(bytes.data(), content_.data(), sizeof(T));
        content_.remove_prefix(sizeof(T));
        static_assert(std::endian::native == std::endian::little);
        if (encoding_ == Encoding::BigEndian)
            std::reverse(bytes.begin(), bytes.end());
        return static_cast<double>(std::bit_cast<T>(bytes));
    }

    std::string_view content_;
    Encoding encoding_;
    const fs::path& file_;
};

void read_vertex(const Element& element,
                 Values& values,
                 std::vector<double>& entries,
                 PolygonSoup& soup) {
    Vec3& x = soup.positions.emplace_back(Vec3::Zero());
    for (const Property& property : element.properties) {
        values.next(property, entries);
        const bool is_coordinate =
            property.name == "x" || property.name == "y" || property.name == "z";
        if (is_coordinate && !property.length_type)
            x[property.name[0] - 'x'] = entries[0];
    }
}

void read_face(const Element& element,
               Values& values,
               std::vector<double>& entries,
               PolygonSoup& soup) {
    for (const Property& property : element.properties) {
        values.next(property, entries);
        if (property.name != "vertex_indices" && property.name != "vertex_index")
            continue;
        for (const double v : entries)
            soup.corners.push_back(as_index(v));
    }
    soup.face_ends.push_back(soup.corners.size());
}

}  // namespace

PolygonSoup read_ply(const fs::path& file) {
    const std::string text = content_of(file);
    std::string_view content = text;
    const Header header = read_header(content, file);
    Values values(content, header.encoding, file);
    PolygonSoup soup;
    std::vector<double> entries;
    for (const Element& element : header.elements) {
        if (element.properties.empty())
            continue;
        for (uint64_t i = 0; i < element.count; ++i) {
            if (element.name == "vertex")
                read_vertex(element, values, entries, soup);
            else if (element.name == "face")
                read_face(element, values, entries, soup);
            else
                for (const Property& property : element.properties)
                    values.next(property, entries);
        }
    }
    return soup;
}

}  // namespace assets
