// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/garment_glb.h"

#include "io/colours.h"
#include "io/garment_obj.h"
#include "io/uv_layout.h"

#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

// The file is little-endian and so is every machine this is built for.
static_assert(std::endian::native == std::endian::little);

constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
constexpr int type_u8 = 5121, type_u16 = 5123, type_u32 = 5125, type_float = 5126;
constexpr int target_vertices = 34962, target_indices = 34963;

// ---- writing
// ------------------------------------------------------------------------------------------------

struct Writer {
    Json gltf;
    std::string binary;

    /// Appends the values and returns the index of an accessor for them. Only what a mesh is made of has a target.
    template <class T>
    int accessor(const std::vector<T>& values, int per_item, const char* type, int component, int target = 0) {
        const std::size_t bytes = values.size() * sizeof(T);
        Json view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}};
        if (target != 0) view["target"] = target;
        gltf["bufferViews"].push_back(std::move(view));
        binary.append(reinterpret_cast<const char*>(values.data()), bytes);
        gltf["accessors"].push_back({{"bufferView", gltf["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size() / std::size_t(per_item)},
                                     {"type", type}});
        return int(gltf["accessors"].size()) - 1;
    }

    int floats(const std::vector<float>& values, int per_item, const char* type) {
        return accessor(values, per_item, type, type_float, target_vertices);
    }

    /// Positions must state their bounds.
    int positions(const std::vector<float>& values) {
        const int a = floats(values, 3, "VEC3");
        std::array<float, 3> low{values[0], values[1], values[2]}, high = low;
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i % 3] = std::min(low[i % 3], values[i]);
            high[i % 3] = std::max(high[i % 3], values[i]);
        }
        gltf["accessors"][std::size_t(a)]["min"] = low;
        gltf["accessors"][std::size_t(a)]["max"] = high;
        return a;
    }

    int indices(const std::vector<std::uint32_t>& values) {
        return accessor(values, 1, "SCALAR", type_u32, target_indices);
    }

    int material(const std::string& name, const Vec3& colour, bool double_sided) {
        gltf["materials"].push_back({{"name", name},
                                     {"pbrMetallicRoughness",
                                      {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                       {"metallicFactor", 0.0},
                                       {"roughnessFactor", 0.9}}},
                                     {"doubleSided", double_sided}});
        return int(gltf["materials"].size()) - 1;
    }

    /// A mesh of one primitive and a node that holds it; returns the node.
    std::size_t mesh(const std::string& name, Json attributes, int indices, int material, Json extras) {
        Json mesh{{"name", name},
                  {"primitives", Json::array({{{"attributes", std::move(attributes)},
                                               {"indices", indices},
                                               {"material", material}}})}};
        if (!extras.is_null()) mesh["extras"] = std::move(extras);
        gltf["meshes"].push_back(std::move(mesh));
        gltf["nodes"].push_back({{"name", name}, {"mesh", gltf["meshes"].size() - 1}});
        return gltf["nodes"].size() - 1;
    }
};

/// Area-weighted normals; up where there is no area.
Points normals(const std::vector<Triangle>& triangles, const Points& x) {
    Points sum(x.size(), Vec3::Zero());
    for (const Triangle& t : triangles) {
        const Vec3& o = x[std::size_t(t[0])];
        const Vec3 n = (x[std::size_t(t[1])] - o).cross(x[std::size_t(t[2])] - o);
        for (const int v : t)
            sum[std::size_t(v)] += n;
    }
    for (Vec3& n : sum)
        n = n.norm() > 0 ? n.normalized() : Vec3(0, 1, 0);
    return sum;
}

void append(std::vector<float>& out, const Vec3& p) {
    for (int k = 0; k < 3; ++k)
        out.push_back(float(p[k]));
}

/// The cloth of a frame.
struct Shape {
    Points x, normal; ///< by node
};

/// Of every frame but the last, which is the mesh itself, by how much it differs from that at these nodes.
Json targets(Writer& w, const std::vector<float>& nodes, const Shape& mesh, const std::vector<Shape>& frames) {
    Json list = Json::array();
    const Points shown = rounded_to_float(mesh.x), lit = rounded_to_float(mesh.normal);
    for (const Shape& frame : frames) {
        std::vector<float> moved, turned;
        for (const float n : nodes) {
            append(moved, frame.x[std::size_t(n)] - shown[std::size_t(n)]);
            append(turned, frame.normal[std::size_t(n)] - lit[std::size_t(n)]);
        }
        list.push_back({{"POSITION", w.positions(moved)}, {"NORMAL", w.floats(turned, 3, "VEC3")}});
    }
    return list;
}

