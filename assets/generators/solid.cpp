#include "assets/generators/solid.h"

#include "assets/base/error.h"
#include "assets/generators/mesh_solid.h"
#include "assets/generators/procedural_surface.h"
#include "assets/mesh/import.h"
#include "assets/mesh/repair.h"

#include <cmath>
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

    double distance_up_to(const Vec3& x, double enough) const override {
        constexpr double rounding = 1e-9;  // so that what is more stays so, scaled back
        const double wanted = (enough + rounding * std::abs(enough)) / scale_;
        return scale_ * assets::distance_up_to(shape_, to_shape_ * (x - translate_), wanted);
    }

  private:
    Shape shape_;
    Mat3 to_shape_;
    Vec3 translate_;
    double scale_;
};

void move_mesh(const Transform& transform, TriangleMesh& mesh) {
    const Mat3 A = transform.scale * rotation(transform);
    for (Vec3& x : mesh.positions)
        x = transform.translate + A * x;
}

std::unique_ptr<Solid> solid_of_file(const MeshFile& file,
                                     const Transform& transform,
                                     double voxel,
                                     double band,
                                     std::vector<std::string>* repairs) {
    ImportedMesh imported = import_mesh(file.path);
    if (!imported.closed)
        imported.mesh = close_holes(imported.mesh, &imported.repairs);
    if (repairs)
        repairs->insert(repairs->end(), imported.repairs.begin(), imported.repairs.end());
    move_mesh(transform, imported.mesh);
    return make_mesh_solid(imported.mesh, file.path, voxel, band);
}

}  // namespace

std::unique_ptr<Solid> make_solid(const Source& source,
                                  double voxel,
                                  double band,
                                  std::vector<std::string>* repairs) {
    check(source.transform.scale > 0, "a transform's scale is positive");
    check(voxel > 0 && band >= 0, "a solid's voxel and band are positive");
    if (const MeshFile* file = std::get_if<MeshFile>(&source.geometry))
        return solid_of_file(*file, source.transform, voxel, band, repairs);
    auto solid =
        std::make_unique<ShapeSolid>(std::get<Shape>(source.geometry), source.transform);
    const Vec3 extent = solid->max - solid->min;
    if (!(extent.minCoeff() > 0) || !extent.allFinite())
        throw Error(ErrorKind::Input,
                    "a shape has no volume: its sizes must be finite and above 0");
    return solid;
}

Surface make_surface(const Source& source, double spacing) {
    check(source.transform.scale > 0, "a transform's scale is positive");
    check(spacing > 0, "a surface's spacing is positive");
    Surface surface;
    if (const MeshFile* file = std::get_if<MeshFile>(&source.geometry)) {
        ImportedMesh imported = import_mesh(file->path);
        surface = {std::move(imported.mesh), std::move(imported.repairs), imported.closed};
    } else {
        const Shape& shape = std::get<Shape>(source.geometry);
        const double local_spacing = spacing / source.transform.scale;
        const Box* box = std::get_if<Box>(&shape);
        surface.mesh =
            box ? box_surface(*box, local_spacing) : curved_surface(shape, local_spacing);
    }
    move_mesh(source.transform, surface.mesh);
    return surface;
}

}  // namespace assets
