// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_file.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

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

std::FILE* open_neighbour(const std::string& path) {
    if (path.empty()) throw InputError("cannot write to a file without a name");
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) refuse(path, "it is a folder");
    // Renaming over a device would replace it by a file.
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
        refuse(path, "it is not a regular file");
    std::FILE* file = std::fopen(neighbour(path).c_str(), "wb");
    if (!file) refuse(path, std::strerror(errno));
    return file;
}

} // namespace

FileWriter::FileWriter(const std::string& path)
    : path_(path), part_(neighbour(path)), file_(open_neighbour(path)) {}

FileWriter::~FileWriter() {
    if (!file_) return;
    std::fclose(file_);
    std::error_code ignored;
    fs::remove(part_, ignored);
}

void FileWriter::write(std::string_view bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) refuse(path_, std::strerror(errno));
}

void FileWriter::commit() {
    if (std::fflush(file_) != 0) refuse(path_, std::strerror(errno));
    std::error_code failed;
    fs::rename(part_, target_of(path_), failed);
    if (failed) refuse(path_, failed.message());
    std::fclose(file_);
    file_ = nullptr;
}

void write_file(const std::string& path, std::string_view bytes) {
    FileWriter file(path);
    file.write(bytes);
    file.commit();
}

void check_writable(const std::string& path) { FileWriter{path}; }

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