/// One weight after the other goes to 1 and back, and at the end all are 0: between two frames points move on lines.
void write_animation(Writer& w, const Json& panels, int frames, double rate) {
    std::vector<float> times, weights(std::size_t(frames) * std::size_t(frames - 1), 0.0f);
    for (int k = 0; k < frames; ++k) {
        times.push_back(float(k / rate));
        if (k + 1 < frames) weights[std::size_t(k) * std::size_t(frames - 1) + std::size_t(k)] = 1;
    }
    const int input = w.accessor(times, 1, "SCALAR", type_float), output = w.accessor(weights, 1, "SCALAR", type_float);
    w.gltf["accessors"][std::size_t(input)]["min"] = {times.front()};
    w.gltf["accessors"][std::size_t(input)]["max"] = {times.back()};
    Json channels = Json::array();
    for (const Json& node : panels)
        channels.push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
    w.gltf["animations"] = Json::array(
        {{{"name", "motion"},
          {"samplers", Json::array({{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}})},
          {"channels", channels}}});
}

std::size_t write_panel(Writer& w, const Garment& g, const Shape& shape, const std::vector<Shape>& frames,
                        const UvLayout& layout, int panel) {
    std::vector<std::uint32_t> local(g.uv.size());
    std::vector<float> position, direction, texture, node;
    for (std::size_t v = 0; v < g.uv.size(); ++v) {
        if (g.panel_of_vertex[v] != panel) continue;
        const auto n = std::size_t(g.node_of_vertex[v]);
        local[v] = std::uint32_t(node.size());
        append(position, shape.x[n]);
        append(direction, shape.normal[n]);
        const Vec2 t = texture_coordinates(g, layout, int(v));
        texture.push_back(float(t.x()));
        texture.push_back(float(1 - t.y())); // glTF counts v downward
        node.push_back(float(n));
    }
    std::vector<std::uint32_t> index;
    for (std::size_t t = 0; t < g.triangles.size(); ++t)
        if (g.panel_of_triangle[t] == panel)
            for (const int v : g.triangles[t])
                index.push_back(local[std::size_t(v)]);
    Json attributes{{"POSITION", w.positions(position)},
                    {"NORMAL", w.floats(direction, 3, "VEC3")},
                    {"TEXCOORD_0", w.floats(texture, 2, "VEC2")},
                    {"_NODE", w.floats(node, 1, "SCALAR")}};
    const std::string& name = g.panel_names[std::size_t(panel)];
    const Vec2& origin = layout.origin[std::size_t(panel)];
    const int material = w.material(name, panel_colour(panel), true);
    const std::size_t mesh = w.mesh(name, std::move(attributes), w.indices(index), material,
                                    {{"uv_metres", layout.scale}, {"uv_origin", {origin.x(), origin.y()}}});
    if (!frames.empty()) w.gltf["meshes"].back()["primitives"][0]["targets"] = targets(w, node, shape, frames);
    return mesh;
}

std::size_t write_avatar(Writer& w, const TriMesh& body) {
    std::vector<float> position, direction;
    for (const Vec3& p : body.points)
        append(position, p);
    for (const Vec3& n : normals(body.triangles, body.points))
        append(direction, n);
    std::vector<std::uint32_t> index;
    for (const Triangle& t : body.triangles)
        for (const int v : t)
            index.push_back(std::uint32_t(v));
    Json attributes{{"POSITION", w.positions(position)}, {"NORMAL", w.floats(direction, 3, "VEC3")}};
    return w.mesh("avatar", std::move(attributes), w.indices(index),
                  w.material("avatar", body_colour(), false), nullptr);
}

void append_chunk(std::string& out, std::uint32_t kind, std::string data, char fill) {
    data.append((4 - data.size() % 4) % 4, fill);
    const std::uint32_t size = std::uint32_t(data.size());
    out.append(reinterpret_cast<const char*>(&size), 4);
    out.append(reinterpret_cast<const char*>(&kind), 4);
    out += data;
}

