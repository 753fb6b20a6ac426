// Recognises damage; no protection against intent.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace assets {

/// 64 bits over `bytes`. A change confined to one aligned word of 8 bytes is always noticed, any other but for a
/// chance of about 2⁻⁶⁴.
std::uint64_t checksum(std::string_view bytes);

/// 16 hexadecimal digits.
std::string hexadecimal(std::uint64_t value);

}  // namespace assets
