#include "assets/base/error.h"
#include "assets/frames/checksum.h"
#include "assets/frames/encoding.h"
#include "assets/frames/frame_cache.h"
#include "assets/frames/layout.h"
#include "assets/frames/manifest.h"
#include "assets/frames/packed_file.h"

#include <fmt/core.h>

namespace assets {
namespace {

FileHeader frame_header(const std::filesystem::path& folder, int number) {
    const std::filesystem::path path = folder / frame_name(number);
    const FileHeader header = read_header(path, FileKind::Frame);
    if (header.number != number)
        report_damage(path, fmt::format("holds frame {}", header.number));
    return header;
}

bool belongs_to(const SurfaceFrame& frame, const CachedSurface& surface) {
    if (surface.varying)
        return frame.region_color.size() == frame.positions.size();
    return frame.positions.size() == surface.rest_positions.size() && frame.triangles.empty();
}

bool belongs_to(const Frame& frame, const std::vector<CachedSurface>& surfaces) {
    bool same = frame.surfaces.size() == surfaces.size();
    for (std::size_t s = 0; same && s < surfaces.size(); ++s)
        same = belongs_to(frame.surfaces[s], surfaces[s]);
    return same;
}

}  // namespace

FrameCacheReader::FrameCacheReader(std::filesystem::path folder) : folder_(std::move(folder)) {
    const auto manifest = read_manifest(folder_);
    if (!manifest)
        throw Error(ErrorKind::Input,
                    fmt::format("{} holds no frames: simulate first", folder_.string()));
    planned_frames_ = manifest->frame_numbers;
    digest_ = manifest->digest;
    surfaces_checksum_ = manifest->surfaces_checksum;
    surfaces_ = decode_surfaces(unpack(folder_ / surfaces_name, FileKind::Surfaces));
}

std::vector<int> FrameCacheReader::frames() const {
    std::vector<int> result;
    for (const int number : planned_frames_)
        if (std::filesystem::exists(folder_ / frame_name(number)))
            result.push_back(number);
    return result;
}

std::uint64_t FrameCacheReader::checksum(int number) const {
    return frame_header(folder_, number).checksum;
}

Frame FrameCacheReader::read(int number) const {
    const std::filesystem::path path = folder_ / frame_name(number);
    const PackedFile file = unpack(path, FileKind::Frame);
    Frame frame = decode_frame(file);
    if (frame.number != number || !belongs_to(frame, surfaces_))
        report_damage(path, "belongs to another cache");
    return frame;
}

std::pair<Vec3f, Vec3f> FrameCacheReader::bounds(int number) const {
    const FileHeader header = frame_header(folder_, number);
    return {Vec3f(header.low.data()), Vec3f(header.high.data())};
}

}  // namespace assets
