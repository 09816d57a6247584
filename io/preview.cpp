// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/preview.h"

#include "geometry/parallel.h"
#include "io/colours.h"
#include "io/write_file.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

namespace toile {
namespace {

constexpr unsigned cloth_id = 0, body_id = 1;
constexpr double lift =
    2e-4; // m, off the surface before a second ray: above float rounding, below the clearance

struct DeviceClose {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
};
struct SceneClose {
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceClose>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneClose>;

// ---- what is seen
// -------------------------------------------------------------------------------------------

/// A surface with what its shading needs at every point. `open` is the share of the sky that a point sees
/// from its front [0] and its back [1].
struct Surface {
    Points x;
    std::vector<Triangle> triangles;
    Points normal;
    std::array<std::vector<double>, 2> open;
};

Surface make_surface(const Points& x, const std::vector<Triangle>& triangles) {
    Surface s{x, triangles, Points(x.size(), Vec3::Zero()), {}};
    for (const Triangle& t : triangles) {
        const Vec3& o = x[std::size_t(t[0])];
        const Vec3 n = (x[std::size_t(t[1])] - o).cross(x[std::size_t(t[2])] - o);
        for (const int v : t)
            s.normal[std::size_t(v)] += n;
    }
    for (Vec3& n : s.normal)
        n.normalize();
    return s;
}

struct World {
    Device device;
    Scene scene;
    Surface cloth, body;
};

void attach(World& world, const Surface& surface, unsigned id) {
    RTCGeometry geometry = rtcNewGeometry(world.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* p = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surface.x.size()));
    for (const Vec3& v : surface.x)
        for (int k = 0; k < 3; ++k)
            *p++ = float(v[k]);
    auto* t =
        static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                       3 * sizeof(unsigned), surface.triangles.size()));
    for (const Triangle& triangle : surface.triangles)
        for (const int v : triangle)
            *t++ = unsigned(v);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(world.scene.get(), geometry, id);
    rtcReleaseGeometry(geometry);
}

RTCRay make_ray(const Vec3& from, const Vec3& along, double reach) {
    RTCRay ray{};
    ray.org_x = float(from.x());
    ray.org_y = float(from.y());
    ray.org_z = float(from.z());
    ray.dir_x = float(along.x());
    ray.dir_y = float(along.y());
    ray.dir_z = float(along.z());
    ray.tfar = float(reach);
    ray.mask = ~0u;
    return ray;
}

bool occluded(const World& world, const Vec3& from, const Vec3& along, double reach) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray = make_ray(from, along, reach);
    rtcOccluded1(world.scene.get(), &context, &ray);
    return ray.tfar < 0;
}

/// Directions of equal weight under the cosine, on a spiral: the same set everywhere, so that neighbours
/// agree and nothing speckles.
Points cosine_directions(int count) {
    Points out;
    for (int i = 0; i < count; ++i) {
        const double r = std::sqrt((i + 0.5) / count), angle = i * EIGEN_PI * (3 - std::sqrt(5.0));
        out.emplace_back(r * std::cos(angle), r * std::sin(angle), std::sqrt(1 - r * r));
    }
    return out;
}

double share_of_sky(const World& world, const Vec3& p, const Vec3& n, const Points& directions) {
    constexpr double reach = 0.35;
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), n);
    int free = 0;
    for (const Vec3& d : directions)
        free += !occluded(world, p + lift * n, turn * d, reach);
    return double(free) / double(directions.size());
}

void find_open(const World& world, Surface& surface, int sides, double low, double high) {
    const Points directions = cosine_directions(40);
    for (int side = 0; side < sides; ++side) {
        auto& open = surface.open[std::size_t(side)];
        open.assign(surface.x.size(), 1.0);
        parallel_for(int(surface.x.size()), 256, [&](int begin, int end) {
            for (auto v = std::size_t(begin); v < std::size_t(end); ++v)
                if (surface.x[v].y() > low && surface.x[v].y() < high)
                    open[v] =
                        share_of_sky(world, surface.x[v], (side ? -1 : 1) * surface.normal[v], directions);
        });
    }
}

