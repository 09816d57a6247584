// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/garment_obj.h"

#include "io/colours.h"
#include "io/uv_layout.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace toile {
namespace {

// ---- writing
// ------------------------------------------------------------------------------------------------

/// The shortest decimals that read back as the same double.
void append(std::string& out, double value) {
    char digits[32];
    out.append(digits,
               std::to_chars(digits, digits + sizeof digits, value + 0.0).ptr); // + 0.0: no minus zero
}

void append_points(std::string& out, const Points& x, const WriteOptions& options) {
    for (const Vec3& p : x) {
        const Vec3 q = in_obj(p, options);
        out += 'v';
        for (int k = 0; k < 3; ++k)
            append(out += ' ', q[k]);
        out += '\n';
    }
}

void append_header(std::string& out, const WriteOptions& options) {
    out += "# toile " TOILE_VERSION "\n# metres_per_unit ";
    append(out, options.metres_per_unit);
    out += options.z_up ? "\n# up z\n" : "\n# up y\n";
}

void append_texture(std::string& out, const Garment& g, const std::vector<std::string>& names) {
    const UvLayout layout = lay_out_panels(g);
    append(out += "# uv_metres ", layout.scale);
    out += '\n';
    for (std::size_t p = 0; p < names.size(); ++p) {
        append(out += "# uv_origin " + names[p] + ' ', layout.origin[p].x());
        append(out += ' ', layout.origin[p].y());
        out += '\n';
    }
    for (std::size_t v = 0; v < g.uv.size(); ++v) {
        const Vec2 t = texture_coordinates(g, layout, int(v));
        append(out += "vt ", t.x());
        append(out += ' ', t.y());
        out += '\n';
    }
}

void append_panels(std::string& out, const Garment& g, const std::vector<std::string>& names) {
    for (std::size_t p = 0; p < names.size(); ++p) {
        out += "g " + names[p] + "\nusemtl " + names[p] + '\n';
        for (std::size_t t = 0; t < g.triangles.size(); ++t) {
            if (g.panel_of_triangle[t] != int(p)) continue;
            out += 'f';
            for (const int v : g.triangles[t])
                out +=
                    ' ' + std::to_string(g.node_of_vertex[std::size_t(v)] + 1) + '/' + std::to_string(v + 1);
            out += '\n';
        }
    }
}

void append_stitches(std::string& out, const Garment& g) {
    for (const Stitch& s : g.stitches) {
        out += "stitch " + std::to_string(s.a) + ' ' + std::to_string(s.b[0]) + ' ' + std::to_string(s.b[1]) +
               ' ';
        append(out, s.r);
        out += '\n';
    }
}

void append_mesh(std::string& out, const TriMesh& mesh, int nodes_before, const WriteOptions& options) {
    append_points(out, mesh.points, options);
    for (const Triangle& t : mesh.triangles) {
        out += 'f';
        for (const int v : t)
            out += ' ' + std::to_string(v + 1 + nodes_before);
        out += '\n';
    }
}

void append_material(std::string& out, const std::string& name, const Vec3& colour) {
    out += "newmtl " + name + "\nKd";
    for (int k = 0; k < 3; ++k)
        append(out += ' ', std::round(srgb(colour[k]) * 1e4) / 1e4);
    out += "\nKs 0 0 0\nillum 1\n";
}

// ---- reading
// ------------------------------------------------------------------------------------------------

struct Reader {
    GarmentParts parts;
    std::string name;
    int line = 0;
    bool in_avatar = false;
    std::string panel = "garment";
    std::vector<std::array<int, 3>> avatar_faces; ///< over parts.nodes

    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError(name + ", line " + std::to_string(line) + ": " + what);
    }

    static std::string_view word(std::string_view& rest) {
        const auto begin = std::min(rest.find_first_not_of(" \t\r"), rest.size());
        rest.remove_prefix(begin);
        const auto end = std::min(rest.find_first_of(" \t\r"), rest.size());
        const std::string_view result = rest.substr(0, end);
        rest.remove_prefix(end);
        return result;
    }

    double number(std::string_view& rest) const {
        std::string_view text = word(rest);
        if (text.starts_with('+')) text.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
            refuse("'" + std::string(text.substr(0, 40)) + "' is not a finite number");
        return value;
    }

