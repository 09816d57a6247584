// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_garment.h"

#include "io/garment_glb.h"
#include "io/garment_obj.h"
#include "io/write_file.h"

#include <algorithm>
#include <filesystem>

namespace fs = std::filesystem;

namespace toile {
namespace {

constexpr std::uintmax_t max_bytes = std::uintmax_t(1) << 30;

// Not inlined: GCC 12.2 drops the rounding where it vectorises double -> float -> double.
[[gnu::noinline]] double nearest_float(double value) {
    return double(float(value));
}

std::string mtl_beside(const std::string& path) {
    return fs::path(path).replace_extension(".mtl").string();
}

} // namespace

GarmentFormat garment_format(const std::string& path) {
    std::string ending = fs::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (ending == ".obj") return GarmentFormat::obj;
    if (ending == ".glb") return GarmentFormat::glb;
    throw InputError(path + ": a garment file ends in .obj or .glb, not in '" + ending + "'");
}

std::vector<std::string> garment_files(const std::string& path) {
    if (garment_format(path) == GarmentFormat::glb) return {path};
    return {path, mtl_beside(path)};
}

void write_garment(const std::string& path, const Garment& garment, const Points& x,
                   const WriteOptions& options) {
    if (garment_format(path) == GarmentFormat::glb) {
        write_file(path, garment_glb(garment, x, options));
        return;
    }
    const std::string mtl = mtl_beside(path);
    write_file(mtl, garment_mtl(garment, options));
    write_file(path, garment_obj(garment, x, options, fs::path(mtl).filename().string()));
}

double animation_bytes(const Garment& garment, int frames) {
    // Position and normal of every vertex, a weight for every pair of frames, and what the JSON says of each frame.
    return frames * (24.0 * double(garment.uv.size()) + 4.0 * frames + 500.0 * double(garment.panel_names.size()));
}

std::vector<std::string> moved_files(const std::string& path, const std::string& from) {
    if (garment_format(path) == garment_format(from)) return {path};
    return garment_files(path);
}

void write_moved(const std::string& path, const std::string& from, const ReadGarment& read, const Points& x) {
    WriteOptions options;
    options.metres_per_unit = read.metres_per_unit;
    options.z_up = read.z_up;
    if (garment_format(path) != garment_format(from)) {
        if (!read.avatar.triangles.empty()) options.avatar = &read.avatar;
        write_garment(path, read.garment, x, options);
        return;
    }
    std::map<int, Vec3> moved;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (x[i] != read.x[i]) moved[read.file_node[i]] = x[i];
    const std::string bytes = read_file(from, max_bytes);
    write_file(path, garment_format(path) == GarmentFormat::glb ? moved_glb(bytes, from, moved)
                                                                : moved_obj(bytes, from, moved, options));
}

void write_mesh(const std::string& path, const TriMesh& mesh, const WriteOptions& options) {
    write_file(path, mesh_obj(mesh, options));
}

Points rounded_to_float(const Points& x) {
    Points rounded;
    rounded.reserve(x.size());
    for (const Vec3& p : x)
        rounded.emplace_back(nearest_float(p.x()), nearest_float(p.y()), nearest_float(p.z()));
    return rounded;
}

} // namespace toile
