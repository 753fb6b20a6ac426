#include "assets/base/error.h"
#include "shots/stages/interruption.h"
#include "shots/stages/simulate.h"
#include "tests/unit/assets/frames/cache_fixture.h"
#include "tests/unit/assets/frames/killed_process.h"
#include "tests/unit/shots/stages/fake_simulation.h"

#include <catch2/catch.hpp>
#include <openvdb/openvdb.h>

#include <limits>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

using namespace shots;
using namespace tests;
using Catch::Matchers::Contains;

namespace {

/// Frames 1001..1000+n_frames at 8 frames per second: times are exact.
SimulateJob make_job(const std::filesystem::path& folder, int n_frames) {
    SimulateJob job;
    job.fps = 8;
    for (int i = 0; i < n_frames; ++i)
        job.frames.push_back(1001 + i);
    job.folder = folder;
    job.fingerprint = {{"solver.dt", "0.001"}};
    return job;
}

/// The same with two bodies made of points, each of a dark and a light region.
SimulateJob make_snow_job(const std::filesystem::path& folder, int n_frames) {
    SimulateJob job = make_job(folder, n_frames);
    for (const char* name : {"snow", "ball"}) {
        sim::Body body;
        body.name = name;
        body.regions.resize(2);
        body.regions[0].color = Vec3f::Zero();
        body.regions[1].color = Vec3f::Ones();
        body.skins = {{"self", {}}};
        job.scene.bodies.push_back(body);
    }
    return job;
}

/// Runs the stage in silence and tells what it did to its simulations.
SimulationCounts run(const SimulateJob& job) {
    simulation_counts() = {};
    Progress quiet(ProgressStyle::Quiet);
    simulate(job, quiet);
    return simulation_counts();
}

std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> result;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        result.push_back(line);
    return result;
}

std::string without_last_column(const std::string& text) {
    std::string result;
    for (const std::string& line : lines(text))
        result += line.substr(0, line.rfind(',')) + "\n";
    return result;
}

/// The output folder as a value, without the wall-clock column.
std::map<std::string, std::string> output(const std::filesystem::path& folder) {
    auto files = contents(folder);
    files["stats.csv"] = without_last_column(files["stats.csv"]);
    return files;
}

}  // namespace

TEST_CASE("tables carry the agreed headers and one row per frame and thing") {
    const TemporaryFolder folder;
    run(make_job(folder.path(), 3));

    const auto probes = lines(read_file(folder.path() / "probes.csv"));
    REQUIRE(probes.size() == 1 + 3 * 2);
    CHECK(probes[0] == "frame,time,name,x,y,z,stretch,volume");
    CHECK(probes[1] == "1001,0,\"tip, left\",1,1,3,,");
    CHECK(probes[2] == "1001,0,soft,4,5,0,1.25,0.001");
    CHECK(probes[6] == "1003,0.25,soft,4,5,0.25,1.25,0.001");

    const auto pins = lines(read_file(folder.path() / "pins.csv"));
    REQUIRE(pins.size() == 1 + 3);
    CHECK(pins[0] == "frame,time,pin,force_x,force_y,force_z,moment_x,moment_y,moment_z");
    CHECK(pins[1] == "1001,0,wall,1,0,0,0,0,0.5");

    const auto stats = lines(read_file(folder.path() / "stats.csv"));
    REQUIRE(stats.size() == 1 + 3);
    CHECK(stats[0]
          == "frame,time,steps,newton_iterations,cg_iterations,kinetic_energy,elastic_energy,"
             "gravitational_energy,linear_momentum_x,linear_momentum_y,linear_momentum_z,"
             "angular_momentum_x,angular_momentum_y,angular_momentum_z,total_mass,smallest_j,"
             "collider_penetration,penetration,gap,seconds");
    CHECK_THAT(stats[1], Contains("1001,0,2,0,0,1,0,0,0,0,0,0.1,0,-1e-300,8,0.5,"));

    // Numbers read back as the same double: history after the first step is 0.7 + 1/8 + 1/3.
    const double history = 0.7 * 1.0 + 0.125 + 1.0 / 3;
    CHECK(std::stod(lines(read_file(folder.path() / "pins.csv"))[2].substr(16)) == history);
}

