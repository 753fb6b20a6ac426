// std::vector of Lanes at the addresses that vector instructions require.
#pragma once

#include "sim/materials/lanes.h"

#include <cstddef>
#include <new>
#include <vector>

namespace sim {

/// Memory aligned to sizeof(Lanes), which alignof(Lanes) does not promise.
template <class T>
struct LaneAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{sizeof(Lanes)};

    LaneAllocator() = default;

    template <class Other>
    LaneAllocator(const LaneAllocator<Other>& /*other*/) {}

    T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new(count * sizeof(T), alignment));
    }

    void deallocate(T* memory, std::size_t /*count*/) { ::operator delete(memory, alignment); }

    bool operator==(const LaneAllocator& /*other*/) const { return true; }
};

using LaneVector = std::vector<Lanes, LaneAllocator<Lanes>>;

}  // namespace sim
