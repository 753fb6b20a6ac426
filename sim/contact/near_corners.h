// Which corners may touch colliders soon.
#pragma once

#include "sim/contact/moving_collider.h"
#include "sim/contact/padded_bounds.h"

#include <cmath>
#include <functional>
#include <vector>

namespace sim {

/// Lists the corners that were near any collider when all were last looked at (a Verlet list [Ver67]). Of the others it
/// knows the least gap from each collider then, and passes over them only to bound how far any has moved since: while that
/// is too little to close the gap none of them touches; else all may. So it only saves work: when it looked does not show.
class NearCorners {
  public:
    /// Of corner k from collider j, with the corner at X in the shape's own frame, negative inside. Changes by no more than
    /// `steepest_distance` times the way that X goes.   [m]
    using Gap = std::function<double(int k, int j, const Vec3& X)>;

    NearCorners() = default;

    /// Corners by their index in the field of all, called by their place k in this list below; what is nearer than `margin`
    /// [m] at a look is always listed.
    NearCorners(std::vector<int> corners, std::size_t n_colliders, double margin);

    /// Ascending; all before the first step.
    const std::vector<int>& near() const { return near_; }

    /// Begins a step at x (#C) in which colliders go from one pose to the other (#colliders); looks at all corners again
    /// where far ones may have come much nearer. `gone`: how far any has gone since the step before began, at most; infinite
    /// where nothing is known of it.   [m]
    void begin_step(const Field& x,
                    double gone,
                    const std::vector<Pose>& from,
                    const std::vector<Pose>& to,
                    const Gap& gap);

    /// Those that may touch when no corner ends the step further from its start than `way`: the near ones, or all.   [m]
    const std::vector<int>& touching(double way) const {
        return way < free_way_ ? near_ : all_;
    }

    /// At least the length of the longest motion(k): by the largest along each axis.
    template <class Motion>
    double farthest(const Motion& motion) const {
        Vec3p squared{};
        const int n = static_cast<int>(corners_.size());
        for (int k = 0; k < n; ++k) {
            const Vec3p u = motion(k);
            squared = larger(u * u, squared);
        }
        return std::sqrt(squared[0] + squared[1] + squared[2]);
    }

    /// Those that may be as near to collider j as they go in dt, seen from it: from x with velocities v (#C) while it goes
    /// from one pose to the other. The near ones, or all.
    const std::vector<int>& reaching(int j,
                                     const Field& x,
                                     const Field& v,
                                     double dt,
                                     const Pose& from,
                                     const Pose& to) const;

  private:
    /// Of all corners that are not listed, from one collider.
    struct Far {
        double gap = 0;  // the least, at the last look [m]
        Pose pose;       // of the collider then
    };

    double way_since_look(const Field& x) const;
    // Of far corners from collider j at `pose`, when none has gone further than `way` since the look.   [m]
    double least_gap(int j, double way, const Pose& pose) const;
    // Whether far ones have kept much of their gaps when none has gone further than `way` since the look.
    bool stands(double way, const std::vector<Pose>& poses) const;
    void look(const Field& x, double way, const std::vector<Pose>& poses, const Gap& gap);

    std::vector<int> corners_, all_, near_;
    double margin_ = 0;    // [m]
    double free_way_ = 0;  // that all may go in the step while no far one can touch [m]

    // Of the last look:
    Field looked_at_;                        // (#corners) [m]
    PaddedBounds bounds_{Vec3p{}, Vec3p{}};  // of all corners [m]
    std::vector<Far> far_;                   // (#colliders)
    double way_ = 0;                         // that any corner has gone since, at most [m]
    int n_steps_ = 0;                        // begun since
};

}  // namespace sim
