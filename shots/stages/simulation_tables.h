// stats.csv, probes.csv and pins.csv: what a simulation tells in numbers, in SI units.
#pragma once

#include "sim/simulation.h"

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

/// Rows of all tables for one frame. std::logic_error where a number is not finite.
struct FrameRows {
    std::string stats, probes, pins;
};

FrameRows frame_rows(int frame,
                     double time,
                     const sim::Stats& stats,
                     const std::vector<sim::ProbeRow>& probes,
                     const std::vector<sim::PinRow>& pins,
                     double seconds);

/// The three tables of a shot's output folder.
class SimulationTables {
  public:
    explicit SimulationTables(std::filesystem::path folder);

    /// Whether all tables are there and reach up to this frame.
    bool reach(int frame) const;

    /// Drops the rows after this frame; creates missing tables.
    void cut_after(int frame) const;

    /// Appends and flushes the rows of the next frame. Throws assets::Error(Resources).
    void append(const FrameRows& rows) const;

  private:
    std::filesystem::path stats_, probes_, pins_;
};

}  // namespace shots
