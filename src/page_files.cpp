// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/page_files.h"

#include "io/write_file.h"
#include "src/file_name.h"

#include <filesystem>

namespace toile {

std::vector<std::string> write_page(const std::string& page, const PageFiles& files) {
    const std::filesystem::path path(page);
    const std::string stem = (path.parent_path() / path.stem()).string();
    std::vector<std::string> written;
    const auto write = [&written](const std::string& file, const std::string& bytes) {
        write_file(file, bytes);
        written.push_back(file);
    };
    write(page, files.html);
    write(stem + ".csv", files.csv);
    write(stem + ".json", files.json);
    for (const PageFiles::Picture& p : files.pictures) write(stem + "-" + file_name(p.name) + ".svg", p.svg);
    return written;
}

} // namespace toile
