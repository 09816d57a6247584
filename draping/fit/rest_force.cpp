// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/rest_force.h"

namespace toile {

namespace {

void add_membrane(const std::vector<StretchElement>& elements, const MembraneTangent& law, const Points& x, Points& g) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
        const StretchElement& e = elements[t];
        const StretchResponse& r = law.response[t];
        const Vec3 stress = r.stress + r.tangent * (stretch_strain(e, x) - law.strain[t]);
        std::array<Vec3, Patch::max_nodes> part;
        stretch_gradient(e, stress, x, part);
        for (int a = 0; a < e.patch.count; ++a) g[e.patch.nodes[a]] += part[a];
    }
}

void add_bending(const Garment& garment, const PanelFabrics& fabrics, const Points& x, Points& g) {
    std::vector<Mat3> moduli;
    for (const Fabric& f : fabrics) moduli.push_back(bend_moduli(f));
    const std::vector<BendRows> all = bend_rows(garment);
    for (std::size_t t = 0; t < all.size(); ++t) {
        Mat3 bent = Mat3::Zero(); // by (uu, vv, uv) and x, y, z
        const Vec3& origin = x[all[t].nodes[0]];
        const auto row = [&](std::size_t i) { return Vec3(all[t].rows.col(Eigen::Index(i))); };
        for (std::size_t i = 0; i < all[t].nodes.size(); ++i) bent += row(i) * (x[all[t].nodes[i]] - origin).transpose();
        const Mat3 moment = rest_area(garment.rest.edges[t]) * moduli[garment.panel_of_triangle[t]] * bent;
        for (std::size_t i = 0; i < all[t].nodes.size(); ++i) g[all[t].nodes[i]] += moment.transpose() * row(i);
    }
}

} // namespace

MembraneTangent membrane_tangent(const Garment& garment, const PanelFabrics& fabrics, const Points& x) {
    MembraneTangent law;
    for (const StretchElement& e : make_stretch(garment, fabrics)) {
        law.strain.push_back(stretch_strain(e, x));
        law.response.push_back(stretch_response(e, law.strain.back()));
    }
    return law;
}

Eigen::VectorXd rest_force(const Garment& garment, const PanelFabrics& fabrics, const Loads& loads, double turn,
                           const MembraneTangent& law, const Points& x) {
    Points cloth(x.size(), Vec3::Zero());
    add_membrane(make_stretch(garment, fabrics), law, x, cloth);
    add_bending(garment, fabrics, x, cloth);
    std::vector<StrainLimit> limits = make_strain_limits(garment, fabrics);
    for (StrainLimit& limit : limits) limit.turn = turn;
    strain_limit_gradient(limits, x, cloth);
    Eigen::VectorXd g = flat(cloth);
    add_gradient(make_creases(garment, fabrics), x, g);
    add_gradient(loads, node_masses(garment, fabrics), x, g);
    return g;
}

} // namespace toile
