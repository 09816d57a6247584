// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "io/read_sequence.h"
#include "src/quantity.h"
#include "src/options.h"
#include "src/pipeline.h"
#include "src/progress.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct DrapeArguments {
    DrapeJob job;
    bool edge_chosen = false;
    bool rate_chosen = false, air_chosen = false;
    bool sweeps_chosen = false, hessian_chosen = false, damping_chosen = false;
    int threads = 0;
    bool quiet = false, json = false;
};

/// Options that the method would ignore in silence.
void refuse_useless_method(const DrapeArguments& a) {
    const DrapeOptions& o = a.job.drape;
    const std::string method = std::string("the method ") + to_string(o.method);
    if (o.method != Method::equilibrium && !a.job.avatar_sequence.empty())
        throw CommandLineError(method + " drapes on a body at rest; a sequence of --avatar-sequence is followed by equilibrium");
    if (o.method_options.time_step > 0 && !is_animated(o) && !moves(o))
        throw CommandLineError("--time-step is that of a motion: " + method + " with the contact barrier has no time; name another "
                               "--method or --contact");
    if (a.damping_chosen && !has_damping(o.method))
        throw CommandLineError("--damping-time is that of springs and triangles: " + method + " has none");
    if (a.damping_chosen && !is_animated(o) && !moves(o))
        throw CommandLineError("--damping-time is that of a motion: " + method + " with the contact barrier comes to rest without any; "
                               "name another --contact, or --animate");
    if (!(o.method_options.damping_time >= 0 && o.method_options.damping_time <= 1))
        throw CommandLineError(text("--damping-time is %.3g s, expected 0 to 1 s", o.method_options.damping_time));
    if (a.sweeps_chosen && o.method != Method::springs_limited)
        throw CommandLineError("--limit and --sweep are about limits on springs, which " + method +
                               " does not have: name --method springs-limited");
    if (a.hessian_chosen && o.method != Method::triangles)
        throw CommandLineError("--hessian is about the steps of triangles, which " + method + " does not have: name --method triangles");
    if (a.hessian_chosen && !is_animated(o) && !moves(o))
        throw CommandLineError("--hessian is that of the steps of a motion: " + method + " with the contact barrier comes to rest without "
                               "any; name another --contact, or --animate");
}

/// The same of options about frames in time.
void refuse_useless_frames(const DrapeArguments& a) {
    const AnimateOptions& o = a.job.drape.animation;
    const bool animated = is_animated(a.job.drape), sequence = !a.job.avatar_sequence.empty();
    if (a.air_chosen && !animated) throw CommandLineError("--air-damping is about the motion that --animate records");
    if (a.rate_chosen && !animated && !sequence)
        throw CommandLineError("--fps is about the frames of --animate or --avatar-sequence: name one of them");
    if (animated && sequence)
        throw CommandLineError("--animate lets a garment go on a body at rest; name it or --avatar-sequence");
    if (animated && a.job.garments.empty())
        throw CommandLineError("--animate has nothing to write its frames to: name an .obj or .glb with -o");
    if (animated && a.job.drape.contact == ContactResponse::barrier)
        throw CommandLineError("--animate moves cloth in time, which --contact barrier cannot answer: name constraint, penalty, "
                               "impulse (the default) or rigid");
    if (animated && frame_count(o) < 2)
        throw CommandLineError(text("--animate asks for %.4g s, in which there is no second frame at %.4g per second", o.duration,
                                    o.rate));
    const auto is_obj = [](const std::string& path) { return garment_format(path) == GarmentFormat::obj; };
    if (a.rate_chosen && sequence && std::none_of(a.job.garments.begin(), a.job.garments.end(), is_obj))
        throw CommandLineError("--fps makes point caches beside the .obj files of an --avatar-sequence: name one with -o");
}