TEST_CASE("the first frame is the state at time 0, in equilibrium where steps are static") {
    const TemporaryFolder folder;
    auto job = make_job(folder.path(), 4);
    CHECK(run(job).advanced == 3);
    CHECK(assets::FrameCacheReader(cache_folder(job.folder)).read(1004).time == 0.375);
    job.scene.solver.steps = sim::Steps::Static;
    job.overwrite = true;
    CHECK(run(job).advanced == 4);
}

TEST_CASE("a finished shot builds no simulation and changes nothing") {
    const TemporaryFolder folder;
    auto job = make_job(folder.path(), 4);
    CHECK(run(job).built == 1);
    const auto before = contents(folder.path());
    CHECK(run(job).built == 0);
    CHECK(run(make_job(folder.path(), 2)).built == 0);
    CHECK(contents(folder.path()) == before);

    std::ostringstream told;
    Progress progress(ProgressStyle::Lines, told);
    simulate(job, progress);
    CHECK_THAT(told.str(), Contains("all 4 frames"));
    job.overwrite = true;
    CHECK(run(job).advanced == 3);
}

TEST_CASE("a longer range of frames goes on where the shorter one ended") {
    const TemporaryFolder folder;
    run(make_job(folder.path() / "whole", 9));
    run(make_job(folder.path() / "grown", 4));
    const auto counts = run(make_job(folder.path() / "grown", 9));
    CHECK(counts.restored == 1);
    CHECK(counts.advanced == 5);
    CHECK(output(folder.path() / "grown") == output(folder.path() / "whole"));
}

TEST_CASE("another fingerprint is refused before a simulation is built, and touches nothing") {
    const TemporaryFolder folder;
    auto job = make_job(folder.path(), 3);
    run(job);
    const auto before = contents(folder.path());
    job.fingerprint["solver.dt"] = "0.002";
    simulation_counts() = {};
    CHECK_THROWS_WITH(run(job), Contains("solver.dt: 0.001 -> 0.002"));
    CHECK(simulation_counts().built == 0);
    CHECK(contents(folder.path()) == before);

    job.overwrite = true;
    CHECK(run(job).advanced == 2);
    CHECK(lines(read_file(folder.path() / "stats.csv")).size() == 4);
}

TEST_CASE("what another version of the program began is refused and kept") {
    const TemporaryFolder folder;
    auto job = make_job(folder.path(), 3);
    run(job);
    assets::FrameCacheWriter(cache_folder(job.folder),
                             job.fingerprint,
                             job.frames,
                             assets::FrameCacheReader(cache_folder(job.folder)).surfaces(),
                             false)
        .write_checkpoint(1003, make_state(1));  // no state of this version
    const auto before = output(folder.path());
    CHECK(run(job).built == 0);  // nothing is left to do

    job = make_job(folder.path(), 5);
    CHECK_THROWS_WITH(run(job),
                      Contains("another version of supple") && Contains("1003; start again"));
    CHECK(simulation_counts().built == 0);
    CHECK(output(folder.path()) == before);

    job.overwrite = true;
    CHECK(run(job).advanced == 4);
}