/// `rest`: chunks of other kinds.
std::string container(const Writer& w, std::string_view rest = {}) {
    std::string chunks;
    append_chunk(chunks, json_chunk, w.gltf.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
    append_chunk(chunks, binary_chunk, w.binary, '\0');
    chunks += rest;
    const std::array<std::uint32_t, 3> header{magic, 2, std::uint32_t(chunks.size() + 12)};
    return std::string(reinterpret_cast<const char*>(header.data()), 12) + chunks;
}

// ---- reading
// ------------------------------------------------------------------------------------------------

/// Cloth as the file holds it.
struct ReadPrimitive {
    std::size_t position = 0;
    std::optional<std::size_t> normal;
    std::vector<int> node, index; ///< by vertex, and the corners of triangles
    Eigen::Affine3d place;        ///< from the file's coordinates to those of the scene
};

struct Reader {
    std::string name;
    Json gltf;
    std::string_view binary;
    GarmentParts parts;
    bool numbered = true; ///< every primitive so far had _NODE
    std::map<std::array<double, 3>, int> node_at;
    std::size_t visits = 0;
    std::vector<ReadPrimitive> primitives; ///< of cloth

    [[noreturn]] void refuse(const std::string& what) const { throw InputError(name + ": " + what); }

    const Json& item(const char* list, std::size_t i) const {
        if (!gltf.contains(list) || i >= gltf[list].size())
            refuse("names " + std::string(list) + " " + std::to_string(i) + ", which it does not have");
        return gltf[list][i];
    }

    static std::size_t size_of(int component) {
        return component == type_u8 ? 1 : component == type_u16 ? 2 : 4;
    }

    double value(const char* at, int component) const {
        if (component == type_u8) return double(std::uint8_t(*at));
        std::uint16_t u16;
        std::uint32_t u32;
        float f;
        if (component == type_u16) return double((std::memcpy(&u16, at, 2), u16));
        if (component == type_u32) return double((std::memcpy(&u32, at, 4), u32));
        return double((std::memcpy(&f, at, 4), f));
    }

    /// Where the numbers of an accessor lie in the binary part.
    struct Layout {
        int component = 0;
        std::size_t begin = 0, stride = 0, count = 0;
    };

    Layout layout(std::size_t index, std::size_t per_item, const char* type) const {
        const Json& a = item("accessors", index);
        const int component = a.at("componentType");
        if (a.at("type") != type || a.contains("sparse") || !a.contains("bufferView") ||
            (component != type_u8 && component != type_u16 && component != type_u32 &&
             component != type_float))
            refuse("accessor " + std::to_string(index) + " is not a plain " + type +
                   " of a kind that is read");
        const Json& view = item("bufferViews", a["bufferView"]);
        const std::size_t size = size_of(component), count = a.at("count");
        const std::size_t stride = view.value("byteStride", std::size_t(per_item * size));
        const std::size_t begin = a.value("byteOffset", std::size_t(0)), length = view.at("byteLength");
        const std::size_t offset = view.value("byteOffset", std::size_t(0));
        if (view.value("buffer", 0) != 0 || offset > binary.size() || length > binary.size() - offset ||
            begin > length || count > length || stride > length + per_item * size ||
            (count > 0 && begin + (count - 1) * stride + per_item * size > length))
            refuse("accessor " + std::to_string(index) + " reaches beyond the file's binary part");
        return {component, offset + begin, stride, count};
    }

    /// The accessor's numbers, `per_item` for each of its items.
    std::vector<double> numbers(std::size_t index, std::size_t per_item, const char* type) const {
        const Layout l = layout(index, per_item, type);
        std::vector<double> out;
        out.reserve(l.count * per_item);
        for (std::size_t i = 0; i < l.count; ++i)
            for (std::size_t k = 0; k < per_item; ++k)
                out.push_back(value(binary.data() + l.begin + i * l.stride + k * size_of(l.component), l.component));
        for (const double v : out)
            if (!std::isfinite(v))
                refuse("accessor " + std::to_string(index) + " holds a number that is not finite");
        return out;
    }

    static Eigen::Affine3d transform(const Json& node) {
        Eigen::Affine3d t = Eigen::Affine3d::Identity();
        if (node.contains("matrix")) {
            const std::vector<double> m = node["matrix"];
            if (m.size() == 16) t.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
            return t;
        }
        const auto part = [&](const char* key, std::vector<double> other) {
            const std::vector<double> given = node.value(key, other);
            return given.size() == other.size() ? given : other;
        };
        const auto p = part("translation", {0, 0, 0}), r = part("rotation", {0, 0, 0, 1}),
                   s = part("scale", {1, 1, 1});
        t.translate(Vec3(p[0], p[1], p[2]));
        t.rotate(Eigen::Quaterniond(r[3], r[0], r[1], r[2]));
        t.scale(Vec3(s[0], s[1], s[2]));
        return t;
    }

    /// Without node numbers, points at the same place are one node.
    int merged_node(const Vec3& p) {
        const auto [it, fresh] = node_at.try_emplace({p.x(), p.y(), p.z()}, int(parts.nodes.size()));
        if (fresh) parts.nodes.push_back(p);
        return it->second;
    }

    int numbered_node(double number, const Vec3& p) {
        const auto n = std::size_t(number);
        if (!(number >= 0) || n != number || n >= binary.size()) refuse("has a node number that is not one");
        if (n >= parts.nodes.size()) parts.nodes.resize(n + 1, Vec3::Zero());
        parts.nodes[n] = p;
        return int(n);
    }

    void read_uv(const Json& mesh, const std::string& panel, const Json& attributes, std::size_t count) {
        if (!attributes.contains("TEXCOORD_0")) return;
        const std::vector<double> uv = numbers(attributes["TEXCOORD_0"], 2, "VEC2");
        if (uv.size() != 2 * count)
            refuse("mesh " + panel + " has not as many texture coordinates as positions");
        for (std::size_t i = 0; i < count; ++i)
            parts.uv.emplace_back(uv[2 * i], 1 - uv[2 * i + 1]);
        const Json extras = mesh.value("extras", Json::object());
        if (extras.contains("uv_metres")) parts.uv_metres = extras["uv_metres"].get<double>();
        const std::vector<double> origin = extras.value("uv_origin", std::vector<double>());
        if (origin.size() == 2) parts.uv_origin[panel] = Vec2(origin[0], origin[1]);
    }

    Points positions(const Json& attributes, const Eigen::Affine3d& place) const {
        const std::vector<double> p = numbers(attributes.at("POSITION"), 3, "VEC3");
        Points out;
        for (std::size_t i = 0; i < p.size(); i += 3)
            out.push_back(place * Vec3(p[i], p[i + 1], p[i + 2]));
        return out;
    }

    std::vector<int> indices(const Json& primitive, std::size_t count) const {
        std::vector<int> out;
        if (!primitive.contains("indices"))
            for (std::size_t i = 0; i < count; ++i)
                out.push_back(int(i));
        else
            for (const double i : numbers(primitive["indices"], 1, "SCALAR")) {
                if (i >= double(count))
                    refuse("a triangle names vertex " + std::to_string(i) + " of " + std::to_string(count));
                out.push_back(int(i));
            }
        if (out.size() % 3 != 0) refuse("a mesh's indices are not whole triangles");
        return out;
    }

    void read_garment(const Json& mesh, const std::string& panel, const Json& primitive, const Points& p,
                      const Eigen::Affine3d& place) {
        const Json& attributes = primitive.at("attributes");
        const int uv_before = int(parts.uv.size());
        read_uv(mesh, panel, attributes, p.size());
        const bool has_uv = int(parts.uv.size()) > uv_before;
        std::vector<double> number;
        if (attributes.contains("_NODE")) number = numbers(attributes["_NODE"], 1, "SCALAR");
        if (parts.faces.empty()) numbered = number.size() == p.size();
        if (numbered && number.size() != p.size())
            refuse("mesh " + panel + " has not as many node numbers as positions");
        std::vector<int> node;
        for (std::size_t i = 0; i < p.size(); ++i)
            node.push_back(numbered ? numbered_node(number[i], p[i]) : merged_node(p[i]));
        const std::vector<int> index = indices(primitive, p.size());
        for (std::size_t i = 0; i < index.size(); i += 3) {
            GarmentParts::Face face;
            face.panel = panel_index(parts, panel);
            for (std::size_t k = 0; k < 3; ++k)
                face.corners[k] = {node[std::size_t(index[i + k])], has_uv ? uv_before + index[i + k] : -1};
            parts.faces.push_back(face);
        }
        primitives.push_back({attributes.at("POSITION"), std::nullopt, std::move(node), index, place});
        if (attributes.contains("NORMAL")) primitives.back().normal = attributes["NORMAL"].get<std::size_t>();
    }

    void read_avatar(const Json& primitive, const Points& p) {
        const int before = int(parts.avatar.points.size());
        parts.avatar.points.insert(parts.avatar.points.end(), p.begin(), p.end());
        const std::vector<int> index = indices(primitive, p.size());
        for (std::size_t i = 0; i < index.size(); i += 3)
            parts.avatar.triangles.push_back(
                {before + index[i], before + index[i + 1], before + index[i + 2]});
    }

    void read_node(std::size_t index, const Eigen::Affine3d& parent, int depth) {
        if (depth > 100 || ++visits > 100000) refuse("its nodes hang on each other without end");
        const Json& node = item("nodes", index);
        const Eigen::Affine3d place = parent * transform(node);
        if (node.contains("mesh")) {
            const Json& mesh = item("meshes", node["mesh"]);
            const std::string called = mesh.value("name", node.value("name", std::string("garment")));
            for (const Json& primitive : mesh.at("primitives")) {
                if (primitive.value("mode", 4) != 4) continue;
                const Points p = positions(primitive.at("attributes"), place);
                // Ours have texture coordinates in every panel, and none in the avatar.
                if (called == "avatar" && !primitive["attributes"].contains("TEXCOORD_0"))
                    read_avatar(primitive, p);
                else
                    read_garment(mesh, called, primitive, p, place);
            }
        }
        for (const Json& child : node.value("children", Json::array()))
            read_node(child, place, depth + 1);
    }

    void read_stitches() {
        const Json extras = gltf.value("/asset/extras"_json_pointer, Json::object());
        for (const Json& s : extras.value("stitches", Json::array()))
            parts.stitches.push_back({s.at(0), {s.at(1), s.at(2)}, s.at(3), 0, 0});
    }
};

std::uint32_t u32(std::string_view bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

std::string_view chunk(std::string_view& bytes, std::uint32_t kind, const std::string& name) {
    if (bytes.size() < 8 || u32(bytes, 4) != kind || u32(bytes, 0) > bytes.size() - 8)
        throw InputError(name + ": the binary glTF is cut short");
    const std::string_view data = bytes.substr(8, u32(bytes, 0));
    bytes.remove_prefix(8 + data.size());
    return data;
}

} // namespace

std::string garment_glb(const Garment& g, const Points& x, const WriteOptions& options) {
    Writer w;
    w.gltf["asset"] = {{"version", "2.0"}, {"generator", "toile " TOILE_VERSION}};
    for (const Stitch& s : g.stitches)
        w.gltf["asset"]["extras"]["stitches"].push_back({s.a, s.b[0], s.b[1], s.r});
    w.gltf["scene"] = 0;
    const UvLayout layout = lay_out_panels(g);
    const std::vector<Triangle> cloth = node_triangles(g);
    const Shape shape{x, normals(cloth, x)};
    std::vector<Shape> frames;
    for (std::size_t k = 0; options.motion && k + 1 < options.motion->frames.size(); ++k)
        frames.push_back({options.motion->frames[k], normals(cloth, options.motion->frames[k])});
    std::vector<bool> has_cloth(g.panel_names.size(), false);
    for (const int p : g.panel_of_triangle)
        has_cloth[std::size_t(p)] = true;
    Json roots = Json::array();
    for (std::size_t p = 0; p < g.panel_names.size(); ++p)
        if (has_cloth[p]) roots.push_back(write_panel(w, g, shape, frames, layout, int(p)));
    if (!frames.empty()) write_animation(w, roots, int(frames.size()) + 1, options.motion->rate);
    if (options.avatar) roots.push_back(write_avatar(w, *options.avatar));
    w.gltf["scenes"] = Json::array({{{"nodes", roots}}});
    w.gltf["buffers"] = Json::array({{{"byteLength", w.binary.size()}}});
    return container(w);
}

namespace {

/// Reads all but what the bytes hold beyond the binary part, which `bytes` keeps.
Reader read_all(std::string_view& bytes, const std::string& name) {
    if (bytes.size() < 12 || u32(bytes, 0) != magic || u32(bytes, 4) != 2)
        throw InputError(name + " is not a binary glTF 2.0 file");
    bytes.remove_prefix(12);
    Reader reader;
    reader.name = name;
    const std::string_view json = chunk(bytes, json_chunk, name);
    reader.binary = chunk(bytes, binary_chunk, name);
    try {
        reader.gltf = Json::parse(json);
        const Json& scene = reader.item("scenes", reader.gltf.value("scene", std::size_t(0)));
        for (const Json& root : scene.value("nodes", Json::array()))
            reader.read_node(root, Eigen::Affine3d::Identity(), 0);
        reader.read_stitches();
    } catch (const nlohmann::json::exception& error) {
        throw InputError(name + ": its glTF part is not as the standard says (" + error.what() + ")");
    }
    return reader;
}

/// Rewrites points and normals of the binary part.
struct Mover {
    const Reader& reader;
    std::string binary;

    Reader::Layout floats(std::size_t accessor) const {
        const Reader::Layout l = reader.layout(accessor, 3, "VEC3");
        if (l.component != type_float)
            reader.refuse("accessor " + std::to_string(accessor) + " is not of floats, which are what can be moved");
        return l;
    }

    Vec3 at(const Reader::Layout& l, int i) const {
        std::array<float, 3> f;
        std::memcpy(f.data(), binary.data() + l.begin + std::size_t(i) * l.stride, sizeof f);
        return {f[0], f[1], f[2]};
    }

    void put(const Reader::Layout& l, int i, const Vec3& p) {
        const std::array<float, 3> f{float(p[0]), float(p[1]), float(p[2])};
        std::memcpy(binary.data() + l.begin + std::size_t(i) * l.stride, f.data(), sizeof f);
    }
};

/// Where the faces at each vertex of a primitive face, in the file's coordinates, added to `sum`.
void add_facing(const Mover& m, const ReadPrimitive& p, Points& sum) {
    const Reader::Layout l = m.floats(p.position);
    sum.resize(std::max(sum.size(), p.node.size()), Vec3::Zero());
    for (std::size_t k = 0; k + 2 < p.index.size(); k += 3) {
        const Vec3 o = m.at(l, p.index[k]);
        const Vec3 area = (m.at(l, p.index[k + 1]) - o).cross(m.at(l, p.index[k + 2]) - o);
        for (std::size_t c = 0; c < 3; ++c)
            sum[std::size_t(p.index[k + c])] += area;
    }
}

std::map<std::size_t, Points> facing(const Mover& m) {
    std::map<std::size_t, Points> by_accessor;
    for (const ReadPrimitive& p : m.reader.primitives)
        if (p.normal) add_facing(m, p, by_accessor[*p.normal]);
    return by_accessor;
}

} // namespace

std::string moved_glb(std::string_view bytes, const std::string& name, const std::map<int, Vec3>& moved) {
    Reader reader = read_all(bytes, name);
    Mover m{reader, std::string(reader.binary)};
    std::map<std::size_t, const ReadPrimitive*> of_accessor;
    for (const ReadPrimitive& p : reader.primitives) {
        const auto [it, fresh] = of_accessor.try_emplace(p.position, &p);
        if (!fresh && it->second->node != p.node)
            reader.refuse("a mesh hangs in it twice, and what is moved of the one would move the other");
    }
    const std::map<std::size_t, Points> faced = facing(m);
    for (const auto& [accessor, p] : of_accessor) {
        const Reader::Layout l = m.floats(accessor);
        const Eigen::Affine3d back = p->place.inverse();
        for (std::size_t v = 0; v < p->node.size(); ++v)
            if (const auto to = moved.find(p->node[v]); to != moved.end()) m.put(l, int(v), back * to->second);
    }
    for (const auto& [accessor, faces] : facing(m)) {
        const Reader::Layout l = m.floats(accessor);
        const Points& was = faced.at(accessor);
        for (std::size_t v = 0; v < std::min(faces.size(), l.count); ++v)
            if (faces[v] != was[v]) m.put(l, int(v), turned_with(m.at(l, int(v)), was[v], faces[v]).normalized());
    }
    Writer w{reader.gltf, {}};
    for (const auto& [accessor, p] : of_accessor) { // positions state their bounds
        const Reader::Layout l = m.floats(accessor);
        Eigen::AlignedBox3d box;
        for (std::size_t v = 0; v < l.count; ++v)
            box.extend(m.at(l, int(v)));
        w.gltf["accessors"][accessor]["min"] = {box.min()[0], box.min()[1], box.min()[2]};
        w.gltf["accessors"][accessor]["max"] = {box.max()[0], box.max()[1], box.max()[2]};
    }
    w.binary = std::move(m.binary);
    return container(w, bytes);
}

GarmentParts parse_garment_glb(std::string_view bytes, const std::string& name) {
    return std::move(read_all(bytes, name).parts);
}

} // namespace toile
