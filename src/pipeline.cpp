// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/pipeline.h"

#include "draping/algebra/cholesky.h"
#include "geometry/parallel.h"
#include "io/companion.h"
#include "io/hash.h"
#include "io/preview.h"
#include "io/read_avatar.h"
#include "io/report.h"
#include "io/start_from.h"
#include "io/write_file.h"
#include "draping/hooks.h"
#include "src/drape_input.h"
#include "src/exit_code.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>

namespace fs = std::filesystem;

namespace toile {
namespace {

constexpr std::uintmax_t max_file = std::uintmax_t(1) << 30;

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
    for (const std::string& word : job.drape.hold)
        hash.add("hold " + word + '\n');
    hash.add(std::string("contact ") + to_string(job.drape.contact) + '\n');
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

Points earlier_positions(const std::string& path, const Staging& staging, std::vector<std::string>& notes) {
    if (path.empty()) return {};
    const ReadGarment earlier = read_garment(path);
    notes.insert(notes.end(), earlier.notes.begin(), earlier.notes.end());
    return start_from(earlier, close_seams(staging.levels.back().garment), path);
}

/// A misspelt word of --hold would let a garment fall in silence.
void refuse_unknown_labels(const DrapeJob& job, const Staging& staging) {
    const std::vector<std::string> labels = labels_of(staging.levels.back().garment);
    std::string list;
    for (const std::string& label : labels)
        list += (list.empty() ? "" : ", ") + label;
    for (const std::string& word : job.drape.hold)
        if (labels_called(word, labels).empty())
            throw InputError(job.pattern + ": no edge is labelled \"" + word + "\", which --hold names; " +
                             (list.empty() ? "it has no labelled edges" : "its labels are " + list));
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

void refuse_targets(const std::vector<std::string>& inputs, const std::vector<std::string>& targets) {
    std::set<std::string> taken;
    for (const std::string& input : inputs)
        if (!input.empty()) taken.insert(fs::weakly_canonical(input).string());
    for (const std::string& target : targets) {
        if (!taken.insert(fs::weakly_canonical(target).string()).second)
            throw InputError(target + " is to be written but is an input or named twice");
        check_writable(target);
    }
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
    refuse_targets({job.pattern, companion_path(job.pattern), job.avatar}, targets(job));

    Pattern pattern;
    if (!is_staged(job.pattern)) pattern = sound_pattern(job.pattern, context.warnings);
    Body body = read_body(job.avatar, job.form, job.repair_avatar);
    context.decisions = body.notes;
    context.body_measures = measures_of(body.mesh, context.decisions);
    context.input_hash = input_hash(job);
    const Avatar avatar{body.mesh, smoothed_toward_core(body.mesh, 0.01)};
    watch.lap(context, "read");

    const DrapeInput input = is_staged(job.pattern)
                                 ? read_staged_input(job.pattern, job.fabric, body.mesh)
                                 : input_of(pattern, job.fabric, job.edge_length, job.drape.max_memory);
    context.decisions.insert(context.decisions.end(), input.notes.begin(), input.notes.end());
    refuse_unknown_labels(job, input.staging);
    watch.lap(context, is_staged(job.pattern) ? "read" : "triangulate");

    DrapeOptions options = job.drape;
    options.max_seconds -= watch.total();
    options.from = earlier_positions(job.from, input.staging, context.decisions);
    outcome.result = drape(input.staging, avatar, input.fabrics, options);
    if (job.interrupted && job.interrupted())
        outcome.result.where = "stopped by a signal before it had converged";
    outcome.body = std::move(body.mesh);
    watch.skip();

    write_all(job, outcome);
    watch.lap(context, "write");

    context.fabric = input.fabric;
    context.blas = blas_name();
    context.threads = threads();
    context.written_as_float = writes_floats(job);
    context.total_seconds = watch.total();
    outcome.report = report_json(outcome.result, outcome.body, input.fabrics, context);
    if (!job.report.empty()) write_file(job.report, outcome.report);
    outcome.written = targets(job);
    return outcome;
}

} // namespace toile
