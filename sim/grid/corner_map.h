// The map T from degrees of freedom to corners, v_corner = T q, and its gradients. [Z18 §4, §5.1]
#pragma once

#include "sim/base/field.h"
#include "sim/scene.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace sim {

struct CellParts;

/// ∂v/∂x at a point: column j is ∂v/∂x_j.   [1/s]
struct Gradient {
    Vec3p column[3];
};

/// Free corners are degrees of freedom of their own; slaved corners, among them all material points, are interpolated
/// from the nodes of a background grid of cell size h with B-splines [Z18 eq. 2-3]. Degrees of freedom: free corners
/// first, in corner order, then the active nodes, body by body: bodies never share a node, so the grid alone never
/// couples them.
///
/// Slaved corners are grouped by the lowest node of their stencil: T loads a group's nodes once, Tᵀ sums a group's corners
/// before it touches the nodes. Fixed chunks of groups sum apart from each other and are added in their order, hence the
/// same for any number of threads.
class CornerMap {
  public:
    /// The corners [begin, end) of one body, its cell size h [m] and its kernel. Where the corners of its domains (counted
    /// from `begin`) are given, parts that they do not connect share no node (CellParts); else all that is near does.
    struct BodyRange {
        int begin = 0, end = 0;
        double cell_size = 0;
        Kernel kernel = Kernel::Linear;
        const std::vector<std::array<int, 8>>* domains = nullptr;
    };

    /// `free` (#C): whether a corner is free. What changes in one body moves the numbers of another's nodes, but keeps their
    /// order. Throws FlownApart.
    void rebuild(const Field& corners,
                 const std::vector<char>& free,
                 const std::vector<BodyRange>& bodies);

    /// Moves degrees of freedom: free ones to their corners, nodes to `nodes`.   corners (#C), nodes (#nodes) [m]
    void place(const Field& corners, const Field& nodes);

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

    /// x = x_n + dt T q.   x_n, x (#C), q (#dofs)
    void move(const Field& x_n, double dt, const Field& q, Field& x) const;

    /// The same of some bodies alone, and u = T q of them where it is asked for.   u (#C)
    void move_bodies(std::span<const int> bodies,
                     const Field& x_n,
                     double dt,
                     const Field& q,
                     Field& x,
                     Field* u = nullptr) const;

    /// u = T q at slaves alone.   q (#dofs), u (#C)
    void apply_to_slaves(const Field& q, Field& u) const;

    /// u = T q and u += T q at the corners listed, each once.   q (#dofs), u (#C)
    void apply_at(std::span<const int> corners, const Field& q, Field& u) const;
    void add_applied_at(std::span<const int> corners, const Field& q, Field& u) const;

    /// q = Tᵀ f.   f (#C), q (#dofs)
    void apply_transposed(const Field& f, Field& q) const;

    /// u += T q where little of q is not zero: stencils without such a node are passed by.   q (#dofs), u (#C)
    void add_applied(const Field& q, Field& u) const;

    /// q = Tᵀ f at the nodes of one body alone, where only slaves count.   f (#C), q (#dofs)
    void gather_at_nodes(int body, const Field& f, Field& q) const;

    /// q = Tᵀ (f - g) there.   f, g (#C), q (#dofs)
    void gather_at_nodes(int body, const Field& f, const Field& g, Field& q) const;

    /// T q and Tᵀ f, in `buffer` or, where T is the identity, without a copy.
    const Field& applied(const Field& q, Field& buffer) const;
    const Field& applied_transposed(const Field& f, Field& buffer) const;

    /// d_i = Σ_c T_ci² k_c: a stand-in for the diagonal of Tᵀ diag(k) T.   k (#C), d (#dofs)
    void apply_squared_transposed(const Field& k, Field& d) const;

    /// T_ci of one corner c and one degree of freedom i.
    struct Weight {
        int dof = 0;
        double weight = 0;
    };

    /// Puts the row of T at a corner in `row`, for the few that are asked one by one.
    void find_row(int corner, std::vector<Weight>& row) const;

    /// What stands for ∂w_i/∂x_j in G: the slope of the kernel; its square, for diagonals; or w_i (x_i - x)_j, whose sum
    /// with v_i is the affine momentum of [JSS15 eq. 10].
    enum class Factor { Slope, SlopeSquared, Moment };

    /// Slaves [begin, end) of a body, all of the chunk of that number.
    struct Slaves {
        int begin = 0, end = 0, chunk = 0;
    };

    /// Work at slaves, values[0] being that of slaves.begin; called for one chunk after the other, in parallel.
    using AtSlaves = std::function<void(const Slaves& slaves, Gradient* values)>;

    /// `visit` sees G q at the slaves of a body.
    void visit_gradients(int body, Factor factor, const Field& q, const AtSlaves& visit) const;

    /// sums += Gᵀ A, with A as `fill` sets it at the slaves: node i gets Σ_s A_s ∂w_i.   sums (#dofs)
    void add_transposed(int body, Factor factor, const AtSlaves& fill, Field& sums) const;

