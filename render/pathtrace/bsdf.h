// How a point of a surface scatters light, in the local frame whose z axis is the shading normal.
#pragma once

#include "render/pathtrace/sampler.h"
#include "render/scene/scene.h"

#include <array>

namespace render {

/// The clear glossy coat: GGX microfacets with Schlick's Fresnel term for index of refraction 1.5. What it does not
/// reflect reaches the base, so that no energy is made or lost. [Walter 2007; Heitz 2018; Kelemen 2001]
class Coat {
  public:
    /// `roughness` in 0..1; below 0.05 it is taken as 0.05.
    explicit Coat(float roughness);

    /// BSDF times cosine for both directions above the surface.   [1/sr]
    float evaluate(const Vec3f& wo, const Vec3f& wi) const;

    /// Density of sample().   [1/sr]
    float pdf(const Vec3f& wo, const Vec3f& wi) const;

    /// A mirror direction about a microfacet normal that `wo` sees; may point below the surface.
    Vec3f sample(const Vec3f& wo, Pair u) const;

    /// Share of the light from a direction of that cosine (0..1) that the coat reflects.
    float albedo(float cosine) const;

    /// albedo() over all directions, weighted by their cosine.
    float mean_albedo() const { return mean_albedo_; }

  private:
    // Nodes at cosine = (i / 32)²: close where the albedo is steep.
    static constexpr int n_cosines = 33;
    float alpha_;
    std::array<float, n_cosines> albedo_;
    float mean_albedo_;
};

struct BsdfSample {
    Vec3f direction;  // wi
    Vec3f weight;  // BSDF · cos / pdf, over the choice of lobe too; zero where nothing goes on
    float pdf;     // of the direction; 0 where `straight`
    bool straight = false;  // went through undeflected
};

/// A material at one point, seen from one side. From the inside of a clear body pass no coat: what it would reflect
/// there is taken to go straight on, like the rest.
class Bsdf {
  public:
    /// `coat` may be null: no coat. `wo` (unit, z > 0) points to where light goes.
    Bsdf(const Vec3f& color, float opacity, const Coat* coat, const Vec3f& wo);

    /// BSDF · |cos| of the scattered light; straight transmission is no part of it.   [1/sr]
    Vec3f evaluate(const Vec3f& wi) const;

    /// Density with which sample() picks `wi`.   [1/sr]
    float pdf(const Vec3f& wi) const;

    /// `choice` in [0, 1) picks the lobe.
    BsdfSample sample(float choice, Pair u) const;

  private:
    float base_share(float cosine) const;

    Vec3f color_;
    const Coat* coat_;
    Vec3f wo_;
    float under_coat_;  // share of the light towards wo that is not the coat's
    float straight_;    // share of the light towards wo that comes straight through
    float diffuse_;     // share of the light under the coat that the base scatters
    bool clear_;
    float p_coat_, p_straight_, p_diffuse_;  // probabilities of the lobes
};

/// Share of the light that a clear body's skin scatters when crossed at that cosine: a thin layer of Beer's law.
float skin_share(float opacity, float cosine);

/// Share of the light that crosses a clear body's skin straight; `coat` is null on the way out.
float skin_transmittance(float opacity, const Coat* coat, float cosine);

}  // namespace render
