#include "factor_peers.hpp"

#include <Eigen/SparseCholesky>
#include <softkin/core/error.hpp>

#include "machine.hpp"

#ifdef SOFTKIN_BENCH_CHOLMOD
#include <cholmod.h>
#endif

namespace softkin::bench {

double relative_residual(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& b) {
  return (matrix.selfadjointView<Eigen::Lower>() * x - b).norm() / b.norm();
}

FactorTimes time_eigen_simplicial(const Eigen::SparseMatrix<double>& matrix, int repeat) {
  FactorTimes times;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor;
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(matrix.rows());
  Eigen::VectorXd x;
  double begin = now();
  factor.analyzePattern(matrix);
  times.analyse = now() - begin;
  std::vector<double> factors, solves;
  for (int i = 0; i < repeat; ++i) {
    begin = now();
    factor.factorize(matrix);
    factors.push_back(now() - begin);
    if (factor.info() != Eigen::Success) throw InvalidInput("Eigen could not factorise the matrix");
    begin = now();
    x = factor.solve(b);
    solves.push_back(now() - begin);
  }
  times.factor = median(factors);
  times.solve = median(solves);
  times.nonzeros = static_cast<double>(factor.matrixL().nestedExpression().nonZeros() + matrix.rows());
  times.residual = relative_residual(matrix, x, b);
  return times;
}

#ifdef SOFTKIN_BENCH_CHOLMOD

namespace {

/// CHOLMOD's work space and what was made with it.
struct Cholmod {
  Cholmod() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
    common.print = 0;
  }
  ~Cholmod() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&half_way, &common);
    cholmod_free_dense(&work, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *half_way = nullptr, *work = nullptr;  // kept from solve to solve
};

cholmod_sparse view_of(Eigen::SparseMatrix<double>& matrix) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
  view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
  view.p = matrix.outerIndexPtr();
  view.i = matrix.innerIndexPtr();
  view.x = matrix.valuePtr();
  view.stype = -1;  // lower
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

}  // namespace

std::optional<FactorTimes> time_cholmod_supernodal(const Eigen::SparseMatrix<double>& matrix, int repeat) {
  FactorTimes times;
  Cholmod cholmod;
  Eigen::SparseMatrix<double> copy = matrix;
  cholmod_sparse a = view_of(copy);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(matrix.rows());
  cholmod_dense right{};
  right.nrow = right.nzmax = right.d = static_cast<std::size_t>(b.size());
  right.ncol = 1;
  right.x = b.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  double begin = now();
  cholmod.factor = cholmod_analyze(&a, &cholmod.common);
  times.analyse = now() - begin;
  std::vector<double> factors, solves;
  for (int i = 0; i < repeat; ++i) {
    begin = now();
    cholmod_factorize(&a, cholmod.factor, &cholmod.common);
    factors.push_back(now() - begin);
    if (cholmod.factor == nullptr || cholmod.common.status != CHOLMOD_OK)
      throw InvalidInput("CHOLMOD could not factorise the matrix");
    begin = now();
    cholmod_solve2(CHOLMOD_A, cholmod.factor, &right, nullptr, &cholmod.solution, nullptr, &cholmod.half_way,
                   &cholmod.work, &cholmod.common);
    solves.push_back(now() - begin);
  }
  times.factor = median(factors);
  times.solve = median(solves);
  times.nonzeros = static_cast<double>(cholmod.factor->xsize);
  const Eigen::VectorXd x =
      Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(cholmod.solution->x), b.size());
  times.residual = relative_residual(matrix, x, b);
  return times;
}

#else

std::optional<FactorTimes> time_cholmod_supernodal(const Eigen::SparseMatrix<double>&, int) {
  return std::nullopt;
}

#endif

}  // namespace softkin::bench