TEST_CASE("whatever is lost or damaged is computed again, to the same bytes") {
    const TemporaryFolder folder;
    const auto job = make_job(folder.path(), 6);
    run(job);
    const auto whole = output(folder.path());
    const auto cache = cache_folder(job.folder);

    SECTION("a frame after the checkpoint is gone") {
        std::filesystem::remove(cache / "frame.1006.bin");
        CHECK(run(job).restored == 0);  // the only checkpoint is that of the lost frame
    }
    SECTION("a frame is cut") {
        write_file(cache / "frame.1003.bin", read_file(cache / "frame.1003.bin").substr(0, 99));
        CHECK(run(job).advanced == 5);
    }
    SECTION("a table is gone") {
        std::filesystem::remove(folder.path() / "probes.csv");
        CHECK(run(job).advanced == 5);
    }
    SECTION("the table's last row was not finished, and a temporary file is left") {
        const std::string stats = read_file(folder.path() / "stats.csv");
        write_file(folder.path() / "stats.csv", stats.substr(0, stats.size() - 9));
        write_file(folder.path() / ".stats.csv.tmp.12", "left over");
        CHECK(run(job).advanced == 5);
    }
    SECTION("the cache is gone") {
        std::filesystem::remove_all(cache);
        CHECK(run(job).advanced == 5);
    }
    CHECK(output(folder.path()) == whole);
}

TEST_CASE("why frames that are there are simulated again is told") {
    const TemporaryFolder folder;
    const auto job = make_job(folder.path(), 3);
    run(job);
    const auto cache = cache_folder(job.folder);
    std::string reason;
    SECTION("a frame") {
        std::filesystem::remove(cache / "frame.1002.bin");
        reason = "frame 1002 is lost or damaged";
    }
    SECTION("a table") {
        std::filesystem::remove(folder.path() / "probes.csv");
        reason = "a table or an OpenVDB file";
    }
    SECTION("the checkpoint") {
        write_file(cache / "checkpoint.bin", "damaged");
        reason = "the checkpoint is lost or damaged";
    }
    std::ostringstream told;
    Progress progress(ProgressStyle::Lines, told);
    simulate(job, progress);
    CHECK_THAT(told.str(), Contains("begins again at frame 1001: " + reason));
}

TEST_CASE("bodies made of points reach the cache and files of OpenVDB") {
    const TemporaryFolder folder;
    const SimulateJob job = make_snow_job(folder.path(), 2);
    run(job);
    const assets::FrameCacheReader cache(cache_folder(job.folder));
    REQUIRE(cache.surfaces().size() == 3);  // after what the simulation carries by itself
    CHECK_FALSE(cache.surfaces()[0].varying);
    CHECK(cache.surfaces()[1].varying);
    CHECK(cache.surfaces()[1].body == "snow");
    CHECK(cache.surfaces()[2].body == "ball");
    CHECK(cache.surfaces()[2].skin == "self");

    const assets::SurfaceFrame surface = cache.read(1002).surfaces[1];
    REQUIRE_FALSE(surface.triangles.empty());
    const auto& stretch = surface.attributes.at("stretch");
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        const float gray = surface.region_color[v].x();
        CHECK((gray >= 0 && gray <= 1.0001f));
        CHECK((stretch[v] >= 0.9999f && stretch[v] <= 1.5001f));
        const float region = surface.attributes.at("region")[v];
        CHECK((region == 0 || region == 1));
    }

    for (const char* name :
         {"snow.1001.vdb", "snow.1002.vdb", "ball.1001.vdb", "ball.1002.vdb"}) {
        openvdb::initialize();
        openvdb::io::File file((folder.path() / "vdb" / name).string());
        file.open(false);  // all at once
        CHECK(file.readGrid("surface")->activeVoxelCount() > 50);
    }
}

