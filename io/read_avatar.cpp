// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_avatar.h"

#include "geometry/solid.h"
#include "geometry/text.h"
#include "io/read_polygons.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw InputError(path + ": " + why);
}

std::string decimals(double value, int count) {
    return text("%.*f", count, value);
}

std::string place(const Vec3& p) {
    return "x " + decimals(p.x(), 3) + ", y " + decimals(p.y(), 3) + ", z " + decimals(p.z(), 3) + " m";
}

std::string counted(size_t n, const std::string& one, const std::string& many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
}

// ---- polygons to a closed body -------------------------------------------------------------------------------

/// Quads by their shorter diagonal, more corners by the least area.
TriMesh split_polygons(Polygons&& polygons, const std::string& path, std::vector<std::string>& notes) {
    TriMesh mesh{std::move(polygons.points), {}};
    size_t quads = 0, others = 0;
    for (const std::vector<int>& f : polygons.faces) {
        if (f.size() == 3) {
            mesh.triangles.push_back({f[0], f[1], f[2]});
        } else if (f.size() == 4) {
            ++quads;
            const Points& p = mesh.points;
            if ((p[f[0]] - p[f[2]]).squaredNorm() <= (p[f[1]] - p[f[3]]).squaredNorm()) {
                mesh.triangles.push_back({f[0], f[1], f[2]});
                mesh.triangles.push_back({f[0], f[2], f[3]});
            } else {
                mesh.triangles.push_back({f[1], f[2], f[3]});
                mesh.triangles.push_back({f[1], f[3], f[0]});
            }
        } else {
            if (f.size() > 500)
                refuse(path, "a face has " + std::to_string(f.size()) + " corners; at most 500 are read");
            ++others;
            for (const Triangle& t : fill_loop(mesh.points, f)) mesh.triangles.push_back(t);
        }
    }
    if (quads > 0) notes.push_back(counted(quads, "quad", "quads") + " split into triangles");
    if (others > 0)
        notes.push_back(counted(others, "face", "faces") + " of more than four corners split into triangles");
    return mesh;
}

Vec3 extents(const Points& points) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : points) box.extend(p);
    return box.sizes();
}

/// To metres and y up.
AvatarAxes settle_frame(TriMesh& mesh, const std::string& path, std::vector<std::string>& notes) {
    const Vec3 size = extents(mesh.points);
    const bool z_up = size.z() > size.y();
    const double height = std::max(size.y(), size.z());
    struct Unit {
        const char* name;
        double metres;
    };
    const Unit units[] = {{"metres", 1}, {"decimetres", 0.1}, {"centimetres", 0.01}, {"millimetres", 0.001}};
    const Unit* unit = nullptr;
    for (const Unit& u : units)
        if (height * u.metres >= 0.4 && height * u.metres < 4) unit = &u;
    if (!unit)
        refuse(path, "the body is " + decimals(height, 4) +
                         " units tall; in metres, decimetres, centimetres or millimetres a body of 0.4 to 4 m was "
                         "expected");
    const AvatarAxes axes{unit->metres, z_up};
    for (Vec3& p : mesh.points) p = in_metres(p, axes);
    notes.push_back(std::string("read in ") + unit->name + ", " + (z_up ? "z" : "y") + " up, " +
                    decimals(height * unit->metres, 3) + " m tall");
    return axes;
}

struct Hole {
    Vec3 centre = Vec3::Zero();
    double length = 0; ///< around, m
};

Hole describe(const Points& points, const std::vector<int>& loop) {
    Hole hole;
    for (size_t i = 0; i < loop.size(); ++i) {
        hole.centre += points[loop[i]] / double(loop.size());
        hole.length += (points[loop[i]] - points[loop[(i + 1) % loop.size()]]).norm();
    }
    return hole;
}

void refuse_leaks(const TriMesh& mesh, const std::vector<std::vector<int>>& loops, const std::string& path) {
    size_t edges = 0, largest = 0;
    for (size_t i = 0; i < loops.size(); ++i) {
        edges += loops[i].size();
        if (describe(mesh.points, loops[i]).length > describe(mesh.points, loops[largest]).length) largest = i;
    }
    const Hole hole = describe(mesh.points, loops[largest]);
    refuse(path, "the surface is not closed: " + counted(loops.size(), "hole", "holes") + " with " +
                     counted(edges, "open edge", "open edges") + ", the largest " +
                     decimals(100 * hole.length, 1) + " cm around at " + place(hole.centre) +
                     "; close it, or ask for repair");
}

void close_leaks(TriMesh& mesh, const std::vector<std::vector<int>>& loops, const std::string& path,
                 std::vector<std::string>& notes) {
    const double height = extents(mesh.points).y();
    for (const std::vector<int>& loop : loops) {
        const Hole hole = describe(mesh.points, loop);
        if (hole.length > height || loop.size() > 500)
            refuse(path, "the hole at " + place(hole.centre) + " is too large to be closed: " +
                             decimals(100 * hole.length, 1) + " cm around with " + std::to_string(loop.size()) +
                             " edges; at most the body's height around and 500 edges are closed");
        for (const Triangle& t : fill_loop(mesh.points, loop)) mesh.triangles.push_back(t);
        notes.push_back("hole of " + decimals(100 * hole.length, 1) + " cm around closed at " + place(hole.centre));
    }
}

/// Joins, orients, and closes or refuses.
void make_closed(TriMesh& mesh, bool repair, const std::string& path, std::vector<std::string>& notes) {
    if (const int joined = join_equal_points(mesh); joined > 0)
        notes.push_back(counted(joined, "point", "points") + " joined with others in the same place");
    if (const int flat = drop_flat_triangles(mesh); flat > 0)
        notes.push_back(counted(flat, "triangle", "triangles") + " without area removed");
    if (mesh.triangles.empty()) refuse(path, "the mesh has no triangles with an area");
    if (const int turned = orient_outward(mesh); turned > 0)
        notes.push_back(counted(turned, "triangle", "triangles") + " turned to face outward");
    const std::vector<std::vector<int>> loops = border_loops(mesh);
    if (!loops.empty()) {
        if (!repair) refuse_leaks(mesh, loops, path);
        close_leaks(mesh, loops, path, notes);
        orient_outward(mesh);
    }
    if (const int crowded = crowded_edges(mesh); crowded > 0)
        notes.push_back(counted(crowded, "edge carries", "edges carry") + " more than two triangles");
    drop_unused_points(mesh);
}

void expect_volume(const TriMesh& mesh, const std::string& path) {
    const double height = extents(mesh.points).y();
    // A person of 1.7 m has 0.06 m3; a folded sheet has none.
    if (volume(mesh) < 1e-4 * height * height * height)
        refuse(path, "the surface encloses no volume (" + decimals(1e3 * volume(mesh), 3) +
                         " litres); a closed body was expected");
}

} // namespace

Vec3 in_metres(const Vec3& p, const AvatarAxes& axes) {
    const Vec3 q = axes.metres_per_unit * p;
    return axes.z_up ? Vec3(q.x(), q.z(), -q.y()) : q;
}

ReadAvatar read_avatar(const std::string& path, const ReadAvatarOptions& options) {
    Polygons polygons = read_polygons(path, options.max_bytes);
    ReadAvatar result;
    result.body = split_polygons(std::move(polygons), path, result.notes);
    if (const int unused = drop_unused_points(result.body); unused > 0)
        result.notes.push_back(counted(unused, "point", "points") + " without a face left out");
    result.axes = settle_frame(result.body, path, result.notes);
    make_closed(result.body, options.repair, path, result.notes);
    expect_volume(result.body, path);
    return result;
}

} // namespace toile
