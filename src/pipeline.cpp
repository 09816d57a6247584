// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/pipeline.h"

#include "draping/algebra/cholesky.h"
#include "geometry/parallel.h"
#include "io/companion.h"
#include "io/hash.h"
#include "io/preview.h"
#include "io/read_avatar.h"
#include "io/read_pattern.h"
#include "io/report.h"
#include "io/start_from.h"
#include "io/write_file.h"
#include "patterns/check.h"
#include "patterns/curve.h"
#include "src/exit_code.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>

namespace fs = std::filesystem;

namespace toile {
namespace {

constexpr std::uintmax_t max_file = std::uintmax_t(1) << 30;
constexpr double max_triangles = 2e6;

/// Seconds of the stages, and of all.
class Stopwatch {
public:
    void lap(ReportContext& context, const std::string& stage) {
        const auto now = Clock::now();
        context.seconds.push_back({stage, seconds(last_, now)});
        last_ = now;
    }
    /// The time since the last lap belongs to stages that keep their own.
    void skip() { last_ = Clock::now(); }
    double total() const { return seconds(start_, Clock::now()); }

private:
    using Clock = std::chrono::steady_clock;
    static double seconds(Clock::time_point a, Clock::time_point b) {
        return std::chrono::duration<double>(b - a).count();
    }
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

std::vector<std::string> targets(const DrapeJob& job) {
    std::vector<std::string> all;
    for (const std::string& garment : job.garments)
        for (const std::string& file : garment_files(garment))
            all.push_back(file);
    if (!job.preview.empty()) all.push_back(job.preview);
    if (!job.report.empty()) all.push_back(job.report);
    return all;
}

/// Minutes of work must not end in a target that cannot be written or in an overwritten input.
void refuse_targets(const DrapeJob& job) {
    std::set<std::string> taken;
    for (const std::string& input : {job.pattern, companion_path(job.pattern), job.avatar})
        if (!input.empty()) taken.insert(fs::weakly_canonical(input).string());
    for (const std::string& target : targets(job)) {
        if (!taken.insert(fs::weakly_canonical(target).string()).second)
            throw InputError(target + " is to be written but is an input or named twice");
        check_writable(target);
    }
}

std::string common_fabric(const Pattern& pattern, const std::string& asked) {
    return !asked.empty() ? asked : !pattern.fabric.empty() ? pattern.fabric : "poplin";
}

Pattern sound_pattern(const std::string& path, std::vector<std::string>& warnings) {
    Pattern pattern = read_pattern(path);
    std::vector<std::string> errors;
    for (const Issue& issue : check(pattern)) {
        if (issue.severity == Severity::error) errors.push_back(issue.text);
        if (issue.severity == Severity::warning) warnings.push_back(issue.text);
    }
    if (errors.empty()) return pattern;
    const std::string more =
        errors.size() == 1 ? ""
                           : " ('toile check' lists this and " + std::to_string(errors.size() - 1) + " more)";
    throw InputError(path + ": " + errors[0] + more);
}

void refuse_too_fine(const Pattern& pattern, double edge_length) {
    double area = 0;
    for (const Panel& panel : pattern.panels)
        area += std::abs(signed_area(panel.outline));
    const double triangles = area / (std::sqrt(3.0) / 4 * edge_length * edge_length);
    if (triangles > max_triangles)
        throw InputError("at this edge length the pattern has about " +
                         std::to_string(long(triangles / 1e6)) + " million triangles, more than the " +
                         std::to_string(long(max_triangles / 1e6)) + " million that are draped");
}

/// Everything that shapes the result.
std::string input_hash(const DrapeJob& job) {
    Hash hash;
    const auto add_file = [&](const std::string& path) {
        if (!path.empty() && fs::exists(path)) hash.add(read_file(path, max_file));
        hash.add(std::string_view("", 1));
    };
    add_file(job.pattern);
    add_file(companion_path(job.pattern));
    add_file(job.avatar);
    add_file(job.from);
    hash.add(job.fabric);
    for (const double value :
         {job.form.height, job.form.bust, job.form.waist, job.form.hip, job.edge_length, job.drape.tolerance,
          job.drape.clearance, job.drape.friction, job.drape.gravity})
        hash.add(std::to_string(value) + ' ');
    return hash.text();
}

/// Cloth may be draped on anything; only a standing body has bust, waist and hip.
std::optional<BodyMeasures> measures_of(const TriMesh& body, std::vector<std::string>& notes) {
    try {
        return measure_body(body);
    } catch (const std::invalid_argument& error) {
        notes.push_back(std::string("ease is not measured: ") + error.what());
        return std::nullopt;
    }
}

FlatPattern triangulate_at(const Pattern& pattern, double edge_length) {
    refuse_too_fine(pattern, edge_length);
    TriangulateOptions options;
    options.edge_length = edge_length;
    options.levels = levels_for(edge_length);
    return triangulate(pattern, options);
}

Points earlier_positions(const std::string& path, const Pattern& pattern, const FlatPattern& flat,
                         std::vector<std::string>& notes) {
    if (path.empty()) return {};
    const ReadGarment earlier = read_garment(path);
    notes.insert(notes.end(), earlier.notes.begin(), earlier.notes.end());
    return start_from(earlier, close_seams(sew(pattern, flat.levels.back())), path);
}

bool writes_floats(const DrapeJob& job) {
    for (const std::string& path : job.garments)
        if (garment_format(path) == GarmentFormat::glb) return true;
    return false;
}

void write_all(const DrapeJob& job, DrapeOutcome& outcome) {
    const Garment& garment = outcome.result.garment;
    const Points& x = outcome.result.state.positions;
    WriteOptions options = job.write;
    options.avatar = job.with_avatar ? &outcome.body : nullptr;
    for (const std::string& path : job.garments)
        write_garment(path, garment, x, options);
    if (!job.preview.empty()) write_preview(job.preview, garment, x, outcome.body);
}

} // namespace

int levels_for(double edge_length) {
    int levels = 1;
    for (double coarsest = edge_length; coarsest < 0.04 - 1e-9; coarsest *= 2)
        ++levels;
    return levels;
}

PanelFabrics panel_fabrics(const Pattern& pattern, const std::string& fabric) {
    const std::string common = common_fabric(pattern, fabric);
    PanelFabrics fabrics;
    for (const Panel& panel : pattern.panels) {
        try {
            fabrics.push_back(fabric_preset(panel.fabric.empty() ? common : panel.fabric));
        } catch (const std::invalid_argument& error) {
            throw InputError("panel " + panel.name + ": " + error.what());
        }
    }
    return fabrics;
}

TriMesh form_of(const FormMeasures& measures) {
    try {
        return make_form(measures);
    } catch (const std::invalid_argument& error) {
        throw CommandLineError(error.what());
    }
}

Body read_body(const std::string& avatar, const FormMeasures& form, bool repair) {
    if (avatar.empty()) return {form_of(form), {}};
    ReadAvatarOptions options;
    options.repair = repair;
    ReadAvatar read = read_avatar(avatar, options);
    return {std::move(read.body), std::move(read.notes)};
}

DrapeOutcome run_job(const DrapeJob& job) {
    Stopwatch watch;
    ReportContext context;
    DrapeOutcome outcome;
    refuse_targets(job);

    const Pattern pattern = sound_pattern(job.pattern, context.warnings);
    const PanelFabrics fabrics = panel_fabrics(pattern, job.fabric);
    Body body = read_body(job.avatar, job.form, job.repair_avatar);
    context.decisions = body.notes;
    context.body_measures = measures_of(body.mesh, context.decisions);
    context.input_hash = input_hash(job);
    const Avatar avatar{body.mesh, smoothed_toward_core(body.mesh, 0.01)};
    watch.lap(context, "read");

    const FlatPattern flat = triangulate_at(pattern, job.edge_length);
    watch.lap(context, "triangulate");

    DrapeOptions options = job.drape;
    options.from = earlier_positions(job.from, pattern, flat, context.decisions);
    outcome.result = drape(pattern, flat, avatar, fabrics, options);
    if (job.interrupted && job.interrupted())
        outcome.result.where = "stopped by a signal before it had converged";
    outcome.body = std::move(body.mesh);
    watch.skip();

    write_all(job, outcome);
    watch.lap(context, "write");

    context.fabric = common_fabric(pattern, job.fabric);
    context.blas = blas_name();
    context.threads = threads();
    context.written_as_float = writes_floats(job);
    context.total_seconds = watch.total();
    outcome.report = report_json(outcome.result, outcome.body, fabrics, context);
    if (!job.report.empty()) write_file(job.report, outcome.report);
    outcome.written = targets(job);
    return outcome;
}

} // namespace toile