/// The same of what a drape to an accuracy chooses itself.
void refuse_useless_accuracy(const DrapeArguments& a) {
    if (!is_to_accuracy(a.job)) return;
    const auto refuse = [](const std::string& what) {
        throw CommandLineError("--accuracy " + what + "; leave one of them out");
    };
    if (a.edge_chosen) refuse("chooses edge lengths, and --edge-length names one");
    if (!a.job.from.empty()) refuse("starts from the pattern's own placement, and --from elsewhere");
    if (a.job.drape.method != Method::equilibrium) refuse("drapes by equilibrium, and --method names another");
    if (a.job.drape.contact.value_or(ContactResponse::barrier) != ContactResponse::barrier)
        refuse("has the contact barrier, and --contact names another");
    if (is_animated(a.job.drape)) refuse("is about cloth at rest, and --animate about its motion");
    if (!a.job.avatar_sequence.empty()) refuse("drapes on a body at rest, and --avatar-sequence is one in motion");
}

void refuse_useless(const DrapeArguments& a) {
    if (a.job.garments.empty() && a.job.report.empty() && a.job.preview.empty() && !a.json)
        throw CommandLineError("there is nothing to write: name a file with -o, --report or --preview");
    if (!a.job.avatar.empty() && !a.job.avatar_sequence.empty())
        throw CommandLineError("--avatar and --avatar-sequence both name the body");
    if (a.job.repair_avatar && a.job.avatar.empty() && a.job.avatar_sequence.empty())
        throw CommandLineError("--repair-avatar needs --avatar; the built-in form is closed");
    refuse_useless_method(a);
    refuse_useless_accuracy(a);
    refuse_formats(a.job.garments);
    refuse_useless_frames(a);
}

std::string percent(double share) {
    return text("%.2f %%", 100 * share);
}

void summarise_frames(std::ostream& out, const std::vector<FrameRow>& frames) {
    int converged = 0, with_body = 0, with_itself = 0;
    double seconds = 0;
    for (const FrameRow& f : frames) {
        converged += f.report.status == FrameStatus::converged;
        with_body += f.report.intersections.cloth_avatar;
        with_itself += f.report.intersections.cloth_cloth;
        seconds += f.report.seconds;
    }
    out << text("frames: %d followed, %d converged; intersections in all: %d with the body, %d of the cloth with "
                "itself; %.1f s per frame\n",
                int(frames.size()), converged, with_body, with_itself, seconds / double(frames.size()));
}

void summarise_motion(std::ostream& out, const MotionReport& m) {
    out << text("motion: %d frames at %.4g per second, %d steps of %.3g ms from one to the next; at most %.2g m/s at the end\n",
                m.frames, m.rate, m.steps_per_frame, 1e3 * m.time_step, m.speed);
}

void summarise_accuracy(std::ostream& out, const AccuracyReport& a) {
    const auto show = [&](double error) { return a.of == AccuracyOf::strain ? text("%.2g %% of strain", 100 * error) : show_length(error); };
    out << "accuracy: " << (a.estimate ? "about " + show(*a.estimate) : "unknown") << (a.asked ? " of " + show(*a.asked) : text(" in %g s", *a.budget))
        << (a.met ? "" : ", not met") << ", meshes of";
    for (const AccuracyMesh& m : a.meshes) out << text(" %.3g", 1e3 * m.edge_length);
    out << " mm\n";
}

/// The report in five lines, and one on the frames of a sequence or of a motion.
void summarise(std::ostream& out, const DrapeOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    const auto& strain = r["strain"];
    const std::string residual = r["residual"].is_null() ? "unknown" : text("%.1e", r["residual"].get<double>());
    out << r["status"].get<std::string>() << ": residual " << residual
        << text(" of %.1e, ", r["tolerance"].get<double>()) << r["nodes"] << " nodes, " << r["triangles"] << " triangles, "
        << text("%.1f s\n", r["seconds"]["total"].get<double>());
    out << "intersections: " << r["intersections"]["cloth_avatar"] << " with the body, "
        << r["intersections"]["cloth_cloth"] << " of the cloth with itself\n";
    out << "seams: "
        << (r["seam_gap_max"] == 0.0 ? "closed" : "open by up to " + show_length(r["seam_gap_max"])) << '\n';
    out << "stretch: warp to " << percent(strain["warp"]["max"]) << " of " << percent(strain["warp"]["limit"])
        << ", weft to " << percent(strain["weft"]["max"]) << " of " << percent(strain["weft"]["limit"])
        << "; compressed " << percent(strain["compressed_area"]) << " of the area\n";
    if (outcome.result.accuracy) summarise_accuracy(out, *outcome.result.accuracy);
    if (!outcome.frames.empty()) summarise_frames(out, outcome.frames);
    if (outcome.result.motion) summarise_motion(out, *outcome.result.motion);
    constexpr std::size_t most_names = 12; // of a sequence, the first and the last tell the others
    std::vector<std::string> written = outcome.written;
    if (written.size() > most_names) written = {written.front(), "...", written.back()};
    list_written(out, written);
}

