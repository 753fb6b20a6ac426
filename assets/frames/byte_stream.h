// Numbers, texts and arrays as bytes and back, every one on a multiple of 4 bytes so that the compressor's sorting
// of bytes stays in step.
#pragma once

#include "assets/base/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace assets {

class ByteWriter {
  public:
    void put_count(std::size_t count) {
        check(count <= UINT32_MAX, "a count in a cache file has 32 bits");
        const auto value = static_cast<std::uint32_t>(count);
        put_bytes(&value, sizeof value);
    }

    void put_text(const std::string& text) {
        put_count(text.size());
        put_bytes(text.data(), text.size());
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
    }

    /// The elements alone: their number is told by a count before. T is plain 4-byte numbers without gaps.
    template <class T>
    void put_elements(const std::vector<T>& elements) {
        put_bytes(elements.data(), elements.size() * sizeof(T));
    }

    std::string take() { return std::move(bytes_); }

  private:
    void put_bytes(const void* from, std::size_t n) {
        if (n > 0)
            bytes_.append(static_cast<const char*>(from), n);
    }

    std::string bytes_;
};

/// Reads what ByteWriter wrote; std::logic_error where the bytes end before.
class ByteReader {
  public:
    explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

    std::size_t count() {
        std::uint32_t value = 0;
        get_bytes(&value, sizeof value);
        return value;
    }

    std::string text() {
        const std::size_t n = count();
        require(n);
        std::string result(n, '\0');
        get_bytes(result.data(), n);
        at_ = (at_ + 3) / 4 * 4;
        return result;
    }

    template <class T>
    std::vector<T> elements(std::size_t n) {
        require(n * sizeof(T));
        std::vector<T> result(n);
        get_bytes(result.data(), n * sizeof(T));
        return result;
    }

  private:
    void require(std::size_t n) const {
        check(at_ <= bytes_.size() && n <= bytes_.size() - at_,
              "a cache file's content ends early");
    }

    void get_bytes(void* to, std::size_t n) {
        require(n);
        if (n > 0)
            std::memcpy(to, bytes_.data() + at_, n);
        at_ += n;
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
};

}  // namespace assets
