#include "render/pathtrace/integrator.h"

#include "render/pathtrace/light_sampling.h"
#include "render/pathtrace/surface_point.h"
#include "render/pathtrace/warp.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

namespace render {

namespace {

constexpr int roulette_after = 3;  // bounces
constexpr int max_vertices = 64;   // scatterings and crossings of clear skins

float power_heuristic(float pdf, float other) {
    return pdf * pdf / (pdf * pdf + other * other);
}

Receiver receiver_of(const SurfacePoint& point) {
    return {point.position, point.normal, point.opacity < 1};
}

// One walk from the camera until the light it carries is spent.
class Path {
  public:
    Path(const EmbreeScene& rays,
         const Scene& scene,
         const Sampler& sampler,
         const PathOptions& options)
        : rays_(rays), scene_(scene), sampler_(sampler), options_(options) {}

    Vec3f radiance(Ray ray);

  private:
    struct Meeting {
        float distance = std::numeric_limits<float>::infinity();
        std::optional<MeshHit> mesh;
        const Floor* floor = nullptr;
    };

    Meeting nearest(const Ray& ray) const;
    void add_lights(const Ray& ray, float distance);
    bool fade_floor(const Floor& floor, const Ray& ray, const Vec3f& position);
    void add_direct(const SurfacePoint& point, const Bsdf& bsdf, const LocalFrame& frame);
    bool scatter(const SurfacePoint& point, Ray& ray);
    bool survives_roulette(float u);

    Vec3f background(const Vec3f& direction) const {
        return (scattered_ ? scene_.sky : scene_.backdrop).radiance(direction);
    }

    // Each vertex of the path has four pairs: (lobe, roulette), direction, position on the light, (light, unused).
    Pair pair(std::uint32_t which) const {
        return sampler_.pair(2 + 4 * std::uint32_t(vertex_) + which);
    }

    const EmbreeScene& rays_;
    const Scene& scene_;
    const Sampler& sampler_;
    const PathOptions& options_;

    Vec3f light_ = Vec3f::Zero();
    Vec3f throughput_ = Vec3f::Ones();
    int vertex_ = 0, bounce_ = 0;
    int inside_ = no_mesh;    // the clear mesh that the ray runs through
    bool scattered_ = false;  // no more in straight line with the camera
    Receiver receiver_;       // where last scattered, for the density of light sampling there
    float scatter_pdf_ = 0;
};

Path::Meeting Path::nearest(const Ray& ray) const {
    Meeting meeting;
    meeting.mesh = rays_.nearest(ray);
    if (meeting.mesh)
        meeting.distance = meeting.mesh->distance;
    for (const Floor& floor : scene_.floors) {
        const std::optional<float> distance = floor.distance(ray.origin, ray.direction);
        if (distance && *distance < meeting.distance)
            meeting = {*distance, std::nullopt, &floor};
    }
    return meeting;
}

void Path::add_lights(const Ray& ray, float distance) {
    if (!scattered_ || options_.light_sampling == LightSampling::LightsAlone)
        return;
    for (int i = 0; i < int(scene_.lights.size()); ++i) {
        const std::optional<LightHit> hit = hit_light(scene_.lights[i], ray);
        if (!hit || hit->distance > distance)
            continue;
        float weight = 1;
        if (options_.light_sampling == LightSampling::Both) {
            // The density falls with the square of the distance, here from the last scattering, not the last skin.
            const Vec3f gap = ray.origin + hit->distance * ray.direction - receiver_.position;
            const float pdf = hit->pdf * gap.squaredNorm() / (hit->distance * hit->distance);
            weight = power_heuristic(scatter_pdf_,
                                     pdf * choice_probability(scene_.lights, i, receiver_));
        }
        light_ += weight * throughput_.cwiseProduct(hit->radiance);
    }
}

// A floor gives way to the background with the distance. False where nothing of it is left.
bool Path::fade_floor(const Floor& floor, const Ray& ray, const Vec3f& position) {
    const float presence = floor.presence(position);
    if (presence < 1)
        light_ += (1 - presence) * throughput_.cwiseProduct(background(ray.direction));
    throughput_ *= presence;
    return presence > 0;
}

void Path::add_direct(const SurfacePoint& point, const Bsdf& bsdf, const LocalFrame& frame) {
    if (options_.light_sampling == LightSampling::SurfacesAlone)
        return;
    const auto light = sample_light(scene_.lights, receiver_of(point), pair(3).x, pair(2));
    if (!light)
        return;
    const Vec3f wi = frame.to_local(light->direction);
    const Vec3f scattered = bsdf.evaluate(wi);
    if (scattered.isZero(0))
        return;
    const Ray ray{ray_start(point, wi.z() < 0), light->direction};
    Vec3f passed = rays_.transmittance(ray, light->distance * (1 - 1e-5f));
    if (passed.isZero(0))
        return;
    if (options_.light_sampling == LightSampling::Both)
        passed *= power_heuristic(light->pdf, bsdf.pdf(wi));
    light_ +=
        throughput_.cwiseProduct(scattered).cwiseProduct(passed).cwiseProduct(light->radiance)
        / light->pdf;
}

// Turns the ray into the next one; false where the path ends.
bool Path::scatter(const SurfacePoint& point, Ray& ray) {
    const LocalFrame frame(point.normal);
    const Vec3f wo = frame.to_local(-ray.direction);
    const Bsdf bsdf(point.color, point.opacity, point.coat, wo);
    add_direct(point, bsdf, frame);

    const Pair decision = pair(0);
    const BsdfSample sample = bsdf.sample(decision.x, pair(1));
    ++vertex_;
    throughput_ = throughput_.cwiseProduct(sample.weight);
    if (throughput_.isZero(0))
        return false;
    const bool through = sample.direction.z() < 0;
    if (through)
        inside_ = point.from_inside ? no_mesh : point.mesh;
    ray.origin = ray_start(point, through);
    if (sample.straight)
        return vertex_ < max_vertices;
    ray.direction = frame.to_world(sample.direction).normalized();
    scattered_ = true;
    receiver_ = receiver_of(point);
    scatter_pdf_ = sample.pdf;
    ++bounce_;
    return bounce_ <= options_.max_bounces && survives_roulette(decision.y);
}

bool Path::survives_roulette(float u) {
    if (bounce_ <= roulette_after)
        return true;
    const float survival = std::min(1.0f, throughput_.maxCoeff());
    throughput_ /= survival;
    return u < survival;
}

Vec3f Path::radiance(Ray ray) {
    for (;;) {
        const Meeting meeting = nearest(ray);
        add_lights(ray, meeting.distance);
        if (meeting.distance == std::numeric_limits<float>::infinity())
            return light_ + throughput_.cwiseProduct(background(ray.direction));
        const Vec3f position = ray.origin + meeting.distance * ray.direction;
        if (meeting.floor && !fade_floor(*meeting.floor, ray, position))
            return light_;
        if (inside_ != no_mesh)
            throughput_.array() *=
                (-meeting.distance * scene_.meshes[inside_].material.absorption).array().exp();
        const SurfacePoint point =
            meeting.floor
                ? point_on_floor(*meeting.floor, position)
                : point_on_mesh(
                    rays_, scene_.meshes[meeting.mesh->mesh], *meeting.mesh, ray, scattered_);
        if (!scatter(point, ray))
            return light_;
    }
}

}  // namespace

Vec3f path_radiance(const EmbreeScene& rays,
                    const Scene& scene,
                    const Ray& camera_ray,
                    const Sampler& sampler,
                    const PathOptions& options) {
    return Path(rays, scene, sampler, options).radiance(camera_ray);
}

}  // namespace render