TEST_CASE("files of OpenVDB that are lost, or left behind, are made good by a resume") {
    const TemporaryFolder folder;
    const SimulateJob job = make_snow_job(folder.path(), 4);
    run(job);
    const auto whole = output(folder.path());
    const auto vdb = folder.path() / "vdb";
    REQUIRE(whole.count("vdb/ball.1004.vdb") == 1);
    CHECK(run(job).built == 0);

    SECTION("one is lost") {
        std::filesystem::remove(vdb / "snow.1002.vdb");
        CHECK(run(job).advanced == 3);
    }
    SECTION("the last frame is lost and its file was being written") {
        std::filesystem::remove(cache_folder(job.folder) / "frame.1004.bin");
        std::filesystem::rename(vdb / "snow.1004.vdb", vdb / ".snow.1004.vdb.tmp.17");
        CHECK(run(job).advanced == 3);
    }
    SECTION("the shot went on from a frame that diverged") {
        std::filesystem::remove_all(folder.path() / "cache");
        std::filesystem::remove_all(vdb);
        divergence_time() = 0.25;
        CHECK_THROWS_WITH(run(job), "the fake diverges");
        divergence_time() = std::numeric_limits<double>::infinity();
        CHECK(std::filesystem::exists(vdb / "ball.1002.vdb"));
        CHECK_FALSE(std::filesystem::exists(vdb / "ball.1003.vdb"));
        CHECK(run(job).restored == 1);
    }
    SECTION("a longer shot was overwritten") {
        write_file(vdb / "other.1009.vdb", "old");
        SimulateJob again = job;
        again.overwrite = true;
        CHECK(run(again).advanced == 3);
    }
    CHECK(output(folder.path()) == whole);
}

TEST_CASE("files in the folder of OpenVDB files that are not the shot's stay") {
    const TemporaryFolder folder;
    const std::vector<std::string> foreign{"notes.txt", "snow.vdb", ".vdb", "snow.x1.vdb"};
    std::filesystem::create_directories(folder.path() / "vdb");
    for (const std::string& name : foreign)
        write_file(folder.path() / "vdb" / name, "mine");
    run(make_snow_job(folder.path(), 1));
    for (const std::string& name : foreign)
        CHECK(read_file(folder.path() / "vdb" / name) == "mine");
}

TEST_CASE("a simulation that diverges leaves the frames before, and does so again") {
    const TemporaryFolder folder;
    const auto job = make_job(folder.path(), 6);
    divergence_time() = 0.5;
    for (int time = 0; time < 2; ++time) {
        CHECK_THROWS_WITH(run(job), "the fake diverges");
        CHECK(assets::FrameCacheReader(cache_folder(job.folder)).frames().size() == 4);
        CHECK(lines(read_file(folder.path() / "stats.csv")).size() == 1 + 4);
    }
    divergence_time() = std::numeric_limits<double>::infinity();
    CHECK(run(job).advanced == 2);
}

TEST_CASE("a shot killed at any moment and resumed ends up with the same bytes") {
    const TemporaryFolder folder;
    constexpr int n_frames = 3;
    run(make_job(folder.path() / "whole", n_frames));
    const auto whole = output(folder.path() / "whole");
    REQUIRE(whole.size() == n_frames + 3 + 3);

    const auto job = make_job(folder.path() / "killed", n_frames);
    int n_kills = 0, n_different = 0, n_begun_again = 0;
    while (killed_at_file_operation([&] { run(job); }, n_kills)) {
        const bool has_checkpoint =
            std::filesystem::exists(cache_folder(job.folder) / "checkpoint.bin");
        const auto counts = run(job);
        n_begun_again += has_checkpoint && counts.restored < counts.built;
        n_different += output(job.folder) != whole;
        std::filesystem::remove_all(job.folder);
        ++n_kills;
    }
    CHECK(n_kills > 60);
    CHECK(n_different == 0);
    CHECK(n_begun_again == 0);
}

TEST_CASE("a signal ends the stage after the frame at hand, the same job then goes on") {
    const TemporaryFolder folder;
    const auto job = make_job(folder.path(), 6);
    const pid_t child = ::fork();
    if (child == 0) {
        catch_interruptions();
        interruption_time() = 0.375;  // within the fourth frame
        try {
            run(job);
            ::_exit(0);
        } catch (const assets::Error& error) {
            ::_exit(static_cast<int>(error.kind()));
        }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 75);
    CHECK(assets::FrameCacheReader(cache_folder(job.folder)).frames().size() == 4);

    const auto counts = run(job);
    CHECK(counts.restored == 1);
    CHECK(counts.advanced == 2);
}
