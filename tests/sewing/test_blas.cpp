// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/blas.h"

#include <catch2/catch.hpp>

#include <cblas.h>

#include <cstdlib>
#include <vector>

using namespace toile;

namespace {

const bool kernels_named = std::getenv("OPENBLAS_CORETYPE"); // before any test

} // namespace

TEST_CASE("BLAS has the same kernels on every processor that can run them") {
#ifdef __x86_64__
    if (kernels_named)
        WARN("skipped: OPENBLAS_CORETYPE names other kernels");
    else if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        WARN("skipped: the processor has no AVX2");
    else
        CHECK_THAT(blas_name(), Catch::Matchers::EndsWith("core Haswell"));
#endif
    settle_blas();
    constexpr int n = 100;
    std::vector<float> a(n * n), b(n * n), c(n * n, 1);
    for (int i = 0; i < n * n; ++i) a[i] = float(i % 7), b[i] = float(i % 5);
    cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, n, n, n, 1, a.data(), n, b.data(), n, 0, c.data(), n);
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            float sum = 0; // of whole numbers below 2^24: exact in any order
            for (int k = 0; k < n; ++k) sum += a[k * n + i] * b[k * n + j];
            REQUIRE(c[j * n + i] == sum);
        }
}
