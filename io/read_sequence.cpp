// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_sequence.h"

#include "geometry/text.h"
#include "io/read_polygons.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>

namespace fs = std::filesystem;

namespace toile {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The number that a file's name ends in, its extension left aside.
std::optional<int> number_of(const std::string& file) {
    const std::string stem = fs::path(file).stem().string();
    std::size_t begin = stem.size();
    while (begin > 0 && is_digit(stem[begin - 1])) --begin;
    int number = 0;
    const auto [end, error] = std::from_chars(stem.data() + begin, stem.data() + stem.size(), number);
    if (begin == stem.size() || error != std::errc()) return std::nullopt;
    return number;
}

bool is_mesh(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return extension == ".obj" || extension == ".ply";
}

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.is_regular_file()) files.push_back(entry.path());
    if (error) throw InputError(folder.string() + ": the folder cannot be read");
    return files;
}

/// In the order of their numbers, none twice.
std::vector<std::string> in_order(const std::map<int, std::vector<std::string>>& numbered) {
    std::vector<std::string> files;
    for (const auto& [number, named] : numbered) {
        if (named.size() > 1) throw InputError(named[0] + " and " + named[1] + " are both frame " + std::to_string(number));
        files.push_back(named[0]);
    }
    return files;
}

std::vector<std::string> meshes_of(const std::string& folder) {
    std::map<int, std::vector<std::string>> numbered;
    std::vector<fs::path> files = files_in(folder);
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        if (!is_mesh(file)) continue;
        const auto number = number_of(file.string());
        if (!number) throw InputError(file.string() + ": the name does not end in the number of a frame");
        numbered[*number].push_back(file.string());
    }
    if (numbered.empty()) throw InputError(folder + ": there is no .obj or .ply file in the folder");
    return in_order(numbered);
}

/// Where "%d" or "%04d" is in a pattern, if anywhere.
struct Field {
    std::size_t at = 0, size = 0;
    int width = 0; ///< padded with zeros to so many digits
};

std::optional<Field> field_of(const std::string& pattern) {
    for (std::size_t at = pattern.find('%'); at != std::string::npos; at = pattern.find('%', at + 1)) {
        std::size_t end = at + 1;
        while (end < pattern.size() && is_digit(pattern[end])) ++end;
        if (end == pattern.size() || pattern[end] != 'd') continue;
        if (end > at + 1 && (pattern[at + 1] != '0' || end > at + 3)) continue;
        return Field{at, end + 1 - at, end > at + 2 ? pattern[at + 2] - '0' : 0};
    }
    return std::nullopt;
}

std::vector<std::string> files_like(const std::string& pattern, const Field& field) {
    const auto file_of = [&](int number) {
        return pattern.substr(0, field.at) + text("%0*d", field.width, number) + pattern.substr(field.at + field.size);
    };
    fs::path folder = fs::path(pattern).parent_path();
    if (folder.empty()) folder = ".";
    const std::string before = fs::path(pattern.substr(0, field.at)).filename().string();
    std::vector<int> numbers;
    for (const fs::path& file : files_in(folder)) {
        const std::string name = file.filename().string();
        int number = 0;
        if (!name.starts_with(before)) continue;
        const auto [end, error] = std::from_chars(name.data() + before.size(), name.data() + name.size(), number);
        if (error == std::errc() && fs::path(file_of(number)).filename() == name) numbers.push_back(number);
    }
    if (numbers.empty()) throw InputError(pattern + ": no file has such a name");
    std::sort(numbers.begin(), numbers.end());
    std::vector<std::string> files;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (numbers[k] != numbers[0] + int(k))
            throw InputError(pattern + ": frame " + std::to_string(numbers[0] + int(k)) + " is missing, before frame " +
                             std::to_string(numbers[k]));
        files.push_back(file_of(numbers[k]));
    }
    return files;
}

/// For every point of the body the one of the file that it was read from. Reading leaves points out, but keeps their
/// order.
std::vector<int> origins(const TriMesh& body, const Polygons& file, const AvatarAxes& axes) {
    std::vector<int> from;
    int next = 0;
    for (const Vec3& p : body.points) {
        while (in_metres(file.points.at(next), axes) != p) ++next;
        from.push_back(next++);
    }
    return from;
}

void expect_same_mesh(const std::string& path, int frame, const Polygons& mesh, const Polygons& first) {
    const auto refuse = [&](const std::string& what) {
        throw InputError(path + ": frame " + std::to_string(frame) + " is another mesh than the first: " + what);
    };
    if (mesh.points.size() != first.points.size())
        refuse(text("%zu points instead of %zu", mesh.points.size(), first.points.size()));
    if (mesh.faces.size() != first.faces.size())
        refuse(text("%zu faces instead of %zu", mesh.faces.size(), first.faces.size()));
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (mesh.faces[f] != first.faces[f]) refuse(text("face %zu has other corners", f + 1));
}

} // namespace

std::vector<std::string> sequence_files(const std::vector<std::string>& words) {
    if (words.size() != 1) return words;
    std::error_code error;
    if (fs::is_directory(words[0], error)) return meshes_of(words[0]);
    if (const auto field = field_of(words[0])) return files_like(words[0], *field);
    return words;
}

std::vector<int> frame_numbers(const std::vector<std::string>& files) {
    std::vector<int> numbers;
    for (const std::string& file : files) {
        const auto number = number_of(file);
        if (!number || (!numbers.empty() && *number <= numbers.back())) {
            numbers.clear();
            for (std::size_t k = 0; k < files.size(); ++k) numbers.push_back(int(k));
            break;
        }
        numbers.push_back(*number);
    }
    return numbers;
}

ReadSequence read_sequence(const std::vector<std::string>& files, const ReadAvatarOptions& options) {
    ReadAvatar avatar = read_avatar(files.at(0), options);
    const Polygons first = read_polygons(files[0], options.max_bytes);
    const std::vector<int> from = origins(avatar.body, first, avatar.axes);
    const std::vector<int> numbers = frame_numbers(files);
    ReadSequence sequence{std::move(avatar.body), {}, std::move(avatar.notes)};
    for (std::size_t k = 1; k < files.size(); ++k) {
        const Polygons mesh = read_polygons(files[k], options.max_bytes);
        expect_same_mesh(files[k], numbers[k], mesh, first);
        Points& frame = sequence.frames.emplace_back();
        for (const int i : from) frame.push_back(in_metres(mesh.points[i], avatar.axes));
    }
    return sequence;
}

} // namespace toile
