// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// One drape on its way. Internal to the stages of a drape, as the headers pull_shut, sew_up, take_apart and
// settle_level are; others include drape.h.

#include "draping/cloth.h"
#include "draping/decisions.h"
#include "draping/drape.h"
#include "draping/lay.h"
#include "draping/solve/settle.h"
#include "geometry/memory.h"

#include <chrono>
#include <cmath>
#include <map>
#include <optional>

namespace toile {

inline constexpr double seam_pull = 6; ///< N per metre of seam: what a far open seam pulls with
inline constexpr double tight = 2e-3;  ///< m by which a section must be too short to count as too small

/// What the stages share. Each stage reads where the one before has left the cloth and leaves it for the
/// next.
struct DrapeRun {
    using Clock = std::chrono::steady_clock;

    const Staging& staging;
    const TriMesh& avatar;
    const PanelFabrics& fabrics;
    const DrapeOptions& options;
    DrapeResult result = {};

    Clock::time_point started = Clock::now();
    MemoryUse memory_before = memory_use();
    double used_before = 0, per_power = 0; ///< see fits_memory()
    int told = 0;                          ///< calls of tell()
    double density = 0;
    bool stopped = false;      ///< by the caller, by time or by memory
    std::string stopped_by = {};
    int iterations_left = 0;
    double share_begin = 0, share_end = 0; ///< of the whole, of the stage at work
    double done = 0;
    std::string stage = {};
    int level = 0;

    TriMesh body = {};         ///< that the level at work touches
    Garment garment = {};      ///< of the level at work, closed
    std::vector<int> joined = {}; ///< its node of every one of the open garment, on the coarsest level
    Points x = {};             ///< nodes of the garment
    Laid laid = {};            ///< the coarsest level where it starts out
    std::vector<std::string> held = {}, carried = {}; ///< labels of hooks that stay, and of those that are let go
    std::map<std::string, double> carried_at = {}; ///< mean height of each of these where the file puts it
    bool open = false;         ///< a seam could not be closed
    bool loose = false;        ///< the coarsest level started out hardly strained
    bool sliding = false;      ///< a level was given up since it slid off: those after it would as well
    DrapeFacts facts = {};

    static double seconds_since(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }
    int levels() const { return int(staging.levels.size()); }
    double edge_length() const { return staging.levels[level].edge_length; }
    /// Of the work of all levels, each four times that of the one before.
    double level_share() const { return std::pow(4.0, level) / ((std::pow(4.0, levels()) - 1) / 3); }
    bool last_level() const { return level + 1 == levels(); }

    /// Begins a stage that takes this share of the whole.
    void begin(const char* name, double share);

    /// Books the seconds since `start` as those of a stage of the level at work.
    void book(const std::string& name, Clock::time_point start);

    /// Ends the run; who did so first is kept.
    void stop(const std::string& by);

    /// Bytes: what is in use, or was for a moment since the drape began.
    double memory() const;

    /// Stops the run when level `next` would not fit. What it adds is estimated from what `last`, the level
    /// before it, has added. Returns whether the run goes on.
    bool fits_memory(int next, int last = -1);

    /// Looks at the limits and tells the caller how far the stage has come (`within`, [0, 1]). Returns
    /// whether the run goes on.
    bool tell(double within, double residual);

    /// Settles within the limits of the run, and as long as o.progress wants, and books the work on the level.
    SettleResult settle_some(ClothProblem& problem, Points& at, Cholesky& factor, SettleOptions o);

    /// A coarse mesh cannot fold as finely as the cloth would and must be let shrink instead, or it locks.
    PanelFabrics level_fabrics() const;

    /// Of the level at work.
    ContactOptions contact_options() const;
};

/// Labels of all hooks: those that stay, then those that are let go.
std::vector<std::string> all_hooked(const DrapeRun& run);

/// Hooks with no more than twice the garment's weight in all, or what its open seams pull with.
std::vector<HookSpring> hooks_on(const DrapeRun& run, const Garment& garment, const std::vector<std::string>& labels,
                                 const ClothProblem& problem);

/// Whether cloth at this height, or nearer to it than `reach`, touches the body.
bool touches_body(const ClothProblem& problem, const Points& x, double height, double reach);

/// Height of the armpits of the whole body, m; nothing when it is no figure.
std::optional<double> armpit_height(const DrapeRun& run);

} // namespace toile
