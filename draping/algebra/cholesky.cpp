// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/algebra/cholesky.h"

#include "draping/algebra/supernodes.h"
#include "sewing/blas.h"

#include <cholmod.h>
#include <omp.h>

#include <cassert>
#include <optional>
#include <stdexcept>

namespace toile {

namespace {

constexpr double worn_out = 1.5; // times the work that an order took when it was new: it is time for another

} // namespace

struct Cholesky::Impl {
    cholmod_common common;
    cholmod_factor* factor = nullptr;
    std::vector<int> order; ///< of points
    double work = 0;        ///< floating-point operations of a factorisation when that order was new
    std::optional<SupernodalCholesky> single; ///< in single precision
    bool in_double = false;                   ///< the last factorisation was
    cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

    Impl() {
        settle_blas();
        omp_set_max_active_levels(0); // CHOLMOD's loops are too short for the four threads it asks for
        cholmod_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.print = 0;
        common.try_catch = 1;
        common.quick_return_if_not_posdef = 1;
    }
    ~Impl() {
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    static cholmod_sparse view(const BlockMatrix& a) {
        cholmod_sparse s{};
        s.nrow = s.ncol = a.rows();
        s.nzmax = a.values().size();
        s.p = const_cast<int*>(a.scalar_columns().data());
        s.i = const_cast<int*>(a.scalar_rows().data());
        s.x = const_cast<double*>(a.values().data());
        s.stype = -1;
        s.itype = CHOLMOD_INT;
        s.xtype = CHOLMOD_REAL;
        s.dtype = CHOLMOD_DOUBLE;
        s.sorted = s.packed = 1;
        return s;
    }

    // The graph of points is a ninth of the scalar one and gives the same separators.
    void find_order(const BlockMatrix& a) {
        cholmod_sparse graph{};
        graph.nrow = graph.ncol = a.block_rows();
        graph.nzmax = a.block_row_indices().size();
        graph.p = const_cast<int*>(a.block_columns().data());
        graph.i = const_cast<int*>(a.block_row_indices().data());
        graph.stype = -1;
        graph.itype = CHOLMOD_INT;
        graph.xtype = CHOLMOD_PATTERN;
        graph.sorted = graph.packed = 1;
        order.assign(a.block_rows(), 0);
        if (!cholmod_metis(&graph, nullptr, 0, 1, order.data(), &common))
            throw std::runtime_error("CHOLMOD could not order the stiffness matrix");
    }

    void find_structure(const BlockMatrix& a) {
        std::vector<int> scalar_order;
        scalar_order.reserve(a.rows());
        for (int i : order)
            for (int c = 0; c < 3; ++c) scalar_order.push_back(3 * i + c);
        cholmod_free_factor(&factor, &common);
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_GIVEN;
        common.postorder = 1;
        single.reset();
        cholmod_sparse s = view(a);
        factor = cholmod_analyze_p(&s, scalar_order.data(), nullptr, 0, &common);
        if (!factor) throw std::runtime_error("CHOLMOD could not analyse the stiffness matrix");
    }

    /// There is room for the values of one factor: those in double precision take twice that of those in single precision,
    /// and are rarely needed.
    void forget_values() {
        if (factor->xtype != CHOLMOD_PATTERN) cholmod_change_factor(CHOLMOD_PATTERN, 1, 1, 1, 1, factor, &common);
    }
};

Cholesky::Cholesky() : impl_(std::make_unique<Impl>()) {}
Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

void Cholesky::analyse(const BlockMatrix& a, bool keep_order) {
    Impl& m = *impl_;
    if (keep_order && int(m.order.size()) == a.block_rows()) {
        m.find_structure(a);
        if (m.common.fl < worn_out * m.work) return;
    }
    m.find_order(a);
    m.find_structure(a);
    m.work = m.common.fl;
}

double Cholesky::work() const { return impl_->common.fl; }

bool Cholesky::factorise(const BlockMatrix& a) {
    Impl& m = *impl_;
    if (m.single) m.single->free_values();
    m.in_double = true;
    cholmod_sparse s = Impl::view(a);
    cholmod_factorize(&s, m.factor, &m.common);
    if (m.common.status == CHOLMOD_OUT_OF_MEMORY || m.common.status == CHOLMOD_TOO_LARGE)
        throw std::runtime_error("out of memory while factorising the stiffness matrix");
    return m.common.status == CHOLMOD_OK;
}

void Cholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    Impl& m = *impl_;
    assert(m.factor->xtype != CHOLMOD_PATTERN);
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = b.size();
    right.ncol = 1;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, m.factor, &right, nullptr, &m.solution, nullptr, &m.work_y, &m.work_e, &m.common);
    x = Eigen::Map<Eigen::VectorXd>(static_cast<double*>(m.solution->x), b.size());
}

bool Cholesky::factorise_preconditioner(const BlockMatrix& a) {
    Impl& m = *impl_;
    if (!m.single) {
        const cholmod_factor& f = *m.factor;
        SupernodalPattern pattern;
        pattern.rows = int(f.n);
        pattern.count = int(f.nsuper);
        pattern.first = static_cast<const int*>(f.super);
        pattern.row_begin = static_cast<const int*>(f.pi);
        pattern.value_begin = static_cast<const int*>(f.px);
        pattern.row = static_cast<const int*>(f.s);
        pattern.order = static_cast<const int*>(f.Perm);
        m.single.emplace(pattern, a);
    }
    m.forget_values();
    m.in_double = false;
    return m.single->factorise(a) || factorise(a);
}

void Cholesky::precondition(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    if (impl_->in_double)
        solve(b, x);
    else
        impl_->single->solve(b, x);
}

} // namespace toile
