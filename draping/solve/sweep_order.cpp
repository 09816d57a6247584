// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/sweep_order.h"

#include <stdexcept>

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
    std::string names;
    for (const SweepOrder order :
         {SweepOrder::listed, SweepOrder::reversed, SweepOrder::longest_first, SweepOrder::from_top}) {
        if (name == to_string(order)) return order;
        names += (names.empty() ? "" : ", ") + std::string(to_string(order));
    }
    throw std::invalid_argument("there is no order of a sweep '" + name + "', the orders are " + names);
}

} // namespace toile
