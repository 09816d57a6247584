// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "draping/inspect.h"
#include "geometry/text.h"
#include "io/read_garment.h"
#include "io/report.h"
#include "src/quantity.h"
#include "src/options.h"
#include "src/pipeline.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

struct InspectArguments {
    std::string garment, avatar, fabric;
    bool repair_avatar = false, json = false;
};

Json to_json(const Inspection& i) {
    Json json{
        {"panels", i.panels},
        {"vertices", i.vertices},
        {"nodes", i.nodes},
        {"triangles", i.triangles},
        {"pieces", i.pieces},
        {"border_loops", i.border_loops},
        {"joined_nodes", i.joined_nodes},
        {"crowded_edges", i.crowded_edges},
        {"turned_edges", i.turned_edges},
        {"flat_triangles", i.flat_triangles},
        {"not_finite", i.not_finite},
        {"area", i.area},
        {"mean_edge", i.mean_edge},
        {"seam_gap_max", i.seam_gap_max},
        {"intersections",
         {{"cloth_avatar", i.intersections.cloth_avatar}, {"cloth_cloth", i.intersections.cloth_cloth}}}};
    if (i.has_body) json["clearance_min"] = i.clearance;
    if (!i.has_pattern) return json;
    json["strain"] = strain_json(i.strain);
    json["developability"] = {{"angle_defect_mean", i.developability.angle_defect_mean},
                              {"angle_defect_max", i.developability.angle_defect_max}};
    return json;
}

std::string row(const char* name, const Spread& s, double scale, const char* unit, double limit) {
    std::string line = text("  %-10s%8.3f to%8.3f, mean%8.3f, 99 %% within%8.3f %s", name, scale * s.min,
                            scale * s.max, scale * s.mean, scale * s.p99, unit);
    if (limit > 0) line += text(" (limit %.3g)", scale * limit);
    return line + '\n';
}

void print(std::ostream& out, const Inspection& i) {
    out << i.panels << " panels, " << i.triangles << " triangles, " << i.vertices << " vertices, " << i.nodes
        << " nodes, mean edge " << show_length(i.mean_edge) << "\n"
        << i.pieces << (i.pieces == 1 ? " connected piece, " : " connected pieces, ") << i.border_loops
        << " borders; " << i.crowded_edges << " edges of more than two triangles, " << i.turned_edges
        << " edges across which the side turns, " << i.flat_triangles << " triangles without area\n";
    out << "seams: " << (i.seam_gap_max == 0 ? "closed" : "open by up to " + show_length(i.seam_gap_max))
        << '\n';
    out << "intersections: ";
    if (i.has_body) out << i.intersections.cloth_avatar << " with the body, ";
    out << i.intersections.cloth_cloth << " of the cloth with itself\n";
    if (i.has_body) out << "clearance: " << show_length(i.clearance) << '\n';
    if (!i.has_pattern) {
        out << "no strain: the file has no texture coordinates that are the pattern\n";
        return;
    }
    const StrainMeasure& s = i.strain;
    out << "strain:\n"
        << row("warp", s.warp, 100, "%", s.limit_warp) << row("weft", s.weft, 100, "%", s.limit_weft)
        << row("principal", s.principal, 100, "%", 0)
        << row("shear", s.shear, 180 / EIGEN_PI, "degrees", s.limit_shear);
    out << text("compressed by more than 2 %%: %.2f %% of the area off eased seams\n", 100 * s.compressed_area)
        << text("angle defect: mean %.4f, largest %.4f rad\n", i.developability.angle_defect_mean,
                i.developability.angle_defect_max);
}

TriMesh body_of(const InspectArguments& a, const ReadGarment& garment, std::vector<std::string>& notes) {
    if (a.avatar.empty()) return garment.avatar;
    Body read = read_body(a.avatar, {}, a.repair_avatar);
    notes.insert(notes.end(), read.notes.begin(), read.notes.end());
    return std::move(read.mesh);
}

int inspect_command(const InspectArguments& a, const Console& console) {
    const ReadGarment read = read_garment(a.garment);
    std::vector<std::string> notes = read.notes;
    const TriMesh body = body_of(a, read, notes);
    PanelFabrics fabrics;
    if (!a.fabric.empty()) fabrics.assign(read.garment.panel_names.size(), fabric_preset(a.fabric));
    const Inspection inspection = inspect(read.garment, read.x, body, fabrics);
    if (a.json) {
        Json json = to_json(inspection);
        json["notes"] = notes;
        console.out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    } else {
        for (const std::string& note : notes)
            console.err << "note: " << note << '\n';
        print(console.out, inspection);
    }
    console.out << std::flush;
    return exit_made;
}

} // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("inspect", "Check any garment mesh, ours or another tool's");
    const auto a = std::make_shared<InspectArguments>();
    command.add_option("garment", a->garment, "Garment file, .obj or .glb")->required()->type_name("FILE");
    command.add_option("--avatar", a->avatar, "Body it lies on (default: the one in the file, if any)")
        ->type_name("FILE");
    command.add_flag("--repair-avatar", a->repair_avatar, "Close the holes of a leaky body");
    add_fabric(command, a->fabric, "Fabric whose limits to show");
    command.add_flag("--json", a->json, "Print JSON, in SI units");
    command.callback(
        [a, &chosen] { chosen = [a](const Console& console) { return inspect_command(*a, console); }; });
}

} // namespace toile