// ---- what is drawn on the cloth
// -----------------------------------------------------------------------------

enum class Line : std::uint8_t { none, seam, border };

struct Drawing {
    std::vector<std::array<Line, 3>> line;     ///< per triangle, opposite its corners
    std::vector<std::array<double, 3>> height; ///< m, of the triangle over that edge
    std::vector<int> panel;
    std::vector<double> heat; ///< per node; empty: panels are told apart
};

Drawing make_drawing(const Garment& g, const Points& x) {
    Drawing d;
    d.panel = g.panel_of_triangle;
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        const Triangle n = g.nodes(int(t));
        const auto at = [&](std::size_t k) -> const Vec3& { return x[std::size_t(n[k % 3])]; };
        const double area2 = (at(1) - at(0)).cross(at(2) - at(0)).norm();
        std::array<Line, 3> line{};
        std::array<double, 3> height{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto e = std::size_t(g.edges.of_triangle[t][k]);
            line[k] = g.seam_edge[e]                      ? Line::seam
                      : g.edges.triangles_at(int(e)) == 1 ? Line::border
                                                          : Line::none;
            height[k] = area2 / std::max((at(k + 2) - at(k + 1)).norm(), 1e-12);
        }
        d.line.push_back(line);
        d.height.push_back(height);
    }
    return d;
}

/// How dark the ink is at barycentric (b0, b1, b2) of a triangle, in [0, 1].
double ink(const Drawing& d, std::size_t t, const Vec3& b, double pixel) {
    const double seam_half = std::max(0.9 * pixel, 6e-4), border_width = std::max(1.5 * pixel, 1e-3);
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double distance = b[Eigen::Index(k)] * d.height[t][k];
        if (d.line[t][k] == Line::seam && distance < seam_half) most = std::max(most, 0.72);
        if (d.line[t][k] == Line::border && distance < border_width) most = std::max(most, 0.55);
    }
    return most;
}

// ---- views and light
// ----------------------------------------------------------------------------------------

/// A view without perspective: `right`, `up` and `back` (toward the eye) are a right-handed frame.
struct View {
    Vec3 right, back, centre;
    int width = 0, height = 0;
    double pixel = 0; ///< m
    Vec3 up() const { return Vec3::UnitY(); }
};

/// A number in [0, 1) that differs much between neighbouring pixels and little between blocks of them, which
/// the eye takes for smoothness (Jimenez: interleaved gradient noise, 2014).
double dither(int column, int row) {
    const double inner = 0.06711056 * column + 0.00583715 * row;
    const double outer = 52.9829189 * (inner - std::floor(inner));
    return outer - std::floor(outer);
}

struct Hit {
    Vec3 place, normal; ///< normal toward the eye
    Vec3 albedo;
    double open = 1;
    bool cloth = false;
};

Hit describe(const World& world, const Drawing& drawing, const RTCRayHit& h, const View& view) {
    Hit hit;
    hit.cloth = h.hit.geomID == cloth_id;
    const Surface& s = hit.cloth ? world.cloth : world.body;
    const Triangle& t = s.triangles[h.hit.primID];
    const Vec3 b(1 - double(h.hit.u) - double(h.hit.v), h.hit.u, h.hit.v);
    Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
        place += b[Eigen::Index(k)] * s.x[std::size_t(t[k])];
        normal += b[Eigen::Index(k)] * s.normal[std::size_t(t[k])];
    }
    const Vec3 flat(h.hit.Ng_x, h.hit.Ng_y, h.hit.Ng_z);
    const bool wrong_side = flat.dot(view.back) < 0;
    if (normal.dot(flat) < 0) normal = flat; // a fold sharper than the mesh can show
    hit.normal = (wrong_side ? -normal : normal).normalized();
    hit.place = place + lift * (wrong_side ? -flat : flat).normalized();
    hit.open = 0;
    const auto& open = s.open[hit.cloth && wrong_side ? 1 : 0];
    for (std::size_t k = 0; k < 3; ++k)
        hit.open += b[Eigen::Index(k)] * open[std::size_t(t[k])];
    hit.albedo = body_colour();
    if (!hit.cloth) return hit;
    hit.albedo = panel_colour(drawing.panel[h.hit.primID]);
    if (!drawing.heat.empty()) {
        double heat = 0;
        for (std::size_t k = 0; k < 3; ++k) heat += b[Eigen::Index(k)] * drawing.heat[std::size_t(t[k])];
        hit.albedo = Vec3(0.75, 0.75 * (1 - heat), 0.75 * (1 - heat));
    }
    if (wrong_side) hit.albedo = 0.45 * hit.albedo + Vec3(0.22, 0.21, 0.20);
    hit.albedo *= 1 - ink(drawing, h.hit.primID, b, view.pixel);
    return hit;
}

