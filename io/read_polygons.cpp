// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_polygons.h"

#include "io/input_error.h"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace toile {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw InputError(path + ": " + why);
}

std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension.empty() ? extension : extension.substr(1);
}

std::string read_bytes(const std::string& path, std::uintmax_t max_bytes) {
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(path, error);
    if (error || !is_file) refuse(path, "there is no such file");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) refuse(path, "the file cannot be read");
    if (size > max_bytes)
        refuse(path, "the file has " + std::to_string(size) + " bytes; avatars of at most " +
                         std::to_string(max_bytes) + " bytes are read");
    if (size == 0) refuse(path, "the file is empty");
    std::ifstream in(path, std::ios::binary);
    std::string bytes(size, '\0');
    if (!in.read(bytes.data(), std::streamsize(size))) refuse(path, "the file cannot be read");
    return bytes;
}

// ---- OBJ: read here, because assimp gives every corner of every face a point of its own in an order of its own
// and keeps floats only ----------------------------------------------------------------------------------------

std::string_view next_word(std::string_view& line) {
    const size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return line = {};
    const size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

double obj_number(const std::string& path, std::string_view word, size_t line_number) {
    double value = 0;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
        refuse(path, "line " + std::to_string(line_number) + ": \"" + std::string(word.substr(0, 40)) +
                         "\" is not a coordinate");
    return value;
}

/// The first number of "7/2/3", counted from 1 or, when negative, back from the last point.
int obj_index(const std::string& path, std::string_view word, size_t points, size_t line_number) {
    long long value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool number = error == std::errc() && (end == word.data() + word.size() || *end == '/');
    const long long index = value < 0 ? value + (long long)(points) : value - 1;
    if (!number || value == 0 || index < 0 || index >= (long long)(points))
        refuse(path, "line " + std::to_string(line_number) + ": the face names point \"" +
                         std::string(word.substr(0, 40)) + "\", but " + std::to_string(points) +
                         " points are given before it");
    return int(index);
}

Polygons read_obj(const std::string& path, std::string_view bytes) {
    Polygons polygons;
    for (size_t number = 1; !bytes.empty(); ++number) {
        const size_t end = std::min(bytes.find('\n'), bytes.size());
        std::string_view line = bytes.substr(0, end);
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
        const std::string_view key = next_word(line);
        if (key == "v") {
            Vec3 p;
            for (double& coordinate : p) coordinate = obj_number(path, next_word(line), number);
            polygons.points.push_back(p);
        } else if (key == "f") {
            std::vector<int> face;
            for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
                face.push_back(obj_index(path, word, polygons.points.size(), number));
            if (face.size() >= 3) polygons.faces.push_back(std::move(face));
        }
    }
    return polygons;
}

// ---- everything else: assimp ---------------------------------------------------------------------------------

/// assimp falls back on guessing; a file that does not begin as its extension says is refused before that.
void expect_signature(const std::string& path, const std::string& extension, std::string_view bytes) {
    const bool fits = extension == "ply"   ? bytes.starts_with("ply")
                      : extension == "glb" ? bytes.starts_with("glTF")
                      : extension == "dae" ? bytes.substr(0, 4096).find("<COLLADA") != std::string_view::npos
                                           : bytes.size() >= 15;
    if (!fits) refuse(path, "this is not a mesh in the format that its name says (." + extension + ")");
}

void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Polygons& polygons) {
    const aiMatrix4x4 here = above * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
        const int first = int(polygons.points.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D p = here * mesh.mVertices[v];
            polygons.points.emplace_back(p.x, p.y, p.z);
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) continue;
            std::vector<int> corners;
            for (unsigned k = 0; k < face.mNumIndices; ++k) corners.push_back(first + int(face.mIndices[k]));
            polygons.faces.push_back(std::move(corners));
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], here, polygons);
}

Polygons read_by_assimp(const std::string& path, const std::string& extension, const std::string& bytes) {
    expect_signature(path, extension, bytes);
    Assimp::Importer importer;
    // Textures, lights, bones and animations are no part of a body's shape.
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                                aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS |
                                    aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_TEXTURES |
                                    aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_ANIMATIONS |
                                    aiComponent_BONEWEIGHTS | aiComponent_MATERIALS);
    // From memory, so that a file cannot make the reader open other files.
    const aiScene* scene =
        importer.ReadFileFromMemory(bytes.data(), bytes.size(),
                                    aiProcess_RemoveComponent | aiProcess_ValidateDataStructure, extension.c_str());
    if (!scene) refuse(path, std::string("this is not a mesh that can be read: ") + importer.GetErrorString());
    Polygons polygons;
    if (scene->mRootNode) append(*scene, *scene->mRootNode, aiMatrix4x4(), polygons);
    return polygons;
}

void expect_finite(const Points& points, const std::string& path) {
    for (size_t i = 0; i < points.size(); ++i)
        if (!points[i].allFinite())
            refuse(path, "point " + std::to_string(i + 1) + " is not finite (NaN or infinity)");
}

} // namespace

Polygons read_polygons(const std::string& path, std::uintmax_t max_bytes) {
    const std::string extension = extension_of(path);
    if (extension != "obj" && extension != "ply" && extension != "stl" && extension != "glb" && extension != "dae")
        refuse(path, "avatars are read from .obj, .ply, .stl, .glb and .dae files");
    const std::string bytes = read_bytes(path, max_bytes);
    Polygons polygons = extension == "obj" ? read_obj(path, bytes) : read_by_assimp(path, extension, bytes);
    if (polygons.faces.empty()) refuse(path, "there are no triangles in the file");
    expect_finite(polygons.points, path);
    return polygons;
}

} // namespace toile
