// Derivatives are judged by the observed order of central differences: a wrong one leaves an error that does not
// shrink with the step, a right one an error that shrinks as h².
#pragma once

#include <cmath>

namespace tests {

/// The order of error(h) between two steps a factor of ten apart.
template <class Error>
double observed_order(const Error& error, double h) {
    return std::log10(std::abs(error(h)) / std::abs(error(h / 10)));
}

}  // namespace tests
