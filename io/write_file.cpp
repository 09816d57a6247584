// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_file.h"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include <unistd.h>

namespace fs = std::filesystem;

namespace toile {
namespace {

// A link keeps pointing where it points: what it names is replaced, not the link.
std::string target_of(const std::string& path) {
    std::error_code failed;
    const fs::path target =
        fs::is_symlink(path, failed) ? fs::weakly_canonical(path, failed) : fs::path(path);
    return failed ? path : target.string();
}

std::string neighbour(const std::string& path) {
    return target_of(path) + ".part" + std::to_string(getpid());
}

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw InputError("cannot write " + path + ": " + why);
}

struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, Close>;

File open_neighbour(const std::string& path) {
    if (path.empty()) throw InputError("cannot write to a file without a name");
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) refuse(path, "it is a folder");
    // Renaming over a device would replace it by a file.
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
        refuse(path, "it is not a regular file");
    File file(std::fopen(neighbour(path).c_str(), "wb"));
    if (!file) refuse(path, std::strerror(errno));
    return file;
}

} // namespace

void write_file(const std::string& path, std::string_view bytes) {
    File file = open_neighbour(path);
    const std::string part = neighbour(path);
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    const bool flushed = std::fflush(file.get()) == 0;
    std::string why = written && flushed ? "" : std::strerror(errno);
    file.reset();
    std::error_code failed;
    if (why.empty()) fs::rename(part, target_of(path), failed);
    if (failed) why = failed.message();
    if (why.empty()) return;
    fs::remove(part, failed);
    refuse(path, why);
}

void check_writable(const std::string& path) {
    open_neighbour(path).reset();
    std::error_code ignored;
    fs::remove(neighbour(path), ignored);
}

std::string read_file(const std::string& path, std::uintmax_t max_bytes) {
    std::error_code failed;
    if (fs::is_directory(path, failed)) throw InputError(path + " is a folder, expected a file");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw InputError("cannot read " + path + ": " + std::strerror(errno));
    std::string bytes;
    char chunk[1 << 16];
    while (in.read(chunk, sizeof chunk) || in.gcount() > 0) {
        bytes.append(chunk, std::size_t(in.gcount()));
        if (bytes.size() > max_bytes)
            throw InputError(path + " is larger than the " + std::to_string(max_bytes) +
                             " bytes that are read");
    }
    return bytes;
}

} // namespace toile
