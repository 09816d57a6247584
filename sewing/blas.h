// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Makes OpenBLAS compute the same bytes everywhere; before every use of it. It works on one thread, and with Haswell's
/// kernels on every x86 processor with AVX2 and FMA, unless the environment names others in OPENBLAS_CORETYPE: the
/// last bits of its sums depend on both. By itself OpenBLAS takes the kernels of its own year for processors it knows,
/// and for newer ones those of SSE3, half as fast.
void settle_blas();

/// Its version and the kind of processor whose kernels it uses.
std::string blas_name();

} // namespace toile
