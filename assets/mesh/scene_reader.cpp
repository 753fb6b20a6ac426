#include "assets/mesh/scene_reader.h"

#include "assets/base/error.h"
#include "assets/mesh/file_text.h"

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <exception>
#include <fmt/format.h>
#include <map>
#include <utility>

namespace assets {
namespace {

namespace fs = std::filesystem;

constexpr const char* main_formats = "obj, ply, stl, off, gltf, glb, fbx, dae, 3ds, x";

// Names that loaders make up where the file gives none.
bool is_made_up(const std::string& name) {
    return name.empty() || name.front() == '<' || name == AI_DEFAULT_MATERIAL_NAME
           || name == "%%%DEFAULT" || name == "defaultobject";
}

Eigen::Affine3d as_affine(const aiMatrix4x4& m) {
    Eigen::Affine3d affine;
    affine.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
        0, 0, 0, 1;
    return affine;
}

// Walks the scene's nodes and gathers their meshes.
class Gatherer {
  public:
    Gatherer(const aiScene& scene, const fs::path& file) : scene_(scene), file_(file) {}

    void add_node(const aiNode& node, const Eigen::Affine3d& to_world) {
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            if (node.mMeshes[i] >= scene_.mNumMeshes)
                throw_damaged(file_, "it refers to a mesh that it does not have");
            add_mesh(*scene_.mMeshes[node.mMeshes[i]], node, to_world);
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) {
            const aiNode& child = *node.mChildren[i];
            add_node(child, to_world * as_affine(child.mTransformation));
        }
    }

    /// What was gathered. A group for what has no name is only needed beside others.
    PolygonSoup take() {
        if (const auto unnamed = groups_.find(""); unnamed != groups_.end())
            soup_.groups[unnamed->second] = "unnamed";
        if (groups_.size() == 1 && groups_.begin()->first.empty()) {
            soup_.groups.clear();
            soup_.face_group.clear();
        }
        return std::move(soup_);
    }

  private:
    void add_mesh(const aiMesh& source, const aiNode& node, const Eigen::Affine3d& to_world) {
        const int first = static_cast<int>(soup_.positions.size());
        for (unsigned v = 0; v < source.mNumVertices; ++v) {
            const aiVector3D& p = source.mVertices[v];
            const Vec3 x(p.x, p.y, p.z);
            // What is not finite stays to be told as it is: moving would spread it to all three
            // coordinates.
            soup_.positions.push_back(x.allFinite() ? to_world * x : x);
        }
        // A mirroring node turns its faces over.
        const bool mirrored = to_world.linear().determinant() < 0;
        const int group = group_index(source, node);
        for (unsigned f = 0; f < source.mNumFaces; ++f) {
            const aiFace& face = source.mFaces[f];
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                const unsigned v = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
                if (v >= source.mNumVertices)
                    throw_damaged(file_, "a face refers to a vertex that does not exist");
                soup_.corners.push_back(first + static_cast<int>(v));
            }
            soup_.face_ends.push_back(soup_.corners.size());
            soup_.face_group.push_back(group);
        }
    }

    // The material's name, or where it has none that of the mesh, or of the node.
    int group_index(const aiMesh& source, const aiNode& node) {
        aiString material;
        if (source.mMaterialIndex < scene_.mNumMaterials)
            scene_.mMaterials[source.mMaterialIndex]->Get(AI_MATKEY_NAME, material);
        std::string name;
        for (const aiString& candidate : {material, source.mName, node.mName}) {
            name = candidate.C_Str();
            if (!is_made_up(name))
                break;
            name.clear();
        }
        const auto [known, is_new] =
            groups_.try_emplace(name, static_cast<int>(soup_.groups.size()));
        if (is_new)
            soup_.groups.push_back(name);
        return known->second;
    }

    const aiScene& scene_;
    const fs::path& file_;
    PolygonSoup soup_;
    std::map<std::string, int> groups_;
};

// From the numbers of the file to metres. Loaders of other formats convert, or have no unit to know
// of.
double metres_per_unit(const aiScene& scene, const std::string& extension) {
    float centimetres = 1;
    if (extension != ".fbx")
        return 1;
    if (scene.mMetaData != nullptr)
        scene.mMetaData->Get("UnitScaleFactor", centimetres);
    return 0.01 * static_cast<double>(centimetres);
}

// One line of what the loader complains about.
std::string complaint(const std::string& text) {
    const std::string line = text.substr(0, text.find_first_of("\r\n"));
    return line.empty() ? "the loader gave no reason" : line;
}

const aiScene& read_file(Assimp::Importer& importer,
                         const fs::path& file,
                         const std::string& extension) {
    if (!importer.IsExtensionSupported(extension))
        throw Error(
            ErrorKind::Input,
            fmt::format(
                "mesh '{}' has the format '{}', which cannot be read; export it as one of: {}",
                file.string(),
                extension,
                main_formats));
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    std::string reason;
    try {
        // No post-processing: its steps abort the program on broken faces, and ours are needed
        // anyway.
        if (const aiScene* scene = importer.ReadFile(file.string(), 0))
            return *scene;
        reason = importer.GetErrorString();
    } catch (const std::exception& exception) {
        reason = exception.what();
    }
    throw Error(
        ErrorKind::Input,
        fmt::format("mesh '{}' cannot be read as {}: {}; export it again, or as one of: {}",
                    file.string(),
                    extension.substr(1),
                    complaint(reason),
                    main_formats));
}

}  // namespace

PolygonSoup read_scene(const fs::path& file, std::vector<std::string>* notes) {
    const std::string extension = extension_of(file);
    Assimp::Importer importer;
    const aiScene& scene = read_file(importer, file, extension);

    const double scale = metres_per_unit(scene, extension);
    if (scale != 1)
        notes->push_back(fmt::format(
            "Lengths are in units of {:g} m in the file and were converted to metres.", scale));
    Eigen::Affine3d to_world(Eigen::Scaling(scale));
    // The 3ds loader adds a turn of its own at the root, from the file's z-up axes to y-up.
    if (extension != ".3ds")
        to_world = to_world * as_affine(scene.mRootNode->mTransformation);

    Gatherer gatherer(scene, file);
    gatherer.add_node(*scene.mRootNode, to_world);
    return gatherer.take();
}

}  // namespace assets
