// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape_run.h"

#include "draping/cloth_part.h"
#include "draping/hooks.h"
#include "draping/settle_cloth.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace toile {

namespace {

constexpr double contact_share = 0.06;     // of the edge length: contact distance of levels that are not the last
constexpr double coarse_compression = 0.2; // of the fabric's, on levels that are not the last
constexpr double near = 0.9;               // of the memory limit; the rest is for what is taken between two looks
constexpr int memory_every = 4;            // calls of tell(): asking the system takes as long as a short loop over the cloth
constexpr double growth = 1.2;             // power of the vertices with which memory grows; factors outgrow meshes
constexpr double least_bytes = 5e3;        // times that power: what a level takes, before more was seen

} // namespace

void DrapeRun::begin(const char* name, double share) {
    stage = name;
    share_begin = share_end;
    share_end = std::min(1.0, share_begin + share);
}

void DrapeRun::book(const std::string& name, Clock::time_point start) {
    const double s = seconds_since(start);
    result.levels.back().seconds += s;
    result.seconds.push_back({name, s});
}

void DrapeRun::stop(const std::string& by) {
    stopped = true;
    if (stopped_by.empty())
        stopped_by = text("stopped by %s after %.3g s at the stage ", by.c_str(), seconds_since(started)) + stage;
}

double DrapeRun::memory() const {
    const MemoryUse use = memory_use();
    return use.peak > memory_before.peak ? use.peak : use.now;
}

bool DrapeRun::fits_memory(int next, int last) {
    const auto power = [&](int l) {
        return l < 0 ? 0.0 : std::pow(double(staging.levels[l].garment.uv.size()), growth);
    };
    const double used = memory();
    if (last > 0) per_power = std::max(per_power, (used - used_before) / (power(last) - power(last - 1)));
    used_before = used;
    const double needed = used + std::max(per_power, least_bytes) * (power(next) - power(last));
    if (needed > options.max_memory)
        stop(text("the memory limit of %.0f MB, before level %d would have taken about %.0f MB,",
                  options.max_memory / 1e6, next + 1, needed / 1e6));
    return !stopped;
}

bool DrapeRun::tell(double within, double residual) {
    done = std::max(done, share_begin + (share_end - share_begin) * std::clamp(within, 0.0, 1.0));
    const double so_far = seconds_since(started);
    if (so_far > options.max_seconds) stop("the time limit");
    if (const double used = told++ % memory_every == 0 ? memory() : 0; used > near * options.max_memory)
        stop(text("the memory limit of %.0f MB, with %.0f MB in use,", options.max_memory / 1e6, used / 1e6));
    if (options.progress) {
        DrapeProgress p;
        p.stage = stage;
        p.level = level;
        p.levels = levels();
        p.residual = residual;
        p.done = done;
        p.seconds_left = done > 0.02 ? so_far * (1 - done) / done : std::numeric_limits<double>::infinity();
        if (!options.progress(p)) stop("the caller");
    }
    return !stopped;
}

SettleResult DrapeRun::settle_some(ClothProblem& problem, Points& at, Cholesky& factor, SettleOptions o) {
    o.max_iterations = std::min(o.max_iterations, iterations_left);
    o.max_step = std::min(o.max_step, edge_length()); // farther, and lists of what may touch grow too long
    const double from = share_begin, span = share_end - share_begin;
    o.progress = [&, base = done, goes_on = o.progress](int i, double r) {
        const double within = (base - from) / std::max(span, 1e-9);
        return tell(within + (1 - within) * (1 - std::exp(-i / 60.0)), r) && (!goes_on || goes_on(i, r));
    };
    if (problem.sheet() && o.exact_below > 0)
        o.relax_part = [&](Points& y, const Eigen::VectorXd& step, double residual) {
            const int iterations = toile::relax_part(problem, y, step, residual, edge_length(), o);
            result.levels.back().part_iterations += iterations;
            return iterations > 0;
        };
    const SettleResult r = settle_cloth(problem, at, factor, o);
    result.residual = r.residual;
    if (r.iterations > 0) result.last_step = r.motion;
    iterations_left -= r.iterations;
    result.levels.back().iterations += r.iterations;
    result.levels.back().factorisations += r.factorisations;
    return r;
}

PanelFabrics DrapeRun::level_fabrics() const {
    PanelFabrics level = fabrics;
    if (!last_level())
        for (Fabric& f : level) {
            f.compression *= coarse_compression;
            f.curve_warp.clear(); // coarse cloth that is softer at first than where it is held slides off or lies in knots
            f.curve_weft.clear();
        }
    return level;
}

ContactOptions DrapeRun::contact_options() const {
    const double distance =
        last_level() ? options.clearance : std::max(options.clearance, contact_share * edge_length());
    ContactOptions o = barriers_at(distance, std::max(0.05, density));
    o.self = options.self_contact;
    return o;
}

std::vector<std::string> all_hooked(const DrapeRun& run) {
    std::vector<std::string> all = run.held;
    all.insert(all.end(), run.carried.begin(), run.carried.end());
    return all;
}

std::vector<HookSpring> hooks_on(const DrapeRun& run, const Garment& garment, const std::vector<std::string>& labels,
                                 const ClothProblem& problem) {
    std::map<std::string, double> heights;
    for (const std::string& label : labels) heights[label] = run.carried_at.at(label);
    const std::vector<double>& mass = problem.node_mass();
    double strength = 2 * 9.81 * std::accumulate(mass.begin(), mass.end(), 0.0);
    for (const Stitch& s : garment.stitches) strength += seam_pull * s.length;
    return make_hooks(garment, heights, strength);
}

bool touches_body(const ClothProblem& problem, const Points& x, double height, double reach) {
    const Points force = problem.contact().body_forces(problem.contact().active(x));
    for (std::size_t i = 0; i < x.size(); ++i)
        if (force[i].squaredNorm() > 0 && std::abs(x[i].y() - height) < reach) return true;
    return false;
}

std::optional<double> armpit_height(const DrapeRun& run) {
    try {
        return measure_body(run.avatar).armpit_y;
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
}

} // namespace toile
