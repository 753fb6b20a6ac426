#include "assets/generators/vdb_file.h"

#include "assets/base/error.h"

#include <openvdb/io/Archive.h>

#include <sstream>

namespace assets {

namespace {

/// Writes to any stream what openvdb::io::File writes to disk alone.
class Archive : public openvdb::io::Archive {
  public:
    void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
        constexpr bool seekable = true;  // the header of each grid tells where it ends
        write(stream, grids, seekable);
    }
};

// OpenVDB marks each file with a random identifier, as text behind the magic number, three versions and a flag. Its
// readers do no more than compare it with that of an open file.
constexpr std::size_t identifier_at = sizeof(openvdb::Int64) + 3 * sizeof(openvdb::Index32) + 1;
constexpr const char* identifier = "00000000-0000-4000-8000-000000000000";
constexpr std::size_t identifier_size = 36;

}  // namespace

std::string vdb_file(const openvdb::FloatGrid::ConstPtr& grid) {
    std::ostringstream stream(std::ios::binary);
    Archive archive;
    archive.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    archive.write_to(stream, {grid});
    std::string bytes = stream.str();
    check(bytes.size() > identifier_at + identifier_size && bytes[identifier_at + 8] == '-'
              && bytes[identifier_at + 23] == '-',
          "an OpenVDB file has its identifier behind the versions");
    return bytes.replace(identifier_at, identifier_size, identifier);
}

}  // namespace assets
