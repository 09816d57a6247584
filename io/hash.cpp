// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hash.h"

namespace toile {
namespace {

template <class T> std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

} // namespace

void Hash::add(std::string_view bytes) {
    for (const char c : bytes)
        state_ = (state_ ^ std::uint8_t(c)) * 0x100000001b3u;
}

std::string Hash::text() const {
    std::string out = "fnv1a64:";
    for (int shift = 60; shift >= 0; shift -= 4)
        out += "0123456789abcdef"[(state_ >> shift) & 15];
    return out;
}

std::string result_hash(const Garment& garment, const Points& x) {
    Hash hash;
    hash.add(bytes_of(x));
    hash.add(bytes_of(garment.triangles));
    hash.add(bytes_of(garment.node_of_vertex));
    return hash.text();
}

} // namespace toile
