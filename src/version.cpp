// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/version.h"

#include "sewing/blas.h"

#include <CGAL/version.h>
#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <assimp/version.h>
#include <cholmod.h>
#include <embree3/rtcore_config.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>
#include <tbb/version.h>

namespace toile {
namespace {

std::string dotted(int a, int b, int c) {
    return std::to_string(a) + '.' + std::to_string(b) + '.' + std::to_string(c);
}

} // namespace

std::string version_text() {
    return "toile " TOILE_VERSION "\nCGAL " CGAL_VERSION_STR "\nCHOLMOD " +
           dotted(CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION) + "\nBLAS " +
           blas_name() + "\nEigen " + dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) +
           "\noneTBB " + std::to_string(TBB_VERSION_MAJOR) + '.' + std::to_string(TBB_VERSION_MINOR) +
           "\nassimp " +
           dotted(int(aiGetVersionMajor()), int(aiGetVersionMinor()), int(aiGetVersionPatch())) +
           "\nmeshoptimizer " +
           dotted(MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION / 10 % 100, MESHOPTIMIZER_VERSION % 10) +
           "\nEmbree " RTC_VERSION_STRING "\nnlohmann JSON " +
           dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH) +
           "\nCLI11 " CLI11_VERSION;
}

} // namespace toile
