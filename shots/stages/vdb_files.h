// The surfaces of bodies made of points as OpenVDB files, for other programs: vdb/BODY.####.vdb.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace shots {

class VdbFiles {
  public:
    /// `folder` is the shot's output.
    explicit VdbFiles(const std::filesystem::path& folder) : folder_(folder / "vdb") {}

    std::filesystem::path path(const std::string& body, int frame) const;

    /// Whether there is a file of every body for every one of the frames.
    bool hold(const std::vector<std::string>& bodies, const std::vector<int>& frames) const;

    /// Removes the files of frames after this one, of whatever body, and what a killed process has left behind.
    void cut_after(int frame) const;

    /// Throws assets::Error(Resources).
    void write(const std::string& body, int frame, const std::string& bytes) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace shots