std::string first_failure(const DrapeOutcome& outcome) {
    for (const auto& [frame, r] : outcome.frames)
        if (r.status != FrameStatus::converged)
            return text("frame %d: ", frame) + to_string(r.status) + ": " + r.where;
    return "not all frames were reached";
}

int drape_command(const DrapeArguments& arguments, const Console& console) {
    refuse_useless(arguments);
    set_threads(arguments.threads);
    DrapeJob job = arguments.job;
    job.avatar_sequence = sequence_files(job.avatar_sequence);
    if (arguments.rate_chosen && !is_animated(job.drape)) job.sequence_rate = job.drape.animation.rate;
    const Interrupt interrupt;
    ProgressLine line(console.err, console.terminal && !arguments.quiet);
    job.drape.progress = [&](const DrapeProgress& progress) {
        line.show(progress);
        return !interrupt.asked();
    };
    job.interrupted = [&] { return interrupt.asked(); };
    const DrapeOutcome outcome = run_job(job);
    line.clear();
    if (arguments.json) console.out << outcome.report << std::flush;
    if (!arguments.json && !arguments.quiet) {
        const auto report = nlohmann::json::parse(outcome.report);
        for (const auto& warning : report["warnings"])
            console.err << "warning: " << warning.get<std::string>() << '\n';
        summarise(console.out, outcome);
        console.out << std::flush;
    }
    if (interrupt.asked())
        console.err << "toile: stopped by a signal; the state reached was written" << std::endl;
    if (converged(job, outcome)) return exit_made;
    if (interrupt.asked()) return exit_not_converged;
    if (outcome.result.status == DrapeStatus::converged)
        console.err << "toile: " << first_failure(outcome) << "; every frame reached was written" << std::endl;
    else
        console.err << "toile: " << to_string(outcome.result.status)
                    << (outcome.result.where.empty() ? "" : ": " + outcome.result.where)
                    << "; the best state was written" << std::endl;
    return exit_not_converged;
}

std::string joined_by_bars(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : "|") + name;
    return text;
}

/// What --accuracy takes of one kind, and its range.
struct AskedKind {
    double (*parse)(const std::string&);
    double least, most;
    std::string range;
    void (*set)(DrapeJob&, double);
};

const std::vector<AskedKind>& asked_kinds() {
    static const std::vector<AskedKind> kinds{
        // below a tenth of a millimetre rounding of contact would count, above 5 cm any mesh does
        {parse_length, 1e-4, 0.05, "0.1 mm to 50 mm", [](DrapeJob& job, double v) { job.accuracy = v; }},
        {parse_share, 1e-4, 0.2, "0.01% to 20% of strain",
         [](DrapeJob& job, double v) { job.accuracy = v, job.accuracy_of = AccuracyOf::strain; }},
        {parse_duration, 1, 1e5, "1 s to 1e5 s", [](DrapeJob& job, double v) { job.accuracy_seconds = v; }}};
    return kinds;
}

