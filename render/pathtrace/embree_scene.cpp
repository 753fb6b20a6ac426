#include "render/pathtrace/embree_scene.h"

#include "assets/base/error.h"

#include <Eigen/Geometry>
#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <immintrin.h>
#include <limits>
#include <string>

namespace render {

namespace {

constexpr float min_blurred_roughness = 0.5f;
// 0x0040: denormal inputs are zero.
constexpr unsigned flush_and_zero = _MM_FLUSH_ZERO_ON | 0x0040;

struct Fault {
    RTCError code = RTC_ERROR_NONE;
    std::string text;
};

// Embree calls back through C: note the first fault and throw later.
void note(void* fault_pointer, RTCError code, const char* text) {
    auto& fault = *static_cast<Fault*>(fault_pointer);
    if (fault.code == RTC_ERROR_NONE)
        fault = {code, text ? text : ""};
}

void raise(const Fault& fault) {
    if (fault.code == RTC_ERROR_OUT_OF_MEMORY)
        throw assets::Error(assets::ErrorKind::Resources,
                            "out of memory while preparing a picture: " + fault.text);
    if (fault.code != RTC_ERROR_NONE)
        throw std::logic_error("internal fault: Embree says " + fault.text);
}

// What a shadow ray gathers on its way. Sums and products only: Embree reports crossings in any order.
struct ShadowContext {
    RTCIntersectContext embree;  // first, so that Embree's pointer is also ours
    const EmbreeScene* rays;
    const Scene* scene;
    float skins = 1;
    Vec3f optical_depth = Vec3f::Zero();  // ∫ absorption along the ray
};

// A shadow ray meets a clear mesh: note it and let the ray go on.
void cross_clear_mesh(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<ShadowContext*>(arguments->context);
    const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    const Mesh& mesh = context.scene->meshes[hit.geomID];
    const Vec3f direction(ray.dir_x, ray.dir_y, ray.dir_z);
    const bool leaves = direction.dot(Vec3f(hit.Ng_x, hit.Ng_y, hit.Ng_z)) > 0;
    const Vec3f normal = shading_normal(mesh, int(hit.primID), hit.u, hit.v);
    const Coat* coat = leaves ? nullptr : context.rays->blurred_coat(int(hit.geomID));
    context.skins *=
        skin_transmittance(mesh.material.opacity, coat, std::abs(normal.dot(direction)));
    context.optical_depth += (leaves ? ray.tfar : -ray.tfar) * mesh.material.absorption;
    arguments->valid[0] = 0;
}

void set_ray(RTCRay& target, const Ray& ray, float distance) {
    target.org_x = ray.origin.x(), target.org_y = ray.origin.y(), target.org_z = ray.origin.z();
    target.dir_x = ray.direction.x(), target.dir_y = ray.direction.y(),
    target.dir_z = ray.direction.z();
    target.tnear = 0;
    target.tfar = distance;
    target.time = 0;
    target.mask = ~0u;
    target.id = 0;
    target.flags = 0;
}

}  // namespace

DenormalsAreZero::DenormalsAreZero() : previous_(_mm_getcsr()) {
    _mm_setcsr(previous_ | flush_and_zero);
}

DenormalsAreZero::~DenormalsAreZero() {
    _mm_setcsr(previous_);
}

Vec3f shading_normal(const Mesh& mesh, int triangle, float u, float v) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Vec3f sum = (1 - u - v) * mesh.normals[a] + u * mesh.normals[b] + v * mesh.normals[c];
    const float length = sum.norm();
    return length > 0 ? Vec3f(sum / length) : mesh.normals[a];
}

EmbreeScene::EmbreeScene(const Scene& scene)
    : scene_(scene),
      device_(nullptr, rtcReleaseDevice),
      accelerator_(nullptr, rtcReleaseScene) {
    device_.reset(rtcNewDevice(nullptr));
    if (!device_)
        raise({rtcGetDeviceError(nullptr), "no device"});
    Fault fault;
    rtcSetDeviceErrorFunction(device_.get(), note, &fault);
    accelerator_.reset(rtcNewScene(device_.get()));
    raise(fault);
    rtcSetSceneFlags(accelerator_.get(), RTC_SCENE_FLAG_ROBUST);
    for (int m = 0; m < int(scene.meshes.size()); ++m) {
        attach(m);
        raise(fault);
    }
    // One thread builds: the order of triangles in the tree, and so which of two at an edge is hit, never changes. An
    // arena of one says so for the build alone; the device's own limit would bind all of TBB.
    tbb::task_arena builder(1);
    builder.execute([&] { rtcJoinCommitScene(accelerator_.get()); });
    raise(fault);
    rtcSetDeviceErrorFunction(device_.get(), nullptr, nullptr);
}

void EmbreeScene::attach(int mesh_index) {
    const Mesh& mesh = scene_.meshes[mesh_index];
    const float roughness = mesh.material.roughness;
    if (mesh.material.coated)
        coats_.push_back({Coat(roughness), Coat(std::max(roughness, min_blurred_roughness))});
    else
        coats_.push_back({});
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto fill = [geometry](RTCBufferType type, RTCFormat format, const auto& rows) {
        const std::size_t row_size = sizeof(rows[0]);
        void* buffer =
            rtcSetNewGeometryBuffer(geometry, type, 0, format, row_size, rows.size());
        if (buffer)
            std::memcpy(buffer, rows.data(), rows.size() * row_size);
    };
    fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions);
    fill(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
    if (mesh.material.opacity < 1)
        rtcSetGeometryOccludedFilterFunction(geometry, cross_clear_mesh);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(accelerator_.get(), geometry, unsigned(mesh_index));
    rtcReleaseGeometry(geometry);
}

std::optional<MeshHit> EmbreeScene::nearest(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query;
    set_ray(query.ray, ray, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(accelerator_.get(), &context, &query);
    const RTCHit& hit = query.hit;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    const Vec3f normal = Vec3f(hit.Ng_x, hit.Ng_y, hit.Ng_z).normalized();
    return MeshHit{query.ray.tfar, int(hit.geomID), int(hit.primID), hit.u, hit.v, normal};
}

Vec3f EmbreeScene::transmittance(const Ray& ray, float distance) const {
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.rays = this;
    context.scene = &scene_;
    RTCRay query;
    set_ray(query, ray, distance);
    rtcOccluded1(accelerator_.get(), &context.embree, &query);
    if (query.tfar < 0)  // Embree's mark of something opaque
        return Vec3f::Zero();
    return context.skins * (-context.optical_depth).array().min(0.0f).exp().matrix();
}

}  // namespace render
