// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/sparse_solve.h"

#include "sewing/blas.h"

#include <cholmod.h>
#include <omp.h>

#include <memory>
#include <stdexcept>

namespace toile {

namespace {

/// CHOLMOD's workspace, freed on every way out.
struct Workspace {
    cholmod_common common;
    Workspace() {
        settle_blas();
        omp_set_max_active_levels(0);
        cholmod_start(&common);
        common.print = 0;
        common.supernodal = CHOLMOD_SUPERNODAL;
    }
    ~Workspace() { cholmod_finish(&common); }
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;
};

cholmod_sparse lower_view(const Eigen::SparseMatrix<double>& a) {
    cholmod_sparse view{};
    view.nrow = size_t(a.rows());
    view.ncol = size_t(a.cols());
    view.nzmax = size_t(a.nonZeros());
    view.p = const_cast<int*>(a.outerIndexPtr());
    view.i = const_cast<int*>(a.innerIndexPtr());
    view.x = const_cast<double*>(a.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

cholmod_dense dense_view(const Eigen::MatrixXd& b) {
    cholmod_dense view{};
    view.nrow = size_t(b.rows());
    view.ncol = size_t(b.cols());
    view.nzmax = size_t(b.size());
    view.d = size_t(b.rows());
    view.x = const_cast<double*>(b.data());
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    return view;
}

} // namespace

Eigen::MatrixXd solve_definite(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b) {
    if (a.rows() != a.cols() || a.rows() != b.rows() || !a.isCompressed())
        throw std::invalid_argument("solve_definite: a square compressed matrix and matching right sides expected");
    Workspace work;
    cholmod_common* c = &work.common;
    cholmod_sparse matrix = lower_view(a);
    cholmod_dense right = dense_view(b);
    const auto free_factor = [c](cholmod_factor* f) { cholmod_free_factor(&f, c); };
    const auto free_dense = [c](cholmod_dense* d) { cholmod_free_dense(&d, c); };
    std::unique_ptr<cholmod_factor, decltype(free_factor)> factor(cholmod_analyze(&matrix, c), free_factor);
    if (!factor || !cholmod_factorize(&matrix, factor.get(), c) || c->status != CHOLMOD_OK ||
        factor->minor < factor->n)
        throw std::runtime_error("solve_definite: the matrix is not positive definite");
    std::unique_ptr<cholmod_dense, decltype(free_dense)> x(cholmod_solve(CHOLMOD_A, factor.get(), &right, c),
                                                           free_dense);
    if (!x) throw std::runtime_error("solve_definite: the solve failed");
    return Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x->x), b.rows(), b.cols());
}

} // namespace toile