/// --accuracy, which is without a default: an error of place, one of strain, or a time.
void set_accuracy(DrapeJob& job, const std::string& word) {
    job.accuracy = job.accuracy_seconds = 0;
    job.accuracy_of = AccuracyOf::place;
    std::string ranges;
    for (const AskedKind& kind : asked_kinds()) {
        ranges += (ranges.empty() ? "" : ", ") + kind.range;
        double value = 0;
        try {
            value = kind.parse(word);
        } catch (const CommandLineError&) {
            continue; // another kind
        }
        if (value < kind.least || value > kind.most) throw CLI::ValidationError("--accuracy", word + " is outside " + kind.range);
        kind.set(job, value);
        return;
    }
    throw CLI::ValidationError("--accuracy", "'" + word + "' is not a length such as 2mm, a strain such as 0.5% or a time such as 30s (" + ranges + ")");
}

void add_accuracy(CLI::App& command, DrapeJob& job) {
    command
        .add_option_function<std::string>(
            "--accuracy", [&job](const std::string& word) { set_accuracy(job, word); },
            "Error that the drape may have, of place or of strain, or time to make it as small as it goes: meshes are chosen for "
            "it during the run, by docs/accuracy.md")
        ->type_name("LENGTH|PERCENT|DURATION");
}

/// --method and what only some methods have.
void add_method(CLI::App& command, DrapeArguments& a) {
    DrapeOptions& drape = a.job.drape;
    std::vector<std::string> names;
    for (const Method m : all_methods()) names.push_back(to_string(m));
    command
        .add_option_function<std::string>(
            "--method", [&drape](const std::string& name) { drape.method = method_called(name); },
            "What cloth is modelled and brought to rest by, by docs/methods.md (default equilibrium)")
        ->check(CLI::IsMember(names).description(""))
        ->type_name(joined_by_bars(names));
    add_duration(command, "time-step", drape.method_options.time_step, 1e-7, 0.1,
                 "Step of a motion, of explicit methods that of their substeps (default 2 ms; inextensible and with the barrier 0.5 ms; what "
                 "is stable)");
    command
        .add_option_function<std::string>(
            "--damping-time",
            [&a](const std::string& time) {
                a.damping_chosen = true;
                a.job.drape.method_options.damping_time = parse_duration(time);
            },
            "Damping of springs and of triangles as a share of their stiffness (default 20us; 0s: none)")
        ->type_name("DURATION");
    command
        .add_option_function<std::string>(
            "--limit",
            [&a](const std::string& what) {
                a.sweeps_chosen = true;
                a.job.drape.method_options.limits.shear = what == "stretch-and-shear";
            },
            "What springs-limited limits (default stretch)")
        ->check(CLI::IsMember({"stretch", "stretch-and-shear"}).description(""))
        ->type_name("stretch|stretch-and-shear");
    command
        .add_option_function<std::string>(
            "--sweep",
            [&a](const std::string& order) {
                a.sweeps_chosen = true;
                a.job.drape.method_options.limits.order = sweep_order(order);
            },
            "The order in which it does so (default listed)")
        ->check(CLI::IsMember({"listed", "reversed", "longest-first", "from-top"}).description(""))
        ->type_name("listed|reversed|longest-first|from-top");
    command
        .add_option_function<std::string>(
            "--hessian",
            [&a](const std::string& kind) {
                a.hessian_chosen = true;
                a.job.drape.method_options.projected = kind == "projected";
            },
            "Second derivative that steps of triangles are solved with: exact, or positive semidefinite (default projected)")
        ->check(CLI::IsMember({"projected", "exact"}).description(""))
        ->type_name("projected|exact");
}

/// --animate and what goes with it.
void add_animate(CLI::App& command, DrapeArguments& a) {
    AnimateOptions& o = a.job.drape.animation;
    add_duration(command, "animate", o.duration, 1e-3, 3600,
                 "Let the sewn garment go and record its motion in real time: frames in the .glb, point caches (.pc2, .mdd) beside "
                 "the .obj");
    const auto add_number = [&command](const std::string& name, double& value, bool& chosen, CLI::Range range,
                                       const std::string& help) {
        command
            .add_option_function<double>(
                "--" + name, [&value, &chosen](double given) { value = given, chosen = true; }, help)
            ->check(range.description(""))
            ->type_name("NUMBER");
    };
    add_number("fps", o.rate, a.rate_chosen, CLI::Range(0.1, 10000.0),
               "Frames per second of --animate (default 24); with --avatar-sequence, point caches beside the .obj at this rate");
    add_number("air-damping", o.air_damping, a.air_chosen, CLI::Range(0.0, 1000.0),
               "Share of its speed, per second, that air takes from the cloth of --animate (default 1)");
}

} // namespace

