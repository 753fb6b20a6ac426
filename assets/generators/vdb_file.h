// OpenVDB files as bytes.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace assets {

/// The file that openvdb::io::File would write for `grid`, compressed; the same bytes for the same grid.
std::string vdb_file(const openvdb::FloatGrid::ConstPtr& grid);

}  // namespace assets
