// Rays against the meshes of a scene.
#pragma once

#include "render/pathtrace/bsdf.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

#include <memory>
#include <optional>
#include <vector>

struct RTCDeviceTy;
struct RTCSceneTy;

namespace render {

/// Denormals count as zero while this lives, as Embree's kernels expect; the thread's own mode comes back after.
class DenormalsAreZero {
  public:
    DenormalsAreZero();
    ~DenormalsAreZero();
    DenormalsAreZero(const DenormalsAreZero&) = delete;
    DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

  private:
    unsigned previous_;
};

struct MeshHit {
    float distance;
    int mesh, triangle;
    float u, v;              // weights of the triangle's second and third corner
    Vec3f geometric_normal;  // unit, outside of the surface
};

/// Shading normal at a hit: the vertices' interpolated, outside, unit.
Vec3f shading_normal(const Mesh& mesh, int triangle, float u, float v);

/// Keeps a reference to the scene, which must live longer and not change.
class EmbreeScene {
  public:
    /// Throws Error(Resources) where Embree runs out of memory, std::logic_error where it objects to its input.
    explicit EmbreeScene(const Scene& scene);

    std::optional<MeshHit> nearest(const Ray& ray) const;

    /// Share of light that passes along `ray` up to `distance`: 0 behind an opaque surface, otherwise what clear
    /// bodies leave of it. The ray may start inside of them, but must end outside.
    Vec3f transmittance(const Ray& ray, float distance) const;

    /// The coat of a mesh as the camera sees it; null where it has none.
    const Coat* coat(int mesh) const { return address(coats_[mesh].seen); }

    /// The same for light that has been scattered before: rougher, since a sharp reflection of a light onto a matt
    /// surface (a caustic) is beyond what paths from the camera find, and would only leave sparks.
    const Coat* blurred_coat(int mesh) const { return address(coats_[mesh].blurred); }

  private:
    struct Coats {
        std::optional<Coat> seen, blurred;
    };

    static const Coat* address(const std::optional<Coat>& coat) {
        return coat ? &*coat : nullptr;
    }

    void attach(int mesh_index);

    const Scene& scene_;
    std::vector<Coats> coats_;  // (#meshes)
    std::unique_ptr<RTCDeviceTy, void (*)(RTCDeviceTy*)> device_;
    std::unique_ptr<RTCSceneTy, void (*)(RTCSceneTy*)> accelerator_;
};

}  // namespace render
