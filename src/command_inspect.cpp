// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "draping/inspect.h"
#include "geometry/text.h"
#include "io/read_fabric.h"
#include "io/read_garment.h"
#include "io/report.h"
#include "src/quantity.h"
#include "src/options.h"
#include "src/pipeline.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <ostream>

namespace toile {
namespace {

constexpr std::size_t listed = 5; // places of crossings, and seams

struct InspectArguments {
    std::string garment, avatar, fabric;
    bool repair_avatar = false, json = false;
};

std::string row(const char* name, const Spread& s, double scale, const char* unit, double limit) {
    std::string line = text("  %-10s%8.3f to%8.3f, mean%8.3f, 99 %% within%8.3f %s", name, scale * s.min,
                            scale * s.max, scale * s.mean, scale * s.p99, unit);
    if (limit > 0) line += text(" (limit %.3g)", scale * limit);
    return line + '\n';
}

std::string place(const Vec3& p) {
    return text("(%.3f, %.3f, %.3f) m", p.x(), p.y(), p.z());
}

/// What is beyond the list's end.
void print_rest(std::ostream& out, std::size_t all, const char* what) {
    if (all > listed) out << "  and " << all - listed << " more " << what << "; --json has all\n";
}

void print_crossings(std::ostream& out, const Inspection& i, const Garment& garment) {
    for (std::size_t k = 0; k < std::min(listed, i.crossings.size()); ++k) {
        const Crossing& c = i.crossings[k];
        out << "  " << c.pairs.size() << (c.pairs.size() == 1 ? " pair" : " pairs") << " at " << place(c.at) << ": panel";
        for (const int p : c.panels)
            out << " \"" << garment.panel_names[p] << '"';
        out << (c.with_body ? " and the body" : "") << ", triangles " << c.pairs[0][0] << " and " << c.pairs[0][1]
            << (c.pairs.size() == 1 ? "\n" : " first\n");
    }
    print_rest(out, i.crossings.size(), "places");
}

void print_inside(std::ostream& out, const Inspection& i, const Garment& garment) {
    if (!i.inside.known)
        out << "in the body: not known, the body is not closed\n";
    else if (i.inside.nodes == 0)
        out << "in the body: no node\n";
    else
        out << "in the body: " << i.inside.nodes << (i.inside.nodes == 1 ? " node" : " nodes") << ", the deepest by "
            << show_length(i.inside.depth) << " on panel \"" << garment.panel_names[i.inside.panel] << "\" at "
            << place(i.inside.at) << '\n';
}

void print_gaps(std::ostream& out, const Inspection& i, const Garment& garment) {
    for (std::size_t k = 0; k < std::min(listed, i.gaps.size()); ++k) {
        const SeamGap& g = i.gaps[k];
        out << "  " << show_length(g.gap) << " between panels \"" << garment.panel_names[g.panels[0]] << "\" and \""
            << garment.panel_names[g.panels[1]] << "\" at " << place(g.at) << ", " << g.open << " of " << g.stitches
            << " stitches open\n";
    }
    print_rest(out, i.gaps.size(), "seams");
}

void print(std::ostream& out, const Inspection& i, const Garment& garment) {
    out << i.panels << " panels, " << i.triangles << " triangles, " << i.vertices << " vertices, " << i.nodes
        << " nodes, mean edge " << show_length(i.mean_edge) << "\n"
        << i.pieces << (i.pieces == 1 ? " connected piece, " : " connected pieces, ") << i.border_loops
        << " borders; " << i.crowded_edges << " edges of more than two triangles, " << i.turned_edges
        << " edges across which the side turns, " << i.flat_triangles << " triangles without area\n";
    out << "seams: " << (i.seam_gap_max == 0 ? "closed" : "open by up to " + show_length(i.seam_gap_max))
        << '\n';
    print_gaps(out, i, garment);
    out << "intersections: ";
    if (i.has_body) out << i.intersections.cloth_avatar << " with the body, ";
    out << i.intersections.cloth_cloth << " of the cloth with itself\n";
    print_crossings(out, i, garment);
    if (i.has_body) {
        print_inside(out, i, garment);
        out << "clearance: " << show_length(i.clearance) << '\n';
    }
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
    if (!a.fabric.empty()) fabrics.assign(read.garment.panel_names.size(), fabric_called(a.fabric));
    const Inspection inspection = inspect(read.garment, read.x, body, fabrics);
    if (a.json) {
        nlohmann::ordered_json json = inspection_json(inspection, read.garment);
        json["notes"] = notes;
        console.out << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    } else {
        for (const std::string& note : notes)
            console.err << "note: " << note << '\n';
        print(console.out, inspection, read.garment);
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
