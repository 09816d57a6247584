// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/garment_scene.h"

#include "draping/carry_drape.h"
#include "draping/chart/scene_rest.h"
#include "draping/compare.h"
#include "draping/drape.h"
#include "geometry/text.h"
#include "src/drape_input.h"
#include "src/pipeline.h"

#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>

namespace toile {

namespace {

constexpr double start_edge = 0.08; // m, of the drape that all go on from,
constexpr double answer_edge = 0.01; // and of the equilibrium that they are held against
constexpr int meshes = 3;
constexpr double scale = 0.1; // m: an error of 1 % is a millimetre

class DressedForm {
public:
    DressedForm(Pattern pattern, TriMesh body) : pattern_(std::move(pattern)), avatar_{std::move(body), {}} {
        avatar_.start = smoothed_toward_core(avatar_.body, 0.01);
    }

    SceneCloth cloth(const std::shared_ptr<DressedForm>& self, double edge) {
        const auto input = std::make_shared<DrapeInput>(input_of(pattern_, "", edge));
        SceneCloth cloth = carried(*input);
        cloth.rest = [self, input](const Points& x, const SceneRestOptions& options) { return self->rest(*input, x, options); };
        return cloth;
    }

    const TriMesh& finest() {
        if (!finest_.points.empty()) return finest_;
        const DrapeInput input = input_of(pattern_, "", answer_edge);
        const SceneCloth cloth = carried(input);
        SceneRestOptions options;
        options.max_seconds = 1e9;
        const SceneRest end = rest(input, cloth.x, options);
        if (!end.failure.empty()) throw std::runtime_error(text("at %g mm the garment is not at rest: ", 1e3 * answer_edge) + end.failure);
        return finest_ = {end.x, node_triangles(cloth.garment)};
    }

private:
    SceneCloth carried(const DrapeInput& input) {
        if (coarse_.state.positions.empty()) {
            const DrapeInput coarse = input_of(pattern_, "", start_edge);
            coarse_ = drape(coarse.staging, avatar_, coarse.fabrics, {});
            if (coarse_.status != DrapeStatus::converged)
                throw std::runtime_error(text("at %g mm the garment is not at rest: ", 1e3 * start_edge) + coarse_.where);
        }
        SceneCloth cloth;
        cloth.garment = close_seams(input.staging.levels.back().garment);
        cloth.fabrics = input.fabrics;
        std::vector<int> panels(pattern_.panels.size());
        std::iota(panels.begin(), panels.end(), 0);
        cloth.x = carry_drape(coarse_.garment, coarse_.state.positions, cloth.garment, panels);
        return cloth;
    }

    SceneRest rest(const DrapeInput& input, const Points& x, const SceneRestOptions& how) const {
        DrapeOptions options;
        options.method = how.method;
        options.method_options.time_step = how.time_step;
        options.tolerance = how.tolerance;
        options.max_iterations = how.max_iterations;
        options.from = x;
        const double end = processor_seconds() + how.max_seconds;
        bool late = false;
        options.progress = [&](const DrapeProgress&) {
            late = processor_seconds() > end;
            return !late;
        };
        const DrapeResult r = drape(input.staging, avatar_, input.fabrics, options);
        SceneRest rest;
        rest.x = r.state.positions;
        rest.residual = r.residual;
        rest.out_of_time = late;
        if (late)
            rest.failure = "out of time";
        else if (r.status != DrapeStatus::converged)
            rest.failure = std::string(to_string(r.status)) + (r.where.empty() ? "" : ": " + r.where);
        return rest;
    }

    Pattern pattern_;
    Avatar avatar_;
    DrapeResult coarse_;
    TriMesh finest_;
};

} // namespace

Scene garment_scene(const std::string& pattern) {
    std::vector<std::string> warnings;
    const auto dressed = std::make_shared<DressedForm>(sound_pattern(pattern, warnings), form_of({}));
    Scene s;
    s.name = std::filesystem::path(pattern).stem().string();
    s.quantity = "RMS distance in m (1 % is 1 mm)";
    s.answer = 0;
    s.answer_from = text("the equilibrium at %g mm", 1e3 * answer_edge);
    s.scale = scale;
    for (int m = 0; m < meshes; ++m) s.edges.push_back(start_edge / (1 << m));
    s.make = [dressed](double edge) { return dressed->cloth(dressed, edge); };
    s.measure = [dressed](const SceneCloth& cloth, const Points& x) {
        return compare({x, node_triangles(cloth.garment)}, dressed->finest()).rms;
    };
    return s;
}

} // namespace toile
