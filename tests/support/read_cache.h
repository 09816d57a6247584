// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Point caches and morph targets as another program would read them, by the formats' own words.

#include "geometry/types.h"
#include "io/write_file.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>

namespace toile::test {

struct ReadFrames {
    std::vector<double> times; ///< s
    std::vector<Points> frames;
};

/// Four bytes, the first of which is the highest or the lowest.
inline std::uint32_t word_at(const std::string& bytes, std::size_t at, bool high_first) {
    std::uint32_t w = 0;
    for (std::size_t k = 0; k < 4; ++k)
        w |= std::uint32_t(std::uint8_t(bytes.at(at + k))) << 8 * (high_first ? 3 - k : k);
    return w;
}

inline float float_at(const std::string& bytes, std::size_t at, bool high_first) {
    const std::uint32_t w = word_at(bytes, at, high_first);
    float f;
    std::memcpy(&f, &w, 4);
    return f;
}

inline std::vector<Points> points_at(const std::string& bytes, std::size_t at, std::size_t frames, std::size_t points,
                                     bool high_first) {
    REQUIRE(bytes.size() == at + 12 * frames * points);
    std::vector<Points> all(frames, Points(points));
    for (Points& frame : all)
        for (Vec3& p : frame)
            for (int k = 0; k < 3; ++k, at += 4) p[k] = float_at(bytes, at, high_first);
    return all;
}

/// 12 bytes of name, version 1, points, first frame, frames from sample to sample, samples: little-endian.
inline ReadFrames read_pc2(const std::string& path, double rate) {
    const std::string bytes = read_file(path, 1 << 28);
    REQUIRE(bytes.substr(0, 12) == std::string("POINTCACHE2\0", 12));
    REQUIRE(word_at(bytes, 12, false) == 1);
    const std::size_t points = word_at(bytes, 16, false), frames = word_at(bytes, 28, false);
    ReadFrames read;
    for (std::size_t k = 0; k < frames; ++k)
        read.times.push_back((float_at(bytes, 20, false) + double(k) * float_at(bytes, 24, false)) / rate);
    read.frames = points_at(bytes, 32, frames, points, false);
    return read;
}

/// Frames, points, the time of every frame, positions: big-endian.
inline ReadFrames read_mdd(const std::string& path) {
    const std::string bytes = read_file(path, 1 << 28);
    const std::size_t frames = word_at(bytes, 0, true), points = word_at(bytes, 4, true);
    ReadFrames read;
    for (std::size_t k = 0; k < frames; ++k) read.times.push_back(float_at(bytes, 8 + 4 * k, true));
    read.frames = points_at(bytes, 8 + 4 * frames, frames, points, true);
    return read;
}

/// A GLB's animation, played at the times of its keys: the places of every vertex, mesh after mesh, and its `_NODE`.
struct PlayedGlb {
    ReadFrames vertices;
    std::vector<int> node;
};

class GlbFile {
public:
    explicit GlbFile(const std::string& path) {
        const std::string bytes = read_file(path, 1 << 28);
        const std::size_t length = word_at(bytes, 12, false);
        gltf = nlohmann::json::parse(bytes.substr(20, length));
        binary = bytes.substr(20 + length + 8);
    }

    std::vector<float> floats(std::size_t accessor) const {
        const auto& a = gltf["accessors"][accessor];
        REQUIRE(a["componentType"] == 5126);
        const auto& view = gltf["bufferViews"][a["bufferView"].get<std::size_t>()];
        const std::size_t size = a["type"] == "VEC3" ? 3 : 1, count = size * a["count"].get<std::size_t>();
        REQUIRE(view["byteLength"] == 4 * count);
        std::vector<float> out;
        for (std::size_t k = 0; k < count; ++k) out.push_back(float_at(binary, view["byteOffset"].get<std::size_t>() + 4 * k, false));
        return out;
    }

    /// At the time of a key, or half way to the next.
    PlayedGlb play(bool half_way = false) const {
        const auto& animation = gltf["animations"][0];
        const auto& sampler = animation["samplers"][0];
        REQUIRE(sampler["interpolation"] == "LINEAR");
        const std::vector<float> times = floats(sampler["input"]), weights = floats(sampler["output"]);
        PlayedGlb played;
        const std::size_t shapes = weights.size() / times.size();
        for (std::size_t k = 0; k + half_way < times.size(); ++k) {
            std::vector<double> w(weights.begin() + k * shapes, weights.begin() + (k + 1) * shapes);
            double time = times[k];
            if (half_way) {
                for (std::size_t s = 0; s < shapes; ++s) w[s] = 0.5 * (w[s] + weights[(k + 1) * shapes + s]);
                time = 0.5 * (time + times[k + 1]);
            }
            played.vertices.times.push_back(time);
            played.vertices.frames.push_back(shape(animation, w));
        }
        for (const auto& channel : animation["channels"])
            for (const float n : floats(primitive(channel)["attributes"]["_NODE"])) played.node.push_back(int(n));
        return played;
    }

    nlohmann::json gltf;
    std::string binary;

private:
    const nlohmann::json& primitive(const nlohmann::json& channel) const {
        REQUIRE(channel["target"]["path"] == "weights");
        return gltf["meshes"][gltf["nodes"][channel["target"]["node"].get<std::size_t>()]["mesh"].get<std::size_t>()]["primitives"][0];
    }

    Points shape(const nlohmann::json& animation, const std::vector<double>& weights) const {
        Points all;
        for (const auto& channel : animation["channels"]) {
            const auto& p = primitive(channel);
            REQUIRE(p["targets"].size() == weights.size());
            const std::vector<float> base = floats(p["attributes"]["POSITION"]);
            std::vector<double> at(base.begin(), base.end());
            for (std::size_t s = 0; s < weights.size(); ++s) {
                if (weights[s] == 0) continue;
                const std::vector<float> moved = floats(p["targets"][s]["POSITION"]);
                REQUIRE(moved.size() == at.size());
                for (std::size_t k = 0; k < at.size(); ++k) at[k] += weights[s] * moved[k];
            }
            for (std::size_t k = 0; k < at.size(); k += 3) all.emplace_back(at[k], at[k + 1], at[k + 2]);
        }
        return all;
    }
};

/// Farthest that a point lies from where it is in the other frames.
inline double farthest(const std::vector<Points>& a, const std::vector<Points>& b) {
    REQUIRE(a.size() == b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        REQUIRE(a[k].size() == b[k].size());
        for (std::size_t i = 0; i < a[k].size(); ++i) most = std::max(most, (a[k][i] - b[k][i]).norm());
    }
    return most;
}

} // namespace toile::test
