#include "assets/generators/solid.h"

#include "assets/base/error.h"

#include <utility>

namespace assets {

namespace {

/// A shape by formula: x -> scale · distance(R^T (x - translate) / scale).
class ShapeSolid : public Solid {
  public:
    ShapeSolid(const Shape& shape, const Transform& transform)
        : shape_(shape),
          to_shape_(rotation(transform).transpose() / transform.scale),
          translate_(transform.translate),
          scale_(transform.scale) {
        const Mat3 R_transposed = rotation(transform).transpose();
        for (int i = 0; i < 3; ++i) {
            max[i] = translate_[i] + scale_ * support(shape, R_transposed.col(i));
            min[i] = translate_[i] - scale_ * support(shape, -R_transposed.col(i));
        }
    }

    double signed_distance(const Vec3& x) const override {
        return scale_ * assets::signed_distance(shape_, to_shape_ * (x - translate_));
    }

  private:
    Shape shape_;
    Mat3 to_shape_;
    Vec3 translate_;
    double scale_;
};

}  // namespace

std::unique_ptr<Solid> make_solid(const Source& source,
                                  double voxel,
                                  double band,
                                  std::vector<std::string>* repairs) {
    check(source.transform.scale > 0, "a transform's scale is positive");
    (void)voxel; (void)band; (void)repairs;
    std::unique_ptr<Solid> solid = std::make_unique<ShapeSolid>(std::get<Shape>(source.geometry), source.transform);
    if (!((solid->max - solid->min).minCoeff() > 0) || !(solid->max - solid->min).allFinite())
        throw Error(ErrorKind::Input, "a shape has no volume: its sizes must be finite and above 0");
    return solid;
}

}  // namespace assets