Vec3 from_view(const View& view, double right, double up, double back) {
    return (right * view.right + up * view.up() + back * view.back).normalized();
}

/// A large soft key light from the upper left, a weak fill from the right, and the sky.
Vec3 shade(const World& world, const Hit& hit, const View& view, std::size_t sample, double turn) {
    const Vec3& n = hit.normal;
    // The four samples of a pixel see four places of the light.
    const double r = 0.14 * std::sqrt((double(sample) + 0.5) / 4),
                 angle = 2 * EIGEN_PI * (turn + 0.618 * double(sample));
    const Vec3 key = from_view(view, -0.62 + r * std::cos(angle), 0.62 + r * std::sin(angle), 0.72);
    const Vec3 fill = from_view(view, 0.85, 0.15, 0.55);
    double lit = std::max(0.0, n.dot(key));
    if (lit > 0 && occluded(world, hit.place, key, 3.0)) lit = 0;
    const double sky = (0.7 + 0.3 * n.y()) * hit.open * hit.open;
    const double soft = std::max(0.0, 0.15 + 0.85 * n.dot(fill)) * hit.open;
    const Vec3 light = 1.05 * lit * Vec3(1.0, 0.97, 0.93) + 0.34 * sky * Vec3(0.93, 0.97, 1.0) +
                       0.16 * soft * Vec3(0.95, 0.98, 1.0);
    // Cloth brightens where it turns away from the eye, as fibres do.
    const double rim = hit.cloth ? 0.06 * std::pow(1 - std::max(0.0, n.dot(view.back)), 3) * hit.open : 0;
    return hit.albedo.cwiseProduct(light) + Vec3::Constant(rim);
}

Vec3 background(double height_share) {
    return Vec3::Constant(0.80) + 0.12 * height_share * Vec3(0.96, 1.0, 1.04);
}

Vec3 look(const World& world, const Drawing& drawing, const View& view, int column, int row) {
    // A rotated grid: no two samples share a column or a row.
    static constexpr std::array<std::array<double, 2>, 4> offsets{
        {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};
    constexpr double far = 10;
    const double turn = dither(column, row);
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < offsets.size(); ++k) {
        const double u = (column + offsets[k][0] - 0.5 * view.width) * view.pixel;
        const double v = (0.5 * view.height - row - offsets[k][1]) * view.pixel;
        const Vec3 eye = view.centre + u * view.right + v * view.up() + far * view.back;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit h{};
        h.ray = make_ray(eye, -view.back, 2 * far);
        h.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(world.scene.get(), &context, &h);
        sum += h.hit.geomID == RTC_INVALID_GEOMETRY_ID
                   ? background(1 - double(row) / view.height)
                   : shade(world, describe(world, drawing, h, view), view, k, turn);
    }
    return sum / double(offsets.size());
}

// ---- the picture
// --------------------------------------------------------------------------------------------

struct Frame {
    Eigen::AlignedBox3d box; ///< what is in the picture
    double margin = 0;
};

