// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/sweep_order.h"

#include "geometry/named.h"

#include <array>

namespace toile {

const char* to_string(SweepOrder order) {
    switch (order) {
    case SweepOrder::listed: return "listed";
    case SweepOrder::reversed: return "reversed";
    case SweepOrder::longest_first: return "longest-first";
    case SweepOrder::from_top: return "from-top";
    }
    return "listed";
}

SweepOrder sweep_order(const std::string& name) {
    return named(name, std::array{SweepOrder::listed, SweepOrder::reversed, SweepOrder::longest_first, SweepOrder::from_top},
                 "order of a sweep", "orders");
}

} // namespace toile
