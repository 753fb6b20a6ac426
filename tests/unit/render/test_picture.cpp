#include "assets/base/error.h"
#include "render/pathtrace/path_tracer.h"
#include "render/render.h"
#include "render/shot_pictures.h"
#include "tests/unit/assets/frames/cache_fixture.h"
#include "tests/unit/render/meshes.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <xmmintrin.h>

using namespace render;

namespace {

// A gel ball with a smaller opaque one inside, as two surfaces of a body.
struct Shot {
    std::vector<assets::CachedSurface> surfaces;
    assets::Frame frame;
    Options options;
    std::vector<Bounds> bounds{{Vec3f::Constant(-1), Vec3f::Constant(1)}};

    Shot() {
        for (const float radius : {1.0f, 0.4f}) {
            const Mesh ball = testing::sphere(
                Vec3f::Zero(), radius, Vec3f(0.7f, 0.2f, 0.1f), testing::matt());
            surfaces.push_back({"ball",
                                radius == 1 ? "outside" : "inside",
                                ball.triangles,
                                ball.positions,
                                ball.colors});
            frame.surfaces.push_back({ball.positions, ball.normals, {}});
        }
        frame.number = 12;
        options.width = 72, options.height = 40;
        options.samples = 4;
        options.looks[{"ball", "outside"}].opacity = 0.3f;
    }

    Image picture() const { return ShotPictures(surfaces, bounds, options).picture(frame); }
};

bool same_bytes(const Image& a, const Image& b) {
    return a.pixels.size() == b.pixels.size()
           && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Vec3f))
                  == 0;
}

}  // namespace

TEST_CASE("a picture is the same for one and two threads, and the next time") {
    const Shot shot;
    const Image first = shot.picture();
    CHECK(same_bytes(first, shot.picture()));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(same_bytes(first, shot.picture()));
}

TEST_CASE(
    "a picture shows the body in its middle, before a brighter backdrop, through clear gel") {
    Shot shot;
    shot.options.samples = 16;
    const Image picture = shot.picture();
    const Vec3f middle = picture.pixels[std::size_t(20) * 72 + 36], corner = picture.pixels[0];
    CHECK(middle.x() > 2 * middle.z());     // the red ball inside shows
    CHECK(corner.x() < 1.3f * corner.z());  // the backdrop is grey
    CHECK(corner.minCoeff() > 0.1f);
}

TEST_CASE("a varying surface goes through the cache into pictures, as large as it is then") {
    const tests::TemporaryFolder folder;
    assets::CachedSurface snow;
    snow.body = "snow";
    snow.skin = "self";
    snow.varying = true;
    assets::FrameCacheWriter writer(folder.path(), {{"fps", "24"}}, {1, 2}, {snow}, false);
    for (const int number : {1, 2}) {
        const float radius = number == 1 ? 1.0f : 0.25f;
        const Mesh ball =
            testing::sphere(Vec3f::Zero(), radius, Vec3f(0.05f, 0.1f, 0.8f), testing::matt());
        assets::SurfaceFrame surface{ball.positions, ball.normals, {}};
        surface.triangles = ball.triangles;
        surface.region_color = ball.colors;
        writer.write({number, 0, {surface}});
    }
    const assets::FrameCacheReader cache(folder.path());
    CHECK(cache.bounds(1).second.y() == Approx(1).epsilon(2e-3));
    CHECK(cache.bounds(2).second.y() == Approx(0.25).epsilon(2e-3));

    Options options;
    options.width = 72, options.height = 40, options.samples = 4;
    options.looks[{"snow", "self"}].coated = false;
    Renderer renderer(cache, {1, 2}, options);
    const auto n_blue = [&](int number) {
        const Image picture = renderer.render(cache.read(number));
        return std::count_if(picture.pixels.begin(), picture.pixels.end(), [](const Vec3f& p) {
            return p.z() > 2 * p.x();
        });
    };
    const auto large = n_blue(1), small = n_blue(2);
    CHECK(large > 200);
    CHECK(small > 10);
    CHECK(large > 8 * small);  // 16 times the area, seen from outside of the middle
}

TEST_CASE("rendering leaves the thread's floating point mode alone") {
    const unsigned mode = _mm_getcsr() & ~0x3fu;  // without the sticky exception flags
    Shot().picture();
    CHECK((_mm_getcsr() & ~0x3fu) == mode);
}

TEST_CASE("light that is not finite is refused with the pixel") {
    Scene scene = testing::furnace();
    scene.backdrop.horizon.y() = std::numeric_limits<float>::quiet_NaN();
    View view = place_camera(Options{}, {{Vec3f::Zero(), Vec3f::Ones()}});
    TraceOptions options;
    options.width = options.height = 4;
    options.samples = 1;
    CHECK_THROWS_WITH(trace(scene, view, options), Catch::Contains("pixel (0, 0)"));
}

TEST_CASE("the picture's key tells every option apart") {
    const Options options;
    std::vector<Options> others(10, options);
    others[0].width = 961;
    others[1].samples = 65;
    others[2].up = {0, 0, 1};
    others[3].camera.lens = 51;
    others[4].camera.f_stop = 2.8;
    others[5].camera.frame_bodies = false;
    others[6].looks[{"a", "b"}].opacity = 0.5f;
    others[7].props.emplace_back();
    others[8].light_rig = "other";
    others[9].looks[{"a", "b"}].coated = false;
    CHECK(picture_key(options) == picture_key(Options{}));
    for (const Options& other : others)
        CHECK(picture_key(other) != picture_key(options));
}

TEST_CASE("options out of range are named") {
    const auto key_of = [](const auto& change) {
        Options options;
        change(options);
        try {
            check(options);
        } catch (const assets::Error& error) {
            CHECK(error.kind() == assets::ErrorKind::Input);
            return error.key();
        }
        return std::string("accepted");
    };
    CHECK(key_of([](Options&) {}) == "accepted");
    CHECK(key_of([](Options& o) { o.height = 0; }) == "output.size");
    CHECK(key_of([](Options& o) { o.samples = 0; }) == "output.samples");
    CHECK(key_of([](Options& o) { o.camera.lens = -1; }) == "camera.lens");
    CHECK(key_of([](Options& o) { o.camera.focus = 0.0; }) == "camera.focus");
    CHECK(key_of([](Options& o) { o.camera.f_stop = 0.0; }) == "camera.f_stop");
    CHECK(key_of([](Options& o) { o.light_rig = "sun"; }) == "light.rig");
    CHECK(key_of([](Options& o) { o.looks[{"bar", "skin"}].opacity = 2; }) == "body.bar.skin");
}
