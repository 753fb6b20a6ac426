// The first stage: a scene becomes a frame cache and tables of numbers.
#pragma once

#include "assets/frames/frame_cache.h"
#include "shots/stages/progress.h"
#include "sim/scene.h"

#include <filesystem>
#include <vector>

namespace shots {

struct SimulateJob {
    sim::Scene scene;
    double fps = 24;                  // > 0
    std::vector<int> frames;          // consecutive, from the shot's first; at least one
    std::filesystem::path folder;     // the shot's output: out/SHOT
    assets::Fingerprint fingerprint;  // of everything that decides the frames
    bool overwrite = false;           // begin again, discarding what the folder holds
};

/// Where the frames of a shot lie in its output folder.
std::filesystem::path cache_folder(const std::filesystem::path& folder);

/// Computes the frames that folder/cache does not hold yet, going on after the last checkpoint. The first frame is
/// the state at time 0 (`Steps::Static`: the equilibrium then), frame k the state at time (k - first) / fps.
///
/// Beside the cache it writes, with one row per frame, or per frame and probe or pin (SI units):
///   stats.csv   steps, iterations, energies, momenta, mass, smallest J, wall-clock seconds
///   probes.csv  positions; mean stretch and volume of regions
///   pins.csv    what holds the body: forces and moments
/// and, per frame and body made of points, its surface as an OpenVDB level set: vdb/BODY.####.vdb.
/// Interrupted and resumed, all files end up the same bytes as in one go, but for the column "seconds".
///
/// Throws Error(Input) where the cache belongs to another fingerprint (nothing is touched then), Error(Interrupted)
/// soon after a signal, with the frame at hand given up (see interruption.h), and whatever the simulation and the cache throw.
void simulate(const SimulateJob& job, Progress& progress);

}  // namespace shots
