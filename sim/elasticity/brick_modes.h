// From the corners of a brick to the modes of its domains and back, a batch or two at a time.
#pragma once

#include "sim/elasticity/brick.h"

#include <cstring>
#include <utility>

#define ALWAYS_INLINE [[gnu::always_inline]] inline
#define INLINED     \
    __attribute__(( \
        always_inline))  // the same for a lambda, whose place for [[ ]] binds elsewhere

namespace sim {

template <class Body, int... k>
ALWAYS_INLINE void unroll(const Body& body, std::integer_sequence<int, k...>) {
    (body(std::integral_constant<int, k>{}), ...);
}

/// body(0) ... body(n - 1) with constant indices: small arrays then live in registers, which loops of this size lose.
template <int n, class Body>
ALWAYS_INLINE void times(const Body& body) {
    unroll(body, std::make_integer_sequence<int, n>{});
}

/// As many as two batches have.
using Pair = GaussLanes;

/// L is Lanes, for one batch, or Pair, for two that continue each other.
template <class L>
constexpr int batches = sizeof(L) / sizeof(Lanes);

template <class L>
ALWAYS_INLINE L load_from(const double* p) {
    L lanes;
    std::memcpy(&lanes, p, sizeof lanes);
    return lanes;
}

/// Of batch b and what follows.
template <class L>
ALWAYS_INLINE L load_from(const std::vector<Lanes>& of_batches, std::size_t b) {
    L lanes;
    std::memcpy(&lanes, &of_batches[b], sizeof lanes);
    return lanes;
}

template <class L>
ALWAYS_INLINE void add_to(double* p, const L& v) {
    alignas(sizeof(L)) const L sum = load_from<L>(p) + v;
    std::memcpy(p, &sum, sizeof sum);
}

ALWAYS_INLINE Lanes first_of(const Lanes& v) {
    return v;
}

ALWAYS_INLINE Lanes first_of(const Pair& v) {
    return __builtin_shufflevector(v, v, 0, 1, 2, 3);
}

ALWAYS_INLINE Lanes second_of(const Pair& v) {
    return __builtin_shufflevector(v, v, 4, 5, 6, 7);
}

/// The eight values of one component, at the corners or as coefficients of the modes 1, ξ, η, ξη, ζ, ξζ, ηζ, ξηζ with ξ, η,
/// ζ = ±1 at the corners, ξ along the rows: of corner values v_a they are h_m = Σ_a ξ_m(a) v_a, so that
/// v(ξ,η,ζ) = Σ_m h_m/8 ξ_m (the Walsh-Hadamard transform of size 8).
template <class L>
struct alignas(sizeof(L)) Eight {
    L v[8];
};

/// The same across the rows alone, for each place along them: 1, η, ζ, ηζ.
template <class L>
struct alignas(sizeof(L)) Four {
    L v[4];
};

/// Values in the four rows -> coefficients.
template <class L>
ALWAYS_INLINE void to_modes(Four<L>& e) {
    times<2>([&](auto axis) INLINED {
        times<4>([&](auto r) INLINED {
            constexpr int bit = 1 << axis;
            if constexpr (!(r & bit)) {
                const L low = e.v[r], high = e.v[r | bit];
                e.v[r] = low + high;
                e.v[r | bit] = high - low;
            }
        });
    });
}

/// The transpose of to_modes.
template <class L>
ALWAYS_INLINE void from_modes(Four<L>& e) {
    times<2>([&](auto axis) INLINED {
        times<4>([&](auto r) INLINED {
            constexpr int bit = 1 << axis;
            if constexpr (!(r & bit)) {
                const L low = e.v[r], high = e.v[r | bit];
                e.v[r] = low - high;
                e.v[r | bit] = low + high;
            }
        });
    });
}

// Modes by kind: the three linear ones carry F, the three bilinear and the trilinear one are hourglass modes.
constexpr int linear_mode[3] = {1, 2, 4};
constexpr int bilinear_mode[3] = {3, 5, 6};
constexpr int trilinear_mode = 7;

/// Of each lane what follows it in its row: of the last one that is the first lane of `next`.
ALWAYS_INLINE Lanes followed_by(const Lanes& v, const Lanes& next) {
    return __builtin_shufflevector(v, next, 1, 2, 3, 4);
}

ALWAYS_INLINE Pair followed_by(const Pair& v, const Pair& next) {
    return __builtin_shufflevector(v, next, 1, 2, 3, 4, 5, 6, 7, 8);
}

/// And what comes before it: of the first one that is the last lane of `before`.
ALWAYS_INLINE Lanes preceded_by(const Lanes& before, const Lanes& v) {
    return __builtin_shufflevector(before, v, 3, 4, 5, 6);
}

ALWAYS_INLINE Pair preceded_by(const Pair& before, const Pair& v) {
    return __builtin_shufflevector(before, v, 7, 8, 9, 10, 11, 12, 13, 14);
}

/// Modes at the corners of a brick, batch by batch. As a corner is the right one of a domain and the left one of the next, what
/// a batch finds across the rows at its end begins the next one where that continues it.
template <class L>
class ModesOfCorners {
  public:
    ALWAYS_INLINE ModesOfCorners(const Brick& brick, const BrickFields& fields)
        : brick_(brick), fields_(fields) {}

