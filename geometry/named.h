// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace toile {

/// The one of `all` that to_string() calls `name`. Throws std::invalid_argument, "there is no METHOD 'name', the METHODS are ..."
/// with `what` and `many` in their places.
template <class All>
auto named(const std::string& name, const All& all, const std::string& what, const std::string& many) {
    std::string names;
    for (const auto one : all) {
        if (name == to_string(one)) return one;
        names += (names.empty() ? "" : ", ") + std::string(to_string(one));
    }
    throw std::invalid_argument("there is no " + what + " '" + name + "', the " + many + " are " + names);
}

} // namespace toile
