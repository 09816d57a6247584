// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/blas.h"

#include <cblas.h>

#include <cstdlib>

// OpenBLAS picks its kernels by the processor, or by the environment, when it is loaded; that again is not in its
// headers. Absent where it was built for one processor only.
extern "C" {
[[gnu::weak]] void gotoblas_dynamic_quit();
[[gnu::weak]] void gotoblas_dynamic_init();
}

namespace toile {

namespace {

bool pick_kernels() {
#ifdef __x86_64__
    if (!gotoblas_dynamic_quit || !gotoblas_dynamic_init || std::getenv("OPENBLAS_CORETYPE")) return false;
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
    setenv("OPENBLAS_CORETYPE", "Haswell", 0);
    gotoblas_dynamic_quit();
    gotoblas_dynamic_init();
    return true;
#else
    return false;
#endif
}

} // namespace

void settle_blas() {
    [[maybe_unused]] static const bool picked = pick_kernels();
    openblas_set_num_threads(1);
}

std::string blas_name() {
    settle_blas();
    return std::string(openblas_get_config()) + ", core " + openblas_get_corename();
}

} // namespace toile
