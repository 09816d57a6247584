// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/garment.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace toile {

/// FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923): tells results apart, not a guard against forgery.
class Hash {
public:
    void add(std::string_view bytes);
    /// "fnv1a64:" and 16 hexadecimal digits.
    std::string text() const;

private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// Of the drape as it is written: node positions, triangles and the nodes of their vertices, to the last bit.
std::string result_hash(const Garment& garment, const Points& x);

} // namespace toile
