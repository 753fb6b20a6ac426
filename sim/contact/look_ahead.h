// When a list of what is near is made anew, and how far ahead.
#pragma once

namespace sim {

/// Of a Verlet list [Ver67]: besides what is near, it holds what changes of distances may bring near, and stands until they have
/// changed by so much. All in metres.
class LookAhead {
  public:
    static constexpr double rounding = 1e-9;  // of distances, in domain edges

    /// Before each use of the list.
    void count() { ++n_uses_; }

    /// Whether the list stands when distances have changed by no more than this since it was made.
    bool stands(double change) const { return change < ahead_; }

    /// How far ahead it is made now: by `most`, or, as that would soon be used up where distances change much from one use to
    /// the next, only so far that it stands where the same place is asked for again, or one that has hardly changed.
    double renew(double change, double most) {
        ahead_ = change < n_uses_ * most_used * most ? most : least * most;
        n_uses_ = 0;
        return ahead_;
    }

  private:
    static constexpr double most_used = 0.3;  // of what is ahead, in one use
    static constexpr double least = 0.05;     // of `most`

    double ahead_ = 0;
    int n_uses_ = 0;  // since it was made
};

}  // namespace sim
