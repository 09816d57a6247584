// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_fabric.h"

#include "draping/energy/stretch.h"
#include "io/json.h"
#include "io/write_file.h"

#include <istream>

namespace toile {
namespace {

constexpr std::uintmax_t max_bytes = 1u << 20;
constexpr double most_stretch = 10, most_tension = 1e6;

struct Member {
    const char* key;
    double Fabric::*value;
    double low, high;
};

constexpr Member members[] = {
    {"density", &Fabric::density, 0.001, 10},
    {"poisson", &Fabric::poisson, 0, 0.499},
    {"shear", &Fabric::shear, 1e-3, 1e6},
    {"bend_warp", &Fabric::bend_warp, 1e-9, 1},
    {"bend_weft", &Fabric::bend_weft, 1e-9, 1},
    {"bend_twist", &Fabric::bend_twist, 1e-9, 1},
    {"bend_poisson", &Fabric::bend_poisson, 0, 0.499},
    {"compression", &Fabric::compression, 1e-3, 1},
    {"thickness", &Fabric::thickness, 1e-5, 0.1},
    {"friction", &Fabric::friction, 0, 2},
    {"cloth_friction", &Fabric::cloth_friction, 0, 2},
    {"limit_warp", &Fabric::limit_warp, 0, most_stretch},
    {"limit_weft", &Fabric::limit_weft, 0, most_stretch},
    {"limit_shear", &Fabric::limit_shear, 0, 1.5},
};

std::vector<StretchPoint> read_points(const JsonView& v) {
    std::vector<StretchPoint> points;
    for (std::size_t k = 0; k < v.value().size(); ++k) {
        const JsonView point = v.at(k, "point");
        point.expect_array(2, 2);
        points.push_back({point.at(0, "number").number(0, most_stretch), point.at(1, "number").number(0, most_tension)});
    }
    return points;
}

/// A number is a constant stiffness, a list of points a curve.
void read_stretch(const JsonView& v, double& constant, std::vector<StretchPoint>& curve, void (*set)(Fabric&, std::vector<StretchPoint>),
                  Fabric& fabric) {
    if (v.value().is_number()) {
        constant = v.number(1e-3, most_tension);
        curve.clear();
        return;
    }
    if (!v.value().is_array()) v.fail("a stiffness in N/m or a list of points [stretch, tension in N/m]");
    try {
        set(fabric, read_points(v));
    } catch (const std::invalid_argument& error) {
        throw InputError(v.place() + ": " + error.what());
    }
}

Fabric read(const JsonView& root) {
    root.expect_keys({"toile_fabric", "name", "source", "like", "stretch_warp", "stretch_weft", "density", "poisson", "shear",
                      "bend_warp", "bend_weft", "bend_twist", "bend_poisson", "compression", "thickness", "friction",
                      "cloth_friction", "limit_warp", "limit_weft", "limit_shear"});
    root.at("toile_fabric").integer(1, 1);
    Fabric f;
    try {
        f = fabric_preset(root.at("like").string());
    } catch (const std::invalid_argument& error) {
        throw InputError(root.at("like").place() + ": " + error.what());
    }
    f.name = root.at("name").string();
    f.source = root.has("source") ? root.at("source").string() : "";
    for (const Member& m : members)
        if (root.has(m.key)) f.*m.value = root.at(m.key).number(m.low, m.high);
    if (root.has("stretch_warp")) read_stretch(root.at("stretch_warp"), f.stretch_warp, f.curve_warp, set_warp_curve, f);
    if (root.has("stretch_weft")) read_stretch(root.at("stretch_weft"), f.stretch_weft, f.curve_weft, set_weft_curve, f);
    try {
        check_membrane(f);
    } catch (const std::invalid_argument& error) {
        throw InputError(root.place() + ": " + error.what());
    }
    return f;
}

Fabric read_text_of(const std::string& text, const std::string& name) {
    const Json json = parse_json(text, name);
    return read(JsonView(json, name));
}

} // namespace

bool is_fabric_file(const std::string& name) {
    return name.ends_with(".json");
}

std::string fabric_file(const std::string& name) { return is_fabric_file(name) ? name : ""; }

Fabric read_fabric(std::istream& in, const std::string& name) {
    return read_text_of(read_text(in, name, max_bytes), name);
}

Fabric fabric_called(const std::string& name) {
    return is_fabric_file(name) ? read_text_of(read_file(name, max_bytes), name) : fabric_preset(name);
}

} // namespace toile