    int integer(std::string_view text) const {
        int value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size())
            refuse("'" + std::string(text.substr(0, 40)) + "' is not an index");
        return value;
    }

    /// OBJ counts from 1, or backwards from the end with negative numbers.
    int index(std::string_view text, std::size_t count) const {
        const int i = integer(text);
        const int k = i < 0 ? int(count) + i : i - 1;
        if (i == 0 || k < 0 || k >= int(count))
            refuse("index " + std::to_string(i) + " is not among the " + std::to_string(count) +
                   " before it");
        return k;
    }

    GarmentParts::Corner corner(std::string_view text) const {
        const auto slash = std::min(text.find('/'), text.size());
        GarmentParts::Corner c{index(text.substr(0, slash), parts.nodes.size()), -1};
        text.remove_prefix(std::min(slash + 1, text.size()));
        const std::string_view uv = text.substr(0, text.find('/'));
        if (!uv.empty()) c.uv = index(uv, parts.uv.size());
        return c;
    }

    void read_face(std::string_view rest) {
        std::vector<GarmentParts::Corner> corners;
        for (std::string_view w = word(rest); !w.empty(); w = word(rest))
            corners.push_back(corner(w));
        if (corners.size() < 3)
            refuse("a face has " + std::to_string(corners.size()) + " corners, expected 3 or more");
        for (std::size_t k = 2; k < corners.size(); ++k) {
            if (in_avatar)
                avatar_faces.push_back({corners[0].node, corners[k - 1].node, corners[k].node});
            else
                parts.faces.push_back({{corners[0], corners[k - 1], corners[k]}, panel_index(parts, panel)});
        }
    }

    void read_comment(std::string_view rest) {
        const std::string_view key = word(rest);
        if (key == "uv_metres") parts.uv_metres = number(rest);
        if (key == "metres_per_unit") {
            parts.metres_per_unit = number(rest);
            parts.unit_given = true;
        }
        if (key == "up") parts.z_up = word(rest) == "z";
        if (key != "uv_origin") return;
        const std::string of(word(rest));
        const double u = number(rest);
        parts.uv_origin[of] = Vec2(u, number(rest));
    }

    void read_stitch(std::string_view rest) {
        Stitch s;
        s.a = integer(word(rest));
        s.b[0] = integer(word(rest));
        s.b[1] = integer(word(rest));
        s.r = number(rest);
        parts.stitches.push_back(s);
    }

    void read_link(std::string_view rest) {
        const int a = index(word(rest), parts.nodes.size()), b = index(word(rest), parts.nodes.size());
        parts.stitches.push_back({a, {b, b}, 0, 0, 0});
    }

    void read_line(std::string_view rest) {
        const std::string_view key = word(rest);
        if (key == "v") {
            const double x = number(rest), y = number(rest);
            parts.nodes.emplace_back(x, y, number(rest));
        } else if (key == "vt") {
            const double u = number(rest);
            parts.uv.emplace_back(u, number(rest));
        } else if (key == "f") {
            read_face(rest);
        } else if (key == "g" || key == "o") {
            const std::string_view called = word(rest);
            if (key == "o") in_avatar = called == "avatar";
            if (!called.empty()) panel = called;
        } else if (key == "stitch") {
            read_stitch(rest);
        } else if (key == "l") {
            read_link(rest);
        } else if (key == "#") {
            read_comment(rest);
        }
    }

    void to_metres() {
        if (!(parts.metres_per_unit > 0)) refuse("metres_per_unit must be positive");
        for (Vec3& p : parts.nodes) {
            if (parts.z_up) p = Vec3(p.x(), p.z(), -p.y());
            if (parts.metres_per_unit != 1) p *= parts.metres_per_unit;
        }
    }

    /// The avatar's points out of the nodes, in their order.
    void take_avatar() {
        std::vector<int> to(parts.nodes.size(), -1);
        for (const auto& face : avatar_faces)
            for (const int v : face)
                to[std::size_t(v)] = 0;
        for (std::size_t v = 0; v < to.size(); ++v) {
            if (to[v] < 0) continue;
            to[v] = int(parts.avatar.points.size());
            parts.avatar.points.push_back(parts.nodes[v]);
        }
        for (const auto& f : avatar_faces)
            parts.avatar.triangles.push_back(
                {to[std::size_t(f[0])], to[std::size_t(f[1])], to[std::size_t(f[2])]});
    }
};

} // namespace

std::vector<std::string> group_names(const Garment& g) {
    std::set<std::string> taken{"avatar"};
    std::vector<std::string> names;
    for (std::string name : g.panel_names) {
        std::replace_if(
            name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) || std::iscntrl(c); },
            '_');
        if (name.empty()) name = "panel";
        const std::string stem = name;
        for (int k = 2; !taken.insert(name).second; ++k)
            name = stem + "_" + std::to_string(k);
        names.push_back(name);
    }
    return names;
}

std::string garment_obj(const Garment& g, const Points& x, const WriteOptions& options,
                        const std::string& mtl_name) {
    const std::vector<std::string> names = group_names(g);
    std::string out;
    append_header(out, options);
    out += "mtllib " + mtl_name + "\no garment\n";
    append_points(out, x, options);
    append_texture(out, g, names);
    append_panels(out, g, names);
    append_stitches(out, g);
    if (options.avatar) {
        out += "o avatar\nusemtl avatar\n";
        append_mesh(out, *options.avatar, int(x.size()), options);
    }
    return out;
}

