// Surfaces and frames as whole files, checked on the way out.
//
// A frame's content, per surface: 1 where it varies, else 0; numbers of vertices and attributes; positions; normals;
// each attribute with its name; where it varies, the number of triangles, these, and colours.
#pragma once

#include "assets/frames/frame_cache.h"
#include "assets/frames/packed_file.h"

#include <cstddef>
#include <string>
#include <vector>

namespace assets {

/// std::logic_error where lengths disagree, an index is out of range, or a value is not finite.
std::string encode_surfaces(const std::vector<CachedSurface>& surfaces);
std::vector<CachedSurface> decode_surfaces(const PackedFile& file);

/// The same checks; `n_vertices` of each surface.
std::string encode_frame(const Frame& frame, const std::vector<VertexCount>& n_vertices);
Frame decode_frame(const PackedFile& file);

std::string encode_checkpoint(int frame_number, const std::vector<std::byte>& state);

}  // namespace assets
