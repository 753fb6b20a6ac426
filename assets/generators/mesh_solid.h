// Solids of closed triangle meshes.
#pragma once

#include "assets/generators/solid.h"

#include <filesystem>

namespace assets {

/// The solid enclosed by a mesh: an OpenVDB level set with the given voxel edge and band [m], sampled trilinearly. Voxels
/// are halved, twice at most, where the level set has lost or gained volume: thin parts need them.
/// Throws Error(Input) where the mesh has open edges, or where the level set's inside is not what the mesh encloses.
/// `name` is how messages call the mesh.
std::unique_ptr<Solid> make_mesh_solid(const TriangleMesh& mesh,
                                       const std::filesystem::path& name,
                                       double voxel,
                                       double band);

}  // namespace assets
