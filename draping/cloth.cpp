// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/cloth.h"

#include "geometry/disjoint_sets.h"

#include <algorithm>
#include <limits>

namespace toile {

ContactCloth contact_cloth(const Garment& g) {
    ContactCloth c;
    c.triangles = node_triangles(g);
    c.edges = g.edges.ends;
    c.node_area.assign(g.node_count, 0.0);
    c.node_reach.assign(g.node_count, std::numeric_limits<double>::infinity());
    c.edge_length.assign(g.edges.size(), 0.0);
    c.edge_area.assign(g.edges.size(), 0.0);
    for (std::size_t t = 0; t < c.triangles.size(); ++t) {
        const Mat2& r = g.rest.edges[t];
        const double area = rest_area(r);
        const double length[3] = {(r.col(1) - r.col(0)).norm(), r.col(1).norm(), r.col(0).norm()};
        const double altitude = 2 * area / std::max({length[0], length[1], length[2]});
        for (int k = 0; k < 3; ++k) {
            const int node = c.triangles[t][k], edge = g.edges.of_triangle[t][k];
            c.node_area[node] += area / 3;
            c.node_reach[node] = std::min(c.node_reach[node], altitude);
            c.edge_area[edge] += area / 3;
            c.edge_length[edge] = std::max(c.edge_length[edge], length[k]);
        }
    }
    for (const Stitch& s : g.stitches)
        if (s.r > 0 && s.r < 1) c.sewn_to_edge.push_back({s.a, s.b[0], s.b[1]});
    // Nodes that stitches will merge count as one.
    DisjointSets merged(g.node_count);
    for (const Stitch& s : g.stitches) {
        if (s.r != 0) continue;
        merged.join(s.a, s.b[0]);
    }
    c.group = merged.all();
    return c;
}

TangledCloth tangled_cloth(const Garment& g, double edge_length) {
    ContactCloth cloth = contact_cloth(g);
    return {std::move(cloth.triangles), g.edges, edge_length, std::move(cloth.sewn_to_edge)};
}

std::vector<double> node_masses(const Garment& g, const PanelFabrics& fabrics) {
    std::vector<double> mass(g.node_count, 0.0);
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        const double m = fabrics[g.panel_of_triangle[t]].density * rest_area(g.rest.edges[t]) / 3;
        for (int node : g.nodes(int(t))) mass[node] += m;
    }
    return mass;
}

ClothProblem::ClothProblem(const Garment& garment, const PanelFabrics& fabrics, const TriMesh& body,
                           const ContactOptions& contact)
    : ClothProblem(std::make_unique<SheetEnergy>(make_sheet(garment, fabrics)), garment, fabrics, body, contact) {}

ClothProblem::ClothProblem(std::unique_ptr<Energy> model, const Garment& garment, const PanelFabrics& fabrics,
                           const TriMesh& body, const ContactOptions& contact)
    : ClothProblem(std::move(model), model->masses(node_masses(garment, fabrics)), garment, fabrics, body, contact) {}

ClothProblem::ClothProblem(std::unique_ptr<Energy>&& model, std::vector<double> masses, const Garment& garment,
                           const PanelFabrics& fabrics, const TriMesh& body, const ContactOptions& contact)
    : FreeCloth(std::move(model), std::move(masses)), RestingContact(contact_cloth(garment), body, contact) {
    if (auto* own = dynamic_cast<SheetEnergy*>(energy_.get())) {
        sheet_ = &own->sheet;
        limits_.swap(sheet_->limits);
    } else {
        limits_ = make_strain_limits(garment, fabrics);
    }
}

ClothProblem::ClothProblem(std::unique_ptr<SheetEnergy> part, std::vector<double> node_mass, ContactCloth cloth,
                           const TriMesh& body, const ContactOptions& contact)
    : FreeCloth(std::move(part), std::move(node_mass)), RestingContact(std::move(cloth), body, contact),
      sheet_(&static_cast<SheetEnergy*>(energy_.get())->sheet) {}

void ClothProblem::rest_on(const Garment& garment, const PanelFabrics& fabrics) {
    const double softness = sheet_->softness;
    *sheet_ = make_sheet(garment, fabrics);
    sheet_->softness = softness;
    limits_.clear();
    limits_.swap(sheet_->limits);
    if (turn_ > 0) limit_strain(turn_, tighter_);
    set_node_mass(node_masses(garment, fabrics));
    renew_energy();
}

void ClothProblem::limit_strain(double turn, double tighter) {
    if (!sheet_) return;
    turn_ = turn;
    tighter_ = tighter;
    sheet_->limits = limits_;
    for (StrainLimit& limit : sheet_->limits) {
        limit.turn = turn;
        limit.weft = 1 + (1 - tighter) * (limit.weft - 1);
        limit.warp = 1 + (1 - tighter) * (limit.warp - 1);
        limit.shear *= 1 - tighter;
    }
}

Points ClothProblem::all_points(const Points& nodes) const {
    Points x = state_;
    energy_->carry(x, nodes);
    return x;
}

Points ClothProblem::keep(Points x) {
    state_ = std::move(x);
    return {state_.begin(), state_.begin() + nodes()};
}

void ClothProblem::arrive(const Points& x) {
    const Points of_nodes(x.begin(), x.begin() + nodes()); // contact knows no other points
    if (!renew_contact(of_nodes, node_mass_)) return;
    Eigen::VectorXd g;
    gradient(x, g);
    take_up_forces(of_nodes, pinned_, g);
}

double ClothProblem::value(const Points& x) { return with_contact_value(FreeCloth::value(x), contact().active(x), x); }

void ClothProblem::gradient_with(const std::vector<ActivePair>& active, const Points& x, Eigen::VectorXd& g) {
    FreeCloth::gradient(x, g);
    add_contact_gradient(active, x, g);
    clear_pinned(g);
}

BlockMatrix& ClothProblem::hessian(const Points& x, bool exact, bool& pattern_changed) {
    BlockMatrix& h = FreeCloth::hessian(x, exact, pattern_changed);
    add_body_friction_hessian(x, exact, h);
    return h;
}

void ClothProblem::curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                                   Eigen::VectorXd& hd) {
    constexpr double part = 1e-3; // of steps of millimetres: what touches moves by micrometres
    Points near = x;
    flat(near) += part * d;
    gradient_with(contact().active(near), near, hd);
    hd = (hd - g) / part;
}

double ClothProblem::feasible_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares) {
    const double t = longest_contact_step(x, dx, shares);
    if (shares) shares->resize(x.size(), 1.0); // nothing is in the way of a model's own points
    return t;
}

double ClothProblem::residual(const Points& x, const Eigen::VectorXd& g) {
    excess_ = friction_excess({x.begin(), x.begin() + nodes()});
    // A model's own points are lighter and more than its nodes: a force counts by the mean weight of nodes alike.
    const double r = NodeProblem::residual(x, g) * nodes() / points();
    note_residual(r);
    return r;
}

} // namespace toile