std::string garment_mtl(const Garment& g, const WriteOptions& options) {
    std::string out = "# toile " TOILE_VERSION "\n";
    const std::vector<std::string> names = group_names(g);
    for (std::size_t p = 0; p < names.size(); ++p)
        append_material(out, names[p], panel_colour(int(p)));
    if (options.avatar) append_material(out, "avatar", body_colour());
    return out;
}

std::string mesh_obj(const TriMesh& mesh, const WriteOptions& options) {
    std::string out;
    append_header(out, options);
    append_mesh(out, mesh, 0, options);
    return out;
}

namespace {

/// A file's lines `v` and `vn`, and what its corners are made of.
struct Shading {
    Points normals;                            ///< by line `vn`
    std::vector<std::array<int, 2>> corners;   ///< point and normal, or -1, of every corner
    std::vector<int> faces{0};                 ///< face f has corners [faces[f], faces[f + 1])
};

/// Where the faces round a corner face, by line `vn`.
Points facing(const Shading& s, const Points& x) {
    Points sum(s.normals.size(), Vec3::Zero());
    for (std::size_t f = 0; f + 1 < s.faces.size(); ++f) {
        Vec3 area = Vec3::Zero();
        const int begin = s.faces[f], end = s.faces[f + 1];
        for (int c = begin; c < end; ++c)
            area += (x[s.corners[c][0]] - x[s.corners[begin][0]])
                        .cross(x[s.corners[c + 1 < end ? c + 1 : begin][0]] - x[s.corners[begin][0]]);
        for (int c = begin; c < end; ++c)
            if (s.corners[c][1] >= 0) sum[s.corners[c][1]] += area;
    }
    return sum;
}

Shading read_shading(std::string_view text, const Reader& reader) {
    Shading s;
    std::size_t points = 0;
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        std::string_view rest = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view key = Reader::word(rest);
        if (key == "v") ++points;
        if (key == "vn") {
            const double x = reader.number(rest), y = reader.number(rest);
            s.normals.emplace_back(x, y, reader.number(rest));
        }
        if (key != "f") continue;
        for (std::string_view w = Reader::word(rest); !w.empty(); w = Reader::word(rest)) {
            const auto first = std::min(w.find('/'), w.size()), second = std::min(w.find('/', first + 1), w.size());
            const int normal = second + 1 < w.size() && first < w.size()
                                   ? reader.index(w.substr(second + 1), s.normals.size())
                                   : -1;
            s.corners.push_back({reader.index(w.substr(0, first), points), normal});
        }
        s.faces.push_back(int(s.corners.size()));
    }
    return s;
}

} // namespace

Vec3 turned_with(const Vec3& direction, const Vec3& facing_was, const Vec3& facing_is) {
    if (!(facing_was.norm() > 0 && facing_is.norm() > 0)) return direction;
    return Eigen::Quaterniond::FromTwoVectors(facing_was, facing_is) * direction;
}

std::string moved_obj(std::string_view text, const std::string& name, const std::map<int, Vec3>& moved,
                      const WriteOptions& file) {
    Reader reader;
    reader.name = name;
    Points was;
    for (std::string_view left = text; !left.empty();) {
        const auto end = std::min(left.find('\n'), left.size());
        std::string_view rest = left.substr(0, end);
        left.remove_prefix(std::min(end + 1, left.size()));
        if (Reader::word(rest) != "v") continue;
        const double x = reader.number(rest), y = reader.number(rest);
        was.emplace_back(x, y, reader.number(rest));
    }
    Points is = was;
    for (const auto& [v, p] : moved)
        is.at(v) = in_obj(p, file);
    const Shading shading = read_shading(text, reader);
    const Points faced = facing(shading, was), faces = facing(shading, is);

    std::string out;
    std::size_t v = 0, vn = 0;
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end), rest = line;
        const bool ended = end < text.size();
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view key = Reader::word(rest);
        const auto replace = [&](const Vec3& by) {
            for (int k = 0; k < 3; ++k)
                Reader::word(rest);
            out += key;
            for (int k = 0; k < 3; ++k)
                append(out += ' ', by[k]);
            out += rest; // colours, the end of a line of another system
        };
        if (key == "v" && is[v] != was[v])
            replace(is[v]);
        else if (key == "vn" && faces[vn] != faced[vn])
            replace(turned_with(shading.normals[vn], faced[vn], faces[vn]));
        else
            out += line;
        v += key == "v";
        vn += key == "vn";
        if (ended) out += '\n';
    }
    return out;
}

GarmentParts parse_garment_obj(std::string_view text, const std::string& name) {
    Reader reader;
    reader.name = name;
    while (!text.empty()) {
        ++reader.line;
        const auto end = std::min(text.find('\n'), text.size());
        reader.read_line(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    reader.to_metres();
    reader.take_avatar();
    return std::move(reader.parts);
}

} // namespace toile