Frame frame_of(const Points& x, const TriMesh& body) {
    Frame f;
    for (const Vec3& p : x)
        f.box.extend(p);
    const Vec3 centre = f.box.center(), garment = f.box.sizes();
    f.margin = 0.08 * garment.maxCoeff();
    // A wide garment is shown with the body above and below it, and a narrow one with the limbs beside it, so
    // that no view is wider than high.
    f.box.extend(centre + Vec3(0, 0.48 * garment.maxCoeff(), 0));
    f.box.extend(centre - Vec3(0, 0.48 * garment.maxCoeff(), 0));
    const double reach = 0.45 * f.box.sizes().y();
    for (const Vec3& p : body.points) {
        if (p.y() < f.box.min().y() - f.margin || p.y() > f.box.max().y() + f.margin) continue;
        const Vec3 aside = (p - centre).cwiseMax(-reach).cwiseMin(reach);
        f.box.extend(centre + Vec3(aside.x(), 0, aside.z()));
    }
    return f;
}

std::vector<View> make_views(const Frame& f, int height) {
    const double pixel = (f.box.sizes().y() + 2 * f.margin) / height;
    const auto view = [&](const Vec3& right, const Vec3& back) {
        const double width = f.box.sizes().cwiseProduct(right.cwiseAbs()).sum() + 2 * f.margin;
        return View{right, back, f.box.center(), std::max(1, int(std::ceil(width / pixel))), height, pixel};
    };
    return {view(Vec3::UnitX(), Vec3::UnitZ()), view(-Vec3::UnitX(), -Vec3::UnitZ()),
            view(-Vec3::UnitZ(), Vec3::UnitX())};
}

struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

void render(Image& image, int at, const World& world, const Drawing& drawing, const View& view) {
    parallel_for(view.height, 8, [&](int begin, int end) {
        for (int row = begin; row < end; ++row)
            for (int column = 0; column < view.width; ++column) {
                const Vec3 colour = look(world, drawing, view, column, row);
                for (int k = 0; k < 3; ++k)
                    image.rgb[std::size_t((row * image.width + at + column) * 3 + k)] =
                        std::uint8_t(std::lround(255 * srgb(std::clamp(colour[k], 0.0, 1.0))));
            }
    });
}

std::string png(const Image& image) {
    std::string bytes;
    const auto append = [](void* out, void* data, int size) {
        static_cast<std::string*>(out)->append(static_cast<const char*>(data), std::size_t(size));
    };
    stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), 3 * image.width);
    return bytes;
}

World make_world(const Garment& garment, const Points& x, const TriMesh& body, const Frame& frame) {
    World world;
    world.device.reset(rtcNewDevice(nullptr));
    world.scene.reset(rtcNewScene(world.device.get()));
    rtcSetSceneFlags(world.scene.get(), RTC_SCENE_FLAG_ROBUST);
    world.cloth = make_surface(x, node_triangles(garment));
    world.body = make_surface(body.points, body.triangles);
    attach(world, world.cloth, cloth_id);
    if (!body.triangles.empty()) attach(world, world.body, body_id);
    rtcCommitScene(world.scene.get());
    const double low = frame.box.min().y() - 2 * frame.margin, high = frame.box.max().y() + 2 * frame.margin;
    find_open(world, world.cloth, 2, low, high);
    find_open(world, world.body, 1, low, high);
    return world;
}

} // namespace

void write_preview(const std::string& path, const Garment& garment, const Points& x, const TriMesh& body,
                   const PreviewOptions& options) {
    const Frame frame = frame_of(x, body);
    const std::vector<View> views = make_views(frame, std::clamp(options.height, 16, 8192));
    const World world = make_world(garment, x, body, frame);
    Drawing drawing = make_drawing(garment, x);
    drawing.heat = options.heat;
    Image image;
    const int gap = options.height / 60;
    for (const View& v : views)
        image.width += v.width + gap;
    image.width -= gap;
    image.height = views[0].height;
    image.rgb.assign(std::size_t(image.width) * std::size_t(image.height) * 3, 255);
    int at = 0;
    for (const View& v : views) {
        render(image, at, world, drawing, v);
        at += v.width + gap;
    }
    write_file(path, png(image));
}

} // namespace toile
