#include "render/pathtrace/bsdf.h"

#include "render/pathtrace/warp.h"

#include <algorithm>
#include <cmath>

namespace render {

namespace {

constexpr float f0 = 0.04f;  // ((n - 1) / (n + 1))² for n = 1.5
constexpr float min_roughness = 0.05f;

float fresnel(float cosine) {
    const float m = 1 - std::clamp(cosine, 0.0f, 1.0f);
    return f0 + (1 - f0) * m * m * m * m * m;
}

// Density of microfacet normals.
float ggx(const Vec3f& h, float alpha) {
    const float a2 = alpha * alpha;
    const float d = (h.x() * h.x() + h.y() * h.y()) + a2 * h.z() * h.z();
    return a2 / (pi * d * d);
}

// Smith's Λ: masked over visible microfacet area.
float lambda(const Vec3f& w, float alpha) {
    const float tan2 = (w.x() * w.x() + w.y() * w.y()) / (w.z() * w.z());
    return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}

}  // namespace

Coat::Coat(float roughness) {
    const float r = std::clamp(roughness, min_roughness, 1.0f);
    alpha_ = r * r;
    // Albedo = mean of F · G2 / G1 over the directions that sample() gives.
    constexpr int n = 16;
    for (int i = 0; i < n_cosines; ++i) {
        const float s = std::max(i / float(n_cosines - 1), 1e-2f);
        const float cosine = s * s;
        const Vec3f wo(std::sqrt(1 - cosine * cosine), 0, cosine);
        double sum = 0;
        for (int k = 0; k < n * n; ++k) {
            const Vec3f wi = sample(wo, {(float(k % n) + 0.5f) / n, (float(k / n) + 0.5f) / n});
            if (wi.z() > 0)
                sum += evaluate(wo, wi) / pdf(wo, wi);
        }
        albedo_[i] = float(sum / (n * n));
    }
    // ∫ 2 c albedo dc with c = s², by Simpson's rule in s.
    double mean = 0;
    for (int i = 0; i < n_cosines; ++i) {
        const double s = i / double(n_cosines - 1);
        const double weight = i == 0 || i == n_cosines - 1 ? 1 : i % 2 ? 4 : 2;
        mean += weight / (3.0 * (n_cosines - 1)) * 4 * s * s * s * albedo_[i];
    }
    mean_albedo_ = float(mean);
}

float Coat::evaluate(const Vec3f& wo, const Vec3f& wi) const {
    const Vec3f h = (wo + wi).normalized();
    const float g2 = 1 / (1 + lambda(wo, alpha_) + lambda(wi, alpha_));
    return fresnel(wo.dot(h)) * ggx(h, alpha_) * g2 / (4 * wo.z());
}

float Coat::pdf(const Vec3f& wo, const Vec3f& wi) const {
    const Vec3f h = (wo + wi).normalized();
    return ggx(h, alpha_) / (4 * wo.z() * (1 + lambda(wo, alpha_)));
}

Vec3f Coat::sample(const Vec3f& wo, Pair u) const {
    // Visible normals of the ellipsoid stretched to a hemisphere [Heitz 2018].
    const Vec3f v = Vec3f(alpha_ * wo.x(), alpha_ * wo.y(), wo.z()).normalized();
    const Pair disc = uniform_disc(u);
    const float s = (1 + v.z()) / 2;
    const float y = (1 - s) * std::sqrt(std::max(0.0f, 1 - disc.x * disc.x)) + s * disc.y;
    const float z = std::sqrt(std::max(0.0f, 1 - disc.x * disc.x - y * y));
    // Heitz' frame: the first axis is level and normal to v.
    const float level = v.x() * v.x() + v.y() * v.y();
    const Vec3f t1 =
        level > 0 ? Vec3f(Vec3f(-v.y(), v.x(), 0) / std::sqrt(level)) : Vec3f(1, 0, 0);
    const Vec3f t2 = v.cross(t1);
    const Vec3f n = disc.x * t1 + y * t2 + z * v;
    const Vec3f h = Vec3f(alpha_ * n.x(), alpha_ * n.y(), std::max(1e-6f, n.z())).normalized();
    return 2 * wo.dot(h) * h - wo;
}

float Coat::albedo(float cosine) const {
    const float at = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (n_cosines - 1);
    const int i = std::min(int(at), n_cosines - 2);
    return albedo_[i] + (at - float(i)) * (albedo_[i + 1] - albedo_[i]);
}

float skin_share(float opacity, float cosine) {
    if (opacity >= 1)
        return 1;
    return 1 - std::exp(std::log1p(-opacity) / std::max(cosine, 0.05f));
}

float skin_transmittance(float opacity, const Coat* coat, float cosine) {
    return (1 - skin_share(opacity, cosine)) * (coat ? 1 - coat->albedo(cosine) : 1.0f);
}

Bsdf::Bsdf(const Vec3f& color, float opacity, const Coat* coat, const Vec3f& wo)
    : color_(color), coat_(coat), wo_(wo), clear_(opacity < 1) {
    const float reflected = coat ? coat->albedo(wo.z()) : 0.0f;
    under_coat_ = 1 - reflected;
    diffuse_ = skin_share(opacity, wo.z());
    straight_ = under_coat_ * (1 - diffuse_);
    // In proportion to the light each lobe carries, but never so seldom that a highlight turns to sparks.
    const float coat_weight = coat ? std::max(reflected, 0.2f) : 0.0f;
    const float diffuse_weight = under_coat_ * diffuse_ * std::max(color.mean(), 0.05f);
    const float sum = coat_weight + diffuse_weight + straight_;
    p_coat_ = coat_weight / sum;
    p_straight_ = straight_ / sum;
    p_diffuse_ = diffuse_weight / sum;
}

// Reciprocal split between coat and base [Kelemen 2001]: integrates to 1 - albedo(wo) over all wi.
float Bsdf::base_share(float cosine) const {
    return coat_ ? under_coat_ * (1 - coat_->albedo(cosine)) / (1 - coat_->mean_albedo())
                 : 1.0f;
}

Vec3f Bsdf::evaluate(const Vec3f& wi) const {
    const float cosine = std::abs(wi.z());
    if (cosine == 0 || (wi.z() < 0 && !clear_))
        return Vec3f::Zero();
    // A thin skin scatters half of its light to each side.
    const float sides = clear_ ? 0.5f : 1.0f;
    Vec3f value = color_ * (base_share(cosine) * diffuse_ * sides * cosine / pi);
    if (coat_ && wi.z() > 0)
        value.array() += coat_->evaluate(wo_, wi);
    return value;
}

float Bsdf::pdf(const Vec3f& wi) const {
    if (wi.z() == 0 || (wi.z() < 0 && !clear_))
        return 0;
    float density = p_diffuse_ * (clear_ ? 0.5f : 1.0f) * std::abs(wi.z()) / pi;
    if (coat_ && wi.z() > 0)
        density += p_coat_ * coat_->pdf(wo_, wi);
    return density;
}

BsdfSample Bsdf::sample(float choice, Pair u) const {
    if (choice < p_straight_)
        return {-wo_, Vec3f::Constant(straight_ / p_straight_), 0, true};
    BsdfSample result;
    if (choice < p_straight_ + p_coat_) {
        result.direction = coat_->sample(wo_, u);
        if (result.direction.z() <= 0)
            return {result.direction, Vec3f::Zero(), 0};
    } else {
        result.direction = cosine_hemisphere(u);
        if (clear_ && choice - p_straight_ - p_coat_ < p_diffuse_ / 2)
            result.direction.z() *= -1;
    }
    result.pdf = pdf(result.direction);
    result.weight =
        result.pdf > 0 ? Vec3f(evaluate(result.direction) / result.pdf) : Vec3f(Vec3f::Zero());
    return result;
}

}  // namespace render
