// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "draping/compare.h"
#include "geometry/text.h"
#include "io/read_garment.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct CompareArguments {
    std::string a, b;
    bool json = false;
};

TriMesh cloth_of(const std::string& path) {
    ReadGarment read = read_garment(path);
    return {std::move(read.x), node_triangles(read.garment)};
}

int compare_command(const CompareArguments& arguments, const Console& console) {
    const Comparison c = compare(cloth_of(arguments.a), cloth_of(arguments.b));
    if (arguments.json) {
        console.out << nlohmann::ordered_json{{"rms", c.rms},
                                              {"mean", c.mean},
                                              {"max", c.max},
                                              {"where", {c.where.x(), c.where.y(), c.where.z()}},
                                              {"same_triangles", c.same_triangles}}
                           .dump(2)
                    << std::endl;
        return exit_made;
    }
    console.out << text("RMS %.4f mm, mean %.4f mm, max %.4f mm at (%.3f, %.3f, %.3f) m", 1000 * c.rms,
                        1000 * c.mean, 1000 * c.max, c.where.x(), c.where.y(), c.where.z())
                << (c.same_triangles ? "; point by point" : "; surface to surface") << std::endl;
    return exit_made;
}

} // namespace

void add_compare(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("compare", "Say how far apart two drapes are");
    const auto a = std::make_shared<CompareArguments>();
    command.add_option("a", a->a, "Garment file, .obj or .glb")->required()->type_name("FILE");
    command.add_option("b", a->b, "Garment file, .obj or .glb")->required()->type_name("FILE");
    command.add_flag("--json", a->json, "Print JSON, in metres");
    command.callback(
        [a, &chosen] { chosen = [a](const Console& console) { return compare_command(*a, console); }; });
}

} // namespace toile
