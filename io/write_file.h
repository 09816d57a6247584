// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/read_pattern.h"

#include <cstdio>
#include <string>
#include <string_view>

namespace toile {

/// Writes the bytes beside the target and renames them over it, so that a reader never sees half a file and a
/// failure leaves what was there. Throws InputError when the target cannot be written.
void write_file(const std::string& path, std::string_view bytes);

/// The same for files that are too large to be made in memory first: bytes go beside the target as they come, and commit()
/// renames them over it. Without it nothing is left behind. All throw InputError when the target cannot be written.
class FileWriter {
public:
    explicit FileWriter(const std::string& path);
    ~FileWriter();
    FileWriter(const FileWriter&) = delete;

    void write(std::string_view bytes);
    void commit();

private:
    std::string path_, part_;
    std::FILE* file_;
};

/// Throws InputError when write_file(path) could not succeed: no such folder, no permission, a folder in its
/// place. Leaves nothing behind.
void check_writable(const std::string& path);

/// The whole file. Throws InputError when it cannot be read or is larger than `max_bytes`.
std::string read_file(const std::string& path, std::uintmax_t max_bytes);

} // namespace toile
