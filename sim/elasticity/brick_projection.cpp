// Apart from brick.cpp: it runs on scalars, seldom, and reads Eigen.
#include "sim/elasticity/brick.h"
#include "sim/materials/projection.h"

namespace sim {

void project_brick(Brick& brick, double edge, const BrickFields& fields) {
    for (std::size_t b = 0; b < brick.batch.size(); ++b)
        for (int l = 0; l < lane_count; ++l) {
            if (brick.batch[b].domain[l] < 0)
                continue;
            // F from the corners of this slot.
            const std::array<int, 4>& row = brick.batch[b].row;
            Mat3 F = Mat3::Zero();
            for (int a = 0; a < 8; ++a)
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        F(i, j) += ((a >> j & 1) ? 1 : -1)
                                   * fields.in[i][row[a / 2] + (a & 1) + l] / (4 * edge);
            const auto model = static_cast<Model>(static_cast<int>(brick.law[b][l]));
            const Mat9 A =
                projected_stiffness(model, F, 1, brick.lambda[b][l] / brick.mu[b][l]);
            int k = 0;
            for (int r = 0; r < 9; ++r)
                for (int c = r; c < 9; ++c, ++k)
                    brick.stiffness[45 * b + k][l] = static_cast<float>(A(r, c));
        }
}

}  // namespace sim