    /// sums += Gᵀ f(G q) in one go; f replaces gradients by what goes back. Factor::Slope.
    void add_through(int body, const Field& q, const AtSlaves& f, Field& sums) const;

    /// Such an f that also sees T q at the slaves.
    using AtMovedSlaves =
        std::function<void(const Slaves& slaves, const Vec3p* Tq, Gradient* values)>;
    void add_through(int body, const Field& q, const AtMovedSlaves& f, Field& sums) const;

    /// All slaves of a body; `chunk` is the number of chunks.
    Slaves slaves_of(int body) const;

    /// The nodes of a body, among all of them: degrees of freedom n_free() + begin and on.
    struct Nodes {
        int begin = 0, end = 0;
    };

    Nodes nodes_of(int body) const { return {parts_[body].first_node, parts_[body].last_node}; }

    /// The corner of each slave.
    const std::vector<int>& slave_corner() const { return slave_corner_; }

    /// Σ_i w_i (x_i - x)_j² of a body's kernel, the diagonal of D in [JSS15 eq. 8]; of linear kernels, where it depends on the
    /// place in the cell, the mean over it.   [m²]
    double second_moment(int body) const;

  private:
    struct Group {
        int begin = 0, end = 0;  // its slaves
    };

    /// The slaved corners of one body. A group has (order + 1)³ nodes; the a-th of group k stands at
    /// first_entry + (k - first_group) (order + 1)³ + a.
    struct Part {
        Kernel kernel = Kernel::Linear;
        double cell_size = 0;
        int first_free = 0, last_free = 0;  // degrees of freedom
        int first_group = 0, last_group = 0, first_node = 0, last_node = 0;
        std::size_t first_entry = 0;
        int first_trilinear = 0;  // added to a slave's number, of linear kernels
    };

    /// What a chunk of groups gives to its nodes, degrees of freedom from `first` on. Nodes are numbered group by group, so
    /// a chunk's are close together.
    struct Shares {
        int first = 0;
        Field sums;

        Vec3p& at(int node) { return sums[node - first]; }
    };

    struct Box;  // of cells

    // corner_map_rebuild.cpp
    void rebuild_body(const Field& corners, const BodyRange& body, int index);
    Box box_of_slaves(const Field& corners, const BodyRange& body, double shift);
    // By the cells of the box, or by parts of them.
    void sort_slaves(const Field& corners,
                     const BodyRange& body,
                     const Box& box,
                     double shift,
                     const CellParts* parts);
    void group_occupied_cells();
    void number_nodes(const Box& box, int n, const CellParts* parts, Part& part);
    void keep_trilinear_weights(Part& part);

    // corner_map.cpp
    template <bool passes_by_rest, class Write>
    void visit_slaves(const Part& part, const Field& q, const Write& write) const;
    template <bool passes_by_rest, class Write>
    void visit_slaves(const Field& q, const Write& write) const;
    template <class Write>
    void visit_corners(const Field& q, const Write& write) const;
    template <class Write>
    void visit_listed(std::span<const int> corners, const Field& q, const Write& write) const;
    const Part& part_of(int group) const;

    // corner_map_transposed.cpp, of value(corner)
    template <bool squared, class Value>
    void gather_linear(const Part& part,
                       const Group& group,
                       const int* nodes,
                       const Value& value,
                       Shares& shares) const;
    template <class S, bool squared, class Value>
    void gather(const Part& part, const Value& value, Field& q) const;
    template <bool squared>
    void gather_all(const Field& f, Field& q) const;
    template <bool squared, class Value>
    void gather_nodes(const Part& part, const Value& value, Field& q) const;

    // corner_map_gradients.cpp
    template <class S, class F>
    void pass(const Part& part, Factor factor, const Field* q, const F& f, Field* sums) const;

    // group_sums.h
    template <class Sum>
    void sum_groups(const Part& part, int per_group, const Sum& sum, Field& sums) const;

    int n_nodes_ = 0;
    std::vector<int> dof_of_corner_, free_corner_, dof_body_;
    Field dof_position_;
    std::vector<Part> parts_;  // (#bodies)
    std::vector<Group> groups_;
    std::vector<int> group_nodes_;                          // (#entries) degrees of freedom
    std::vector<int> slave_corner_;                         // (#slaves) grouped
    std::vector<int> slave_of_corner_;                      // (#C) where it is no free one
    std::vector<int> group_of_slave_;                       // (#slaves)
    Field slave_local_;                                     // (#slaves) t of Spline
    std::vector<std::array<double, 8>> trilinear_weights_;  // of slaves with linear kernels
    mutable std::vector<Shares> shares_;                    // scratch of the gathers

    // Scratch of rebuild(), kept to avoid allocations in every step.
    std::vector<int> slave_order_, cell_of_slave_, base_, placed_;
    // Of cells and nodes in a box; between uses 0, 0 and -1.
    // Slaves of a cell, later the next one's place; node.
    std::vector<int> cell_slave_, node_of_;
    std::vector<std::uint64_t> occupied_;  // a bit for each cell
};

}  // namespace sim
