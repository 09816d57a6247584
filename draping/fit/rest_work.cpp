// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/rest_work.h"

#include "geometry/parallel.h"

namespace toile {

namespace {

double bending_work(const Garment& garment, const PanelFabrics& fabrics, const Points& x, const Points& lambda) {
    std::vector<Mat3> moduli;
    for (const Fabric& f : fabrics) moduli.push_back(bend_moduli(f));
    const std::vector<BendRows> all = bend_rows(garment);
    return parallel_sum(int(all.size()), 256, [&](int begin, int end) {
        double sum = 0;
        for (int t = begin; t < end; ++t) {
            Mat3 bent = Mat3::Zero(), along = Mat3::Zero(); // by (uu, vv, uv) and x, y, z
            const Vec3& origin = x[all[t].nodes[0]];
            for (std::size_t i = 0; i < all[t].nodes.size(); ++i) {
                const Vec3 column = all[t].rows.col(Eigen::Index(i));
                bent += column * (x[all[t].nodes[i]] - origin).transpose();
                along += column * lambda[all[t].nodes[i]].transpose();
            }
            const int panel = garment.panel_of_triangle[t];
            sum += rest_area(garment.rest.edges[t]) * (moduli[panel] * bent).cwiseProduct(along).sum();
        }
        return sum;
    });
}

} // namespace

RestWork rest_work(const Garment& garment, const PanelFabrics& fabrics, const Loads& loads, double turn, const Points& x,
                   const Points& lambda) {
    RestWork work;
    const std::vector<StretchElement> elements = make_stretch(garment, fabrics);
    for (const StretchElement& e : elements) {
        work.strain.push_back(stretch_strain(e, x));
        work.rate.push_back(stretch_strain_along(e, x, lambda));
        work.area.push_back(e.area);
        work.response.push_back(stretch_response(e, work.strain.back()));
    }
    std::vector<StrainLimit> limits = make_strain_limits(garment, fabrics);
    for (StrainLimit& limit : limits) limit.turn = turn;
    Points limited(x.size(), Vec3::Zero());
    strain_limit_gradient(limits, x, limited);
    Eigen::VectorXd g = flat(limited);
    add_gradient(make_creases(garment, fabrics), x, g);
    add_gradient(loads, node_masses(garment, fabrics), x, g);
    work.smooth = bending_work(garment, fabrics, x, lambda) + flat(lambda).dot(g);
    return work;
}

double slope(const RestWork& low, const RestWork& here, const RestWork& high, double step) {
    double sum = (high.smooth - low.smooth) / step;
    for (std::size_t t = 0; t < here.area.size(); ++t) {
        const StretchResponse& r = here.response[t];
        const Vec3 strain = (high.strain[t] - low.strain[t]) / step, rate = (high.rate[t] - low.rate[t]) / step;
        const double area = (high.area[t] - low.area[t]) / step;
        sum += area * r.stress.dot(here.rate[t]) + here.area[t] * (here.rate[t].dot(r.tangent * strain) + r.stress.dot(rate));
    }
    return sum;
}

} // namespace toile
