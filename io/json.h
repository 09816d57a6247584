// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// JSON from strangers: read under limits, and looked at through a view that knows where it is, so that every
// complaint names the place.

#include "io/input_error.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <string>

namespace toile {

using Json = nlohmann::ordered_json; ///< keeps the file's order of keys

struct JsonLimits {
    std::uintmax_t max_bytes = 64u << 20;
    int max_depth = 64; ///< arrays and objects inside each other
    std::size_t max_values = 5'000'000;
    std::size_t max_keys = 10'000; ///< in one object
};

/// The whole stream. Throws InputError when it cannot be read or is larger than max_bytes.
std::string read_text(std::istream& in, const std::string& name, std::uintmax_t max_bytes);

/// Parses `text`; `name` is what messages call it. Throws InputError: empty, not JSON (with line and column),
/// beyond a limit, a key given twice.
Json parse_json(const std::string& text, const std::string& name, const JsonLimits& limits = {});

/// A value and where it stands ("tee.json: panel \"front\", edge 3"). Every accessor throws InputError with
/// the place, the key, what was expected and what was found.
class JsonView {
public:
    JsonView(const Json& value, std::string place) : value_(&value), place_(std::move(place)) {}

    const Json& value() const { return *value_; }
    const std::string& place() const { return place_; }

    bool has(const char* key) const; ///< present and not null
    /// The member, called by its key in messages.
    JsonView at(const char* key) const;
    /// The member of an array, called `what` and its index.
    JsonView at(std::size_t index, const char* what) const;
    /// Any value below this one under a place of its own.
    JsonView below(const Json& value, const std::string& what) const { return {value, place_ + ", " + what}; }

    void expect_object() const;
    /// An array of at least `least` and at most `most` members.
    void expect_array(std::size_t least = 0, std::size_t most = SIZE_MAX) const;
    /// Refuses members other than these.
    void expect_keys(std::initializer_list<const char*> keys) const;

    double number() const;                        ///< finite
    double number(double low, double high) const; ///< in [low, high]
    int integer(int low, int high) const;         ///< in [low, high]
    bool boolean() const;                         ///< true, false, 0 or 1
    std::string string() const;

    [[noreturn]] void
    fail(const std::string& expected) const; ///< "<place> must be <expected>, but is <value>"

private:
    const Json* value_;
    std::string place_;
};

/// A value for a message: short, on one line.
std::string shown(const Json& value);
/// A name from a file in quotes: cut when long, without control characters.
std::string in_quotes(const std::string& name);

} // namespace toile
