// The map T from degrees of freedom to corners, v_corner = T q, rebuilt every step. [Z18 §4, §5.1]
#pragma once

#include "sim/base/field.h"

#include <array>
#include <vector>

namespace sim {

/// Free corners are degrees of freedom of their own; slaved corners are interpolated from the nodes of a background
/// grid of cell size h with trilinear weights (products of linear B-splines, [Z18 eq. 2-3]). Degrees of freedom: free
/// corners first, in corner order, then the active nodes, body by body: bodies never share a node, so the grid alone
/// never couples them.
///
/// Slaved corners are grouped by the grid cell that holds them: T loads a cell's eight nodes once, Tᵀ sums a cell's
/// corners in registers before it touches the nodes. Both are gathers in a fixed order, hence deterministic.
class CornerMap {
  public:
    /// The corners [begin, end) of one body, and its cell size h [m].
    struct BodyRange {
        int begin = 0, end = 0;
        double cell_size = 0;
    };

    /// `free` (#C): whether a corner is free. Throws Error(Diverged) where a body spreads over more than 2^28 cells.
    void rebuild(const Field& corners,
                 const std::vector<char>& free,
                 const std::vector<BodyRange>& bodies);

    int n_dofs() const { return n_free() + n_nodes_; }

    /// Whether every corner is free; degrees of freedom are then the corners in their order.
    bool is_identity() const { return free_corner_.size() == dof_of_corner_.size(); }

    int n_free() const { return static_cast<int>(free_corner_.size()); }

    /// The degree of freedom of each free corner (#C), -1 for slaved ones.
    const std::vector<int>& dof_of_corner() const { return dof_of_corner_; }

    /// The corner of each free degree of freedom (#free).
    const std::vector<int>& free_corner() const { return free_corner_; }

    /// Where each degree of freedom sits (#dofs): its corner, or its node [m]. T reproduces linear functions of it.
    const Field& dof_position() const { return dof_position_; }

    /// The body of each degree of freedom (#dofs).
    const std::vector<int>& dof_body() const { return dof_body_; }

    /// u = T q.   q (#dofs), u (#C)
    void apply(const Field& q, Field& u) const;

    /// q = Tᵀ f.   f (#C), q (#dofs)
    void apply_transposed(const Field& f, Field& q) const;

    /// T q and Tᵀ f, in `buffer` or, where T is the identity, without a copy.
    const Field& applied(const Field& q, Field& buffer) const;
    const Field& applied_transposed(const Field& f, Field& buffer) const;

    /// d_i = Σ_c T_ci² k_c: a stand-in for the diagonal of Tᵀ diag(k) T.   k (#C), d (#dofs)
    void apply_squared_transposed(const Field& k, Field& d) const;

  private:
    struct Cell {
        std::array<int, 8> nodes;  // degrees of freedom
        int begin = 0, end = 0;    // its range of slaves
    };

    void rebuild_body(const Field& corners, const BodyRange& body, int index);
    void number_nodes(const std::array<int, 3>& n_cells_per_axis,
                      int first_new_cell,
                      const std::vector<int>& base);
    template <bool squared>
    void gather(const Field& f, Field& q) const;

    int n_nodes_ = 0;
    std::vector<int> dof_of_corner_, free_corner_, dof_body_;
    Field dof_position_;
    std::vector<Cell> cells_;
    std::vector<int> slave_corner_;                     // (#slaves) grouped by cell
    std::vector<std::array<double, 8>> slave_weights_;  // (#slaves)
    std::vector<std::array<int, 8>>
        node_sources_;         // (#nodes) indices 8 cell + a into cell sums, -1 where none
    mutable Field cell_sums_;  // (8 #cells) scratch of the gathers

    // Scratch of rebuild(), kept to avoid allocations in every step.
    std::vector<int> cell_of_slave_, cell_start_, node_of_, slave_order_;
};

}  // namespace sim
