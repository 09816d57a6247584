// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/point_cache.h"

#include "io/write_file.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>

namespace toile {
namespace {

template <class T>
void append(std::string& out, T value, std::endian order) {
    static_assert(sizeof(T) == 4);
    auto bytes = std::bit_cast<std::array<char, 4>>(value);
    if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    out.append(bytes.data(), 4);
}

void write_frames(FileWriter& file, const PointFrames& points, const WriteOptions& options, std::endian order) {
    std::string bytes;
    for (const Points& frame : points.frames) {
        bytes.clear();
        for (const Vec3& p : frame)
            for (const double c : in_obj(p, options)) append(bytes, float(c), order);
        file.write(bytes);
    }
}

} // namespace

void write_pc2(const std::string& path, const PointFrames& points, const WriteOptions& options) {
    constexpr auto order = std::endian::little;
    std::string header("POINTCACHE2\0", 12);
    append(header, std::int32_t(1), order); // version
    append(header, std::int32_t(points.frames[0].size()), order);
    append(header, 0.0f, order); // first frame
    append(header, 1.0f, order); // frames from sample to sample
    append(header, std::int32_t(points.frames.size()), order);
    FileWriter file(path);
    file.write(header);
    write_frames(file, points, options, order);
    file.commit();
}

void write_mdd(const std::string& path, const PointFrames& points, const WriteOptions& options) {
    constexpr auto order = std::endian::big;
    std::string header;
    append(header, std::int32_t(points.frames.size()), order);
    append(header, std::int32_t(points.frames[0].size()), order);
    for (std::size_t k = 0; k < points.frames.size(); ++k) append(header, float(double(k) / points.rate), order); // s
    FileWriter file(path);
    file.write(header);
    write_frames(file, points, options, order);
    file.commit();
}

std::vector<std::string> cache_files(const std::string& garment) {
    const std::filesystem::path p(garment);
    auto pc2 = p, mdd = p;
    return {pc2.replace_extension(".pc2").string(), mdd.replace_extension(".mdd").string()};
}

void write_caches(const std::string& garment, const PointFrames& points, const WriteOptions& options) {
    const std::vector<std::string> files = cache_files(garment);
    write_pc2(files[0], points, options);
    write_mdd(files[1], points, options);
}

} // namespace toile