void add_drape(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("drape", "Sew a pattern and drape it on a body");
    const auto a = std::make_shared<DrapeArguments>();
    DrapeJob& job = a->job;
    command.add_option("pattern", job.pattern, "Pattern, or a staged mesh (.obj)")->required()->type_name("FILE");
    command
        .add_option("--avatar", job.avatar,
                    "Body: OBJ, PLY, STL, GLB or COLLADA (default: the built-in form)")
        ->type_name("FILE");
    command
        .add_option("--avatar-sequence", job.avatar_sequence,
                    "Body in motion: meshes of one topology, a folder of them, or a pattern like walk.%04d.obj; dressed "
                    "in the first frame, followed through the others into numbered files")
        ->type_name("FILE...");
    command.add_flag("--repair-avatar", job.repair_avatar, "Close the holes of a leaky body");
    add_form_measures(command, job.form);
    add_fabric(command, job.fabric, "Fabric of panels that name none");
    add_length(command, "edge-length", job.edge_length, 0.001, 0.2, "Mean edge of the mesh");
    add_accuracy(command, job);
    command.add_option("-o,--output", job.garments, "Garment file to write, .obj or .glb; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("FILE");
    command.add_option("--report", job.report, "Report to write, JSON by docs/report.schema.json")
        ->type_name("FILE");
    command.add_option("--preview", job.preview, "Picture to write, PNG")->type_name("FILE");
    command.add_option("--from", job.from, "Garment file to start from, after an edit of the pattern")
        ->type_name("FILE");
    command.add_option("--tolerance", job.drape.tolerance, "Residual to reach (default 0.001)")
        ->check(CLI::Range(1e-9, 1.0).description(""))
        ->type_name("NUMBER");
    add_length(command, "clearance", job.drape.clearance, 5e-5, 0.01,
               "Distance from the body below which contact acts");
    const auto add_friction = [&command](const std::string& name, double& coefficient, const std::string& between) {
        command.add_option(name, coefficient, "Coulomb coefficient " + between + " (default: the largest of the fabrics')")
            ->check(CLI::Range(0.0, 10.0).description(""))
            ->type_name("NUMBER");
    };
    add_friction("--friction", job.drape.friction, "between cloth and body");
    add_friction("--cloth-friction", job.drape.cloth_friction, "between cloth and cloth");
    command
        .add_option_function<std::string>(
            "--contact", [&job](const std::string& name) { job.drape.contact = contact_response(name); },
            "What answers contact while the cloth comes to rest, by docs/responses.md (default barrier; impulse with --animate)")
        ->check(CLI::IsMember({"barrier", "constraint", "penalty", "impulse", "rigid"}).description(""))
        ->type_name("barrier|constraint|penalty|impulse|rigid");
    add_method(command, *a);
    add_animate(command, *a);
    command
        .add_option("--hold", job.drape.hold,
                    "Labelled edges held at their height to the end: a label of the file, or waist, collar, "
                    "armhole, \"strapless top\"; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("LABEL");
    add_duration(command, "max-seconds", job.drape.max_seconds, 0.001, 1e9,
                 "Time after which the state reached is written");
    add_size(command, "max-memory", job.drape.max_memory, 1e6, 1e15,
             "Memory before which the state reached is written");
    command.add_flag("--with-avatar", job.with_avatar, "Write the body into the garment files too");
    add_unit_and_up(command, job.write);
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback(
        [a, &chosen, &command] {
            a->edge_chosen = command.count("--edge-length") > 0;
            chosen = [a](const Console& console) { return drape_command(*a, console); };
        });
}

} // namespace toile