    /// Goes on where another has come to.
    ALWAYS_INLINE void go_on_from(const ModesOfCorners<Pair>& before) {
        times<3>([&](auto i) INLINED {
            times<4>([&](auto r) INLINED { next_[i].v[r] = first_of(before.next_[i].v[r]); });
        });
    }

    /// Of batch b, which must follow the one that was asked for before unless it continues none.
    ALWAYS_INLINE void load(std::size_t b, Eight<L> h[3]) {
        const Batch& batch = brick_.batch[b];
        if (!batch.continues)
            load_across(batch, 0, next_);
        Four<L> here[3];
        times<3>([&](auto i) INLINED { here[i] = next_[i]; });
        load_across(batch, lane_count * batches<L>, next_);
        times<3>([&](auto i) INLINED {
            times<4>([&](auto r) INLINED {
                const L left = here[i].v[r], right = followed_by(left, next_[i].v[r]);
                h[i].v[2 * r] = left + right;
                h[i].v[2 * r + 1] = right - left;
            });
        });
    }

  private:
    template <class>
    friend class ModesOfCorners;

    ALWAYS_INLINE void load_across(const Batch& batch, int ahead, Four<L> across[3]) const {
        times<3>([&](auto i) INLINED {
            times<4>([&](auto r) INLINED {
                across[i].v[r] = load_from<L>(fields_.in[i] + batch.row[r] + ahead);
            });
            to_modes(across[i]);
        });
    }

    const Brick& brick_;
    const BrickFields& fields_;
    Four<L> next_[3] = {};
};

/// Sums at the corners of a brick of what modes give to them, batch by batch.
template <class L>
class SumsAtCorners {
  public:
    ALWAYS_INLINE SumsAtCorners(const Brick& brick, const BrickFields& fields)
        : brick_(brick), fields_(fields) {}

    /// Goes on where another has come to.
    ALWAYS_INLINE void go_on_from(const SumsAtCorners<Pair>& before) {
        times<3>([&](auto i) INLINED {
            times<4>([&](auto r)
                         INLINED { before_[i].v[r] = second_of(before.before_[i].v[r]); });
        });
    }

    /// Adds ∂/∂v_a = Σ_m ξ_m(a) ∂/∂h_m of batch b, the next one.
    ALWAYS_INLINE void add(std::size_t b, const Eight<L> g[3]) {
        const Batch& batch = brick_.batch[b];
        Four<L> right[3];
        times<3>([&](auto i) INLINED {
            Four<L> sum;
            times<4>([&](auto r) INLINED {
                const L low = g[i].v[2 * r], high = g[i].v[2 * r + 1];
                right[i].v[r] = low + high;
                sum.v[r] = (low - high) + preceded_by(before_[i].v[r], right[i].v[r]);
            });
            add_to_rows(batch, 0, i, sum);
        });
        const std::size_t next = b + batches<L>;
        const bool is_last = next == brick_.batch.size() || !brick_.batch[next].continues;
        times<3>([&](auto i) INLINED {
            if (is_last) {
                Four<L> sum;
                times<4>([&](auto r) INLINED {
                    sum.v[r] = preceded_by(right[i].v[r], L{});
                    right[i].v[r] = L{};
                });
                add_to_rows(batch, lane_count * batches<L>, i, sum);
            }
            before_[i] = right[i];
        });
    }

  private:
    template <class>
    friend class SumsAtCorners;

    ALWAYS_INLINE void add_to_rows(const Batch& batch, int ahead, int i, Four<L>& sum) const {
        from_modes(sum);
        times<4>([&](auto r)
                     INLINED { add_to(fields_.out[i] + batch.row[r] + ahead, sum.v[r]); });
    }

    const Brick& brick_;
    const BrickFields& fields_;
    // Of the right corners of the batch before, where this one continues it.
    Four<L> before_[3] = {};
};

}  // namespace sim
