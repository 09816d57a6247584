// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json.h"

#include <cmath>
#include <istream>
#include <set>
#include <sstream>

namespace toile {
namespace {

std::string megabytes(std::uintmax_t bytes) {
    std::ostringstream out;
    if (bytes < (1u << 20))
        out << bytes << " bytes";
    else
        out << (bytes + (1u << 19)) / (1u << 20) << " MB";
    return out.str();
}

std::string line_and_column(const std::string& text, std::size_t byte) {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
        ++column;
        if (text[i] == '\n') ++line, column = 1;
    }
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// The parser's own words without its error number and position, which the sentence gives in another form.
std::string reason(const nlohmann::json::exception& e) {
    std::string s = e.what();
    if (const auto end = s.find("] "); end != std::string::npos) s.erase(0, end + 2);
    if (s.rfind("parse error", 0) == 0)
        if (const auto colon = s.find(": "); colon != std::string::npos) s.erase(0, colon + 2);
    std::string clean;
    for (char c : s)
        clean += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    return clean;
}

/// Looks at the text before anything is built from it: a document within the limits is then parsed plainly.
/// (The parser's own callback would do, but makes it walk every array again for each of its members.)
class Guard : public nlohmann::json_sax<Json> {
public:
    Guard(const std::string& text, const std::string& name, const JsonLimits& limits)
        : text_(text), name_(name), limits_(limits) {}

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(number_integer_t) override { return count(); }
    bool number_unsigned(number_unsigned_t) override { return count(); }
    bool number_float(number_float_t, const string_t&) override { return count(); }
    bool string(string_t&) override { return count(); }
    bool binary(binary_t&) override { return count(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_array() override { return close(); }
    bool start_object(std::size_t) override { return open(); }
    bool end_object() override { return close(); }

    bool key(string_t& key) override {
        std::set<std::string>& keys = keys_.back();
        if (!keys.insert(key).second)
            throw InputError(name_ + " gives the key " + in_quotes(key) + " twice in one object");
        if (keys.size() > limits_.max_keys)
            throw InputError(name_ + " has an object of more than " + std::to_string(limits_.max_keys) +
                             " keys, the most that is read");
        return true;
    }

    bool parse_error(std::size_t byte, const std::string&, const nlohmann::detail::exception& e) override {
        throw InputError(name_ + " is not valid JSON at " + line_and_column(text_, byte) + ": " + reason(e));
    }

private:
    bool count() {
        if (++values_ > limits_.max_values)
            throw InputError(name_ + " holds more than " + std::to_string(limits_.max_values) +
                             " values, the most that is read");
        return true;
    }

    bool open() {
        keys_.emplace_back();
        if (int(keys_.size()) > limits_.max_depth)
            throw InputError(name_ + " is nested more than " + std::to_string(limits_.max_depth) +
                             " deep, which no pattern needs");
        return count();
    }

    bool close() {
        keys_.pop_back();
        return true;
    }

    const std::string& text_;
    const std::string& name_;
    const JsonLimits& limits_;
    std::size_t values_ = 0;
    std::vector<std::set<std::string>> keys_; ///< of the arrays and objects that are open
};

} // namespace

std::string read_text(std::istream& in, const std::string& name, std::uintmax_t max_bytes) {
    std::string text;
    char buffer[1 << 16];
    while (in.read(buffer, sizeof buffer), in.gcount() > 0) {
        text.append(buffer, std::size_t(in.gcount()));
        if (text.size() > max_bytes)
            throw InputError(name + " is larger than " + megabytes(max_bytes) + ", the most that is read");
    }
    if (in.bad()) throw InputError(name + " cannot be read to its end");
    return text;
}

Json parse_json(const std::string& text, const std::string& name, const JsonLimits& limits) {
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InputError(name + " is empty; JSON was expected");
    Guard guard(text, name, limits);
    Json::sax_parse(text, &guard);
    return Json::parse(text);
}

std::string in_quotes(const std::string& name) {
    constexpr std::size_t most = 60;
    std::string s = "\"";
    for (char c : name.substr(0, most))
        s += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    return s + (name.size() > most ? "...\"" : "\"");
}

std::string shown(const Json& value) {
    if (value.is_null()) return "null";
    if (value.is_string()) return in_quotes(value.get_ref<const std::string&>());
    if (value.is_object()) return "an object";
    if (value.is_array()) {
        const std::size_t n = value.size();
        return n == 0 ? "an empty array" : "an array of " + std::to_string(n);
    }
    return value.dump();
}

void JsonView::fail(const std::string& expected) const {
    throw InputError(place_ + " must be " + expected + ", but is " + shown(*value_));
}

bool JsonView::has(const char* key) const {
    const auto it = value_->find(key);
    return it != value_->end() && !it->is_null();
}

JsonView JsonView::at(const char* key) const {
    expect_object();
    const auto it = value_->find(key);
    if (it == value_->end()) throw InputError(place_ + " lacks the key \"" + key + "\"");
    return {*it, place_ + ", \"" + key + "\""};
}

JsonView JsonView::at(std::size_t index, const char* what) const {
    return {(*value_)[index], place_ + ", " + what + " " + std::to_string(index)};
}

void JsonView::expect_object() const {
    if (!value_->is_object()) fail("an object");
}

void JsonView::expect_array(std::size_t least, std::size_t most) const {
    if (value_->is_array() && value_->size() >= least && value_->size() <= most) return;
    if (least == 0 && most == SIZE_MAX) fail("an array");
    if (most == SIZE_MAX) fail("an array of at least " + std::to_string(least));
    if (least == most) fail("an array of " + std::to_string(least));
    fail("an array of " + std::to_string(least) + " to " + std::to_string(most));
}

void JsonView::expect_keys(std::initializer_list<const char*> keys) const {
    expect_object();
    for (const auto& [key, value] : value_->items()) {
        bool known = false;
        std::string list;
        for (const char* k : keys) {
            known = known || key == k;
            list += (list.empty() ? "" : ", ") + std::string(k);
        }
        if (!known)
            throw InputError(place_ + " has the unknown key " + in_quotes(key) + "; known are: " + list);
    }
}

double JsonView::number() const {
    if (!value_->is_number()) fail("a number");
    const double x = value_->get<double>();
    if (!std::isfinite(x)) fail("a finite number");
    return x;
}

double JsonView::number(double low, double high) const {
    const double x = number();
    if (x >= low && x <= high) return x;
    std::ostringstream range;
    range << "a number from " << low << " to " << high;
    fail(range.str());
}

int JsonView::integer(int low, int high) const {
    const double x = value_->is_number() ? value_->get<double>() : NAN;
    if (x >= low && x <= high && x == std::floor(x)) return int(x);
    fail("a whole number from " + std::to_string(low) + " to " + std::to_string(high));
}

bool JsonView::boolean() const {
    if (value_->is_boolean()) return value_->get<bool>();
    if (value_->is_number() && (*value_ == 0 || *value_ == 1)) return *value_ == 1;
    fail("true or false");
}

std::string JsonView::string() const {
    if (!value_->is_string()) fail("a string");
    return value_->get<std::string>();
}

} // namespace toile
