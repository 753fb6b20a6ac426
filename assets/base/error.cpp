#include "assets/base/error.h"

#include <utility>

namespace assets {

Error::Error(ErrorKind kind, const std::string& message, std::string key)
    : std::runtime_error(message), kind_(kind), key_(std::move(key)) {}

void check(bool condition, const char* what) {
    if (!condition)
        throw std::logic_error(std::string("internal fault, as this does not hold: ") + what);
}

}  // namespace assets
