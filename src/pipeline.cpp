// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/pipeline.h"

#include "geometry/parallel.h"
#include "io/companion.h"
#include "io/hash.h"
#include "io/point_cache.h"
#include "geometry/text.h"
#include "io/preview.h"
#include "io/read_avatar.h"
#include "io/read_sequence.h"
#include "io/start_from.h"
#include "io/write_file.h"
#include "draping/drape_to_accuracy.h"
#include "draping/hooks.h"
#include "patterns/shrink.h"
#include "sewing/blas.h"
#include "src/drape_input.h"
#include "src/exit_code.h"
#include "src/quantity.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

namespace fs = std::filesystem;

namespace toile {
namespace {

constexpr std::uintmax_t max_file = std::uintmax_t(1) << 30;

constexpr double most_frames = 4e9;        // bytes of all positions of an animation
constexpr double most_animation = 1 << 30; // bytes of a GLB, as large as those that are read

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

/// The file of a frame: name.0001.obj for name.obj.
std::string numbered(const std::string& path, int frame) {
    const fs::path p(path);
    return (p.parent_path() / (p.stem().string() + text(".%04d", frame) + p.extension().string())).string();
}

/// The garment files that have point caches beside them.
std::vector<std::string> cached(const DrapeJob& job) {
    std::vector<std::string> garments;
    for (const std::string& path : job.garments)
        if ((is_animated(job.drape) || job.sequence_rate > 0) && garment_format(path) == GarmentFormat::obj)
            garments.push_back(path);
    return garments;
}

std::vector<std::string> targets(const DrapeJob& job) {
    std::vector<std::string> garments = job.garments, all;
    if (!job.avatar_sequence.empty()) garments.clear();
    for (const int frame : frame_numbers(job.avatar_sequence))
        for (const std::string& garment : job.garments) garments.push_back(numbered(garment, frame));
    for (const std::string& garment : garments)
        for (const std::string& file : garment_files(garment))
            all.push_back(file);
    for (const std::string& garment : cached(job))
        for (const std::string& file : cache_files(garment)) all.push_back(file);
    if (!job.preview.empty()) all.push_back(job.preview);
    if (!job.report.empty()) all.push_back(job.report);
    return all;
}

/// Everything that shapes the result.
std::string input_hash(const DrapeJob& job, const std::vector<std::string>& files) {
    Hash hash;
    const auto add_file = [&](const std::string& path) {
        if (!path.empty() && fs::exists(path)) hash.add(read_file(path, max_file));
        hash.add(std::string_view("", 1));
    };
    add_file(job.pattern);
    add_file(companion_path(job.pattern));
    add_file(job.avatar);
    add_file(job.from);
    for (const std::string& frame : job.avatar_sequence) add_file(frame);
    hash.add(job.fabric);
    for (const std::string& file : files) add_file(file);
    for (const std::string& word : job.drape.hold)
        hash.add("hold " + word + '\n');
    hash.add(std::string("contact ") + to_string(response_of(job.drape)) + '\n');
    const MethodOptions& how = job.drape.method_options;
    hash.add(std::string("method ") + to_string(job.drape.method) + ' ' + to_string(how.limits.order) +
             (how.limits.shear ? " shear" : "") + (how.projected ? "" : " exact") + '\n');
    for (const double value :
         {double(how.limits.sweeps), how.time_step, how.damping_time, how.beyond, job.form.height, job.form.bust, job.form.waist, job.form.hip, job.edge_length, job.drape.tolerance,
          job.drape.clearance, job.drape.friction, job.drape.cloth_friction, job.drape.gravity})
        hash.add(std::to_string(value) + ' ');
    if (is_to_accuracy(job)) hash.add(std::to_string(job.accuracy) + ' ' + std::to_string(job.accuracy_seconds) + (job.accuracy_of == AccuracyOf::strain ? " accuracy of strain " : " accuracy "));
    if (const AnimateOptions& a = job.drape.animation; is_animated(job.drape))
        for (const double value : {a.duration, a.rate, a.air_damping}) hash.add(std::to_string(value) + " animation ");
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

/// What a panel that is not flat at rest cannot have.
void note_moulded(const DrapeJob& job, const Panel& panel, std::vector<std::string>& warnings) {
    if (!job.from.empty())
        throw InputError(job.from + " cannot be started from: panel " + panel.name + " has a rest mesh, and a drape is taken up by the "
                                    "places of flat panels");
    if (job.drape.method != Method::equilibrium)
        warnings.push_back("panel " + panel.name + " is not flat at rest; " + to_string(job.drape.method) +
                           " takes the lengths of its rest mesh alone, and bends it from flat");
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

/// All frames of an animation are held until they are written.
void refuse_too_many_frames(const DrapeJob& job, const Garment& garment) {
    if (!is_animated(job.drape)) return;
    const double frames = frame_count(job.drape.animation), vertices = double(garment.uv.size());
    const double held = frames * vertices * sizeof(Vec3), most = std::min(job.drape.max_memory, most_frames);
    const std::string motion = text("a motion of %.0f frames of %.0f vertices", frames, vertices);
    const std::string advice = "; ask for less time, fewer frames per second or a coarser mesh";
    if (held > most)
        throw InputError(motion + " takes " + show_size(held) + " of memory, more than the " + show_size(most) +
                         " that it may take" + advice);
    const double bytes = animation_bytes(garment, int(frames));
    if (writes_floats(job) && bytes > most_animation)
        throw InputError(motion + " makes a GLB of about " + show_size(bytes) + ", more than the " +
                         show_size(most_animation) + " that are written" + advice);
}

/// A drape to an accuracy chooses its meshes.
void refuse_meshes_of_their_own(const DrapeJob& job, const Pattern& pattern) {
    if (is_staged(job.pattern))
        throw InputError(job.pattern + " is a mesh already; --accuracy chooses meshes, for which it needs a pattern");
    if (const Panel* panel = moulded_panel(pattern))
        throw InputError("panel " + panel->name + " keeps the triangles of " + panel->rest->file +
                         "; --accuracy chooses meshes, for which it needs panels that are flat at rest");
}

AccuracyOptions accuracy_options(const DrapeJob& job, const Pattern& pattern) {
    AccuracyOptions o;
    o.of = job.accuracy_of;
    o.asked = job.accuracy;
    if (job.accuracy_seconds > 0) o.budget = job.accuracy_seconds;
    o.finest = std::max(o.finest, finest_edge(pattern, job.drape.max_memory));
    o.mesh = [&pattern](double edge_length, const PlaceFactor& size) {
        PlaceFactor in_panel;
        if (size) in_panel = [&](int panel, const Vec2& at) { return size(panel, to_rest(pattern.panels[panel]) * at); };
        return stage(pattern, flat_of(pattern, edge_length, false, in_panel));
    };
    return o;
}

/// The body of a job, and its further frames.
ReadSequence read_motion(const DrapeJob& job) {
    if (!job.avatar_sequence.empty()) {
        ReadAvatarOptions options;
        options.repair = job.repair_avatar;
        return read_sequence(job.avatar_sequence, options);
    }
    Body body = read_body(job.avatar, job.form, job.repair_avatar);
    return {std::move(body.mesh), {}, std::move(body.notes)};
}

/// The garment files of one frame; of no sequence, those that were asked for, with their motion if there is one.
void write_garments(const DrapeJob& job, const Garment& garment, const Points& x, const TriMesh& body, int frame,
                    const PointFrames* motion = nullptr) {
    WriteOptions options = job.write;
    options.motion = motion;
    options.avatar = job.with_avatar ? &body : nullptr;
    for (const std::string& path : job.garments)
        write_garment(job.avatar_sequence.empty() ? path : numbered(path, frame), garment, x, options);
}

void write_dressed(const DrapeJob& job, const DrapeOutcome& outcome) {
    const Garment& garment = outcome.result.garment;
    const Points& x = outcome.result.state.positions;
    const std::vector<int> numbers = frame_numbers(job.avatar_sequence);
    const bool animated = is_animated(job.drape);
    const std::vector<Points> dressed{x}; // the first frame of a sequence, and all there is if it does not follow
    const PointFrames motion{animated ? outcome.result.frames : dressed, animated ? job.drape.animation.rate : job.sequence_rate};
    write_garments(job, garment, x, outcome.body, numbers.empty() ? 0 : numbers[0], animated ? &motion : nullptr);
    for (const std::string& path : cached(job)) write_caches(path, motion, job.write);
    if (!job.preview.empty()) write_preview(job.preview, garment, x, outcome.body);
}

/// Tells of part of a job, from `begin` to `end` of the whole.
std::function<bool(const DrapeProgress&)> part_of_job(const DrapeJob& job, double begin, double end) {
    if (!job.drape.progress) return {};
    return [tell = job.drape.progress, begin, end](DrapeProgress p) {
        p.done = begin + (end - begin) * p.done;
        if (end < 1) p.seconds_left = std::numeric_limits<double>::infinity();
        return tell(p);
    };
}

/// Lets the dressed garment follow the body through the frames and writes each that is done.
void follow_sequence(const DrapeJob& job, const DrapeInput& input, const std::vector<Points>& frames,
                     DrapeOptions options, DrapeOutcome& outcome) {
    const std::vector<int> numbers = frame_numbers(job.avatar_sequence);
    const std::vector<Triangle> cloth = node_triangles(outcome.result.garment);
    std::vector<IntersectionCount> rounded;
    std::vector<Points> garments{outcome.result.state.positions}; // for the caches
    options.progress = part_of_job(job, 1 / double(numbers.size()), 1);
    FollowOptions how;
    how.done = [&](int k, const Points& x) {
        const TriMesh body{frames[k], outcome.body.triangles};
        write_garments(job, outcome.result.garment, x, body, numbers[k + 1]);
        if (job.sequence_rate > 0) garments.push_back(x);
        if (writes_floats(job))
            rounded.push_back(
                count_intersections(cloth, rounded_to_float(x), body, outcome.result.garment.stitches));
    };
    const auto reports = follow(input.staging, outcome.result, outcome.body, frames, input.fabrics, options, how);
    for (const std::string& path : cached(job)) write_caches(path, {garments, job.sequence_rate}, job.write);
    for (std::size_t k = 0; k < reports.size(); ++k) {
        FrameRow& row = outcome.frames.emplace_back(FrameRow{numbers[k + 1], reports[k]});
        if (rounded.empty()) continue;
        IntersectionCount& n = row.report.intersections;
        n.cloth_avatar = std::max(n.cloth_avatar, rounded[k].cloth_avatar);
        n.cloth_cloth = std::max(n.cloth_cloth, rounded[k].cloth_cloth);
    }
    outcome.result.decisions.push_back(
        text("the garment followed %d of %d further frames by statics, with at most %d iterations for a frame to come "
             "to rest and %d motions of the body on the way to it",
             int(reports.size()), int(frames.size()), how.max_iterations, how.max_substeps));
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

bool converged(const DrapeJob& job, const DrapeOutcome& outcome) {
    const auto came_to_rest = [](const FrameRow& row) { return row.report.status == FrameStatus::converged; };
    const DrapeStatus status = outcome.result.status;
    return (status == DrapeStatus::converged || status == DrapeStatus::animated) &&
           outcome.frames.size() + 1 >= job.avatar_sequence.size() &&
           std::all_of(outcome.frames.begin(), outcome.frames.end(), came_to_rest);
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
    std::vector<std::string> inputs = job.avatar_sequence;
    inputs.insert(inputs.end(), {job.pattern, companion_path(job.pattern), job.avatar});
    refuse_targets(inputs, targets(job));

    Pattern pattern;
    if (!is_staged(job.pattern)) pattern = sound_pattern(job.pattern, context.warnings);
    ReadSequence sequence = read_motion(job);
    const TriMesh& body = outcome.body = std::move(sequence.body);
    context.decisions = sequence.notes;
    Points core;
    parallel_both([&] { core = smoothed_toward_core(body, 0.01); },
                  [&] { context.body_measures = measures_of(body, context.decisions); });
    const Avatar avatar{body, std::move(core)};
    watch.lap(context, "read");

    if (is_to_accuracy(job)) refuse_meshes_of_their_own(job, pattern);
    const DrapeInput input = is_staged(job.pattern)
                                 ? read_staged_input(job.pattern, job.fabric, body)
                                 : input_of(pattern, job.fabric, is_to_accuracy(job) ? first_accuracy_edge : job.edge_length, job.drape.max_memory,
                                            needs_grain_lattice(job.drape.method));
    if (const Panel* panel = moulded_panel(pattern)) note_moulded(job, *panel, context.warnings);
    context.input_hash = input_hash(job, input.files);
    context.decisions.insert(context.decisions.end(), input.notes.begin(), input.notes.end());
    refuse_targets(input.files, targets(job));
    refuse_unknown_labels(job, input.staging);
    refuse_too_many_frames(job, input.staging.levels.back().garment);
    watch.lap(context, is_staged(job.pattern) ? "read" : "triangulate");

    DrapeOptions options = job.drape;
    options.max_seconds -= watch.total();
    options.from = earlier_positions(job.from, input.staging, context.decisions);
    options.progress = part_of_job(job, 0, 1 / double(1 + sequence.frames.size()));
    outcome.result = is_to_accuracy(job) ? drape_to_accuracy(accuracy_options(job, pattern), avatar, input.fabrics, options)
                                      : drape(input.staging, avatar, input.fabrics, options);
    if (job.interrupted && job.interrupted())
        outcome.result.where = "stopped by a signal before it had converged";
    watch.skip();

    write_dressed(job, outcome);
    watch.lap(context, "write");

    const bool whole = outcome.result.status != DrapeStatus::limit && can_follow(outcome.result, outcome.body);
    if (!sequence.frames.empty() && whole) {
        options.max_seconds = job.drape.max_seconds - watch.total();
        follow_sequence(job, input, sequence.frames, options, outcome);
        watch.lap(context, "follow");
    } else if (!sequence.frames.empty()) {
        context.warnings.push_back("the garment does not follow the sequence: its drape was stopped, its seams are open or it "
                                   "crosses something");
    }

    context.frames = outcome.frames;
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
