// softkin's sparse LDL^T against CHOLMOD's supernodal and Eigen's simplicial factorisation of the same Hessians.

#include <unistd.h>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>
#include <softkin/core/error.hpp>
#include <string>

#include <algorithm>
#include <softkin/statics/statics.hpp>

#include "child_process.hpp"
#include "command_line.hpp"
#include "critical_path.hpp"
#include "finger.hpp"
#include "machine.hpp"
#include "physical_parts.hpp"

#ifdef SOFTKIN_BENCH_CHOLMOD
#include <cholmod.h>
#endif

namespace {

using namespace softkin;
using namespace softkin::physical;
using namespace softkin::bench;

/// A factorisation of a symmetric positive definite matrix, timed.
struct FactorTimes {
  double analyse = 0, factor = 0, solve = 0;  // [s]: once; medians of several
  double nonzeros = 0;                        // of the factor
  double residual = 0;                        // |A x - b| / |b|
};

/// |A x - b| / |b| for the lower triangle of A.
double relative_residual(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& b) {
  return (matrix.selfadjointView<Eigen::Lower>() * x - b).norm() / b.norm();
}

/// matrix: lower triangle. Factorises `repeat` times and solves for one right-hand side of ones.
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
    cholmod_free_dense(&halfway, &common);
    cholmod_free_dense(&work, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *halfway = nullptr, *work = nullptr;  // kept from solve to solve
};

cholmod_sparse view_of(Eigen::SparseMatrix<double>& matrix) {
  cholmod_sparse view{};
  view.nrow = view.ncol = matrix.rows();
  view.nzmax = matrix.nonZeros();
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

/// CHOLMOD's supernodal LL^T in METIS's order; none where CHOLMOD was not found when this was built. Its threads are
/// those of its BLAS.
std::optional<FactorTimes> time_cholmod_supernodal(const Eigen::SparseMatrix<double>& matrix, int repeat) {
  FactorTimes times;
  Cholmod cholmod;
  Eigen::SparseMatrix<double> copy = matrix;
  cholmod_sparse a = view_of(copy);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(matrix.rows());
  cholmod_dense right{};
  right.nrow = right.nzmax = right.d = b.size();
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
    cholmod_solve2(CHOLMOD_A, cholmod.factor, &right, nullptr, &cholmod.solution, nullptr, &cholmod.halfway,
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

struct Options {
  std::vector<double> sizes{5000, 15000, 45000, 200000};
  std::vector<int> threads{1, 2};
  int repeat = 7, only = 0;
  double eigen_up_to = 50000;
};

template <class Number>
FactorTimes time_softkin(PhysicalParts& parts, const Eigen::SparseMatrix<double>& matrix, int repeat) {
  FactorTimes times;
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(matrix.rows());
  Eigen::MatrixXd x;
  double begin = now();
  linear::SparseLdltOf<Number> factor(parts.pattern());
  times.analyse = now() - begin;
  std::vector<double> factors, solves;
  for (int i = 0; i < repeat; ++i) {
    begin = now();
    (void)factor.factorise(parts.values(), 0, parts.team());
    factors.push_back(now() - begin);
    x = b;
    begin = now();
    factor.solve(x, parts.team());
    solves.push_back(now() - begin);
  }
  times.factor = median(factors);
  times.solve = median(solves);
  times.nonzeros = static_cast<double>(factor.nonzeros());
  times.residual = relative_residual(matrix, x.col(0), b);
  return times;
}

/// peak  rate of a dense product of the same precision [flop/s]; 0: not compared
void print_times(const char* name, const FactorTimes& times, double flops, double peak = 0) {
  std::printf("           %-18s %11.3f %11.2f %10.2f %9.2f %13.3g %10.1e", name, 1e3 * times.analyse,
              1e3 * times.factor, 1e-9 * flops / times.factor, 1e3 * times.solve, times.nonzeros, times.residual);
  if (peak > 0) std::printf("   %.0f %% of a dense product's rate", 100 * flops / times.factor / peak);
  std::printf("\n");
  std::fflush(stdout);
}

/// What cores could gain at best, by counts.
void print_sharing(const linear::BlockColumns& pattern) {
  const CriticalPath path = critical_path(linear::make_front_tree(pattern));
  std::printf("           by counts: %d pieces, the heaviest %.0f %%, above them %.0f %% of the work; at most",
              path.pieces, 100 * path.heaviest / path.total, 100 * path.top / path.total);
  for (const int cores : {2, 4, 8, 16}) std::printf("%s %.1f", cores == 2 ? "" : ",", path.speedup(cores));
  std::printf(" times one core's rate on 2, 4, 8, 16\n");
}

struct Ratios {
  std::vector<double> factor, solve;

  void add(const FactorTimes& peer, const FactorTimes& own) {
    factor.push_back(peer.factor / own.factor);
    solve.push_back(peer.solve / own.solve);
  }
  void print(const char* name) const {
    if (factor.empty()) return;
    std::printf("softkin against %s, median ratio of times (> 1: softkin is faster): factor %.2f, solve %.2f\n", name,
                median(factor), median(solve));
  }
};

/// All sizes in this process, whose BLAS has as many threads.
int run_with(int threads, const Options& options) {
  std::printf("\n%d thread(s): a Hessian of the physical formulation at a volume ratio of 1.15, one right-hand side\n",
              threads);
  std::printf("%9s  %-18s %11s %11s %10s %9s %13s %10s\n", "body tets", "", "analyse[ms]", "factor [ms]", "GFlop/s",
              "solve[ms]", "nonzeros of L", "residual");
  Ratios cholmod_ratios, eigen_ratios;
  Team team(threads);
  const double peak = product_rate<double>(team), single_peak = product_rate<float>(team);
  std::printf("dense products (Eigen, %s): %.1f GFlop/s in double, %.1f in single precision\n", name_of(target()),
              1e-9 * peak, 1e-9 * single_peak);
  for (const double size : options.sizes) {
    const double cell = cell_for(size);
    const Model model = compile(finger_robot(bellows_finger(cell), FingerKind::physical, "finger"));
    const Actuation actuation = Actuation::Constant(1, 1.15);
    StaticsOptions statics_options;
    statics_options.keep_history = false;
    State state;
    {
      const Statics statics(model);
      const Equilibrium found = statics.solve(actuation, statics.rest(), statics_options);
      if (found.report.status != Status::converged) throw InvalidInput("the finger did not bend");
      state = found.state;
    }
    PhysicalParts parts(model, actuation, state, threads);
    const Eigen::SparseMatrix<double> matrix = parts.matrix();
    std::printf("%9lld  %lld unknowns, %lld nonzeros in the lower triangle, %.3g flop by softkin's count%s\n",
                static_cast<long long>(body_tetrahedra(cell)), static_cast<long long>(matrix.rows()),
                static_cast<long long>(matrix.nonZeros()), parts.flops(),
                parts.projected() ? "; made positive definite element by element" : "");
    const FactorTimes own = time_softkin<double>(parts, matrix, options.repeat);
    print_times("softkin", own, parts.flops(), peak);
    const FactorTimes single = time_softkin<float>(parts, matrix, options.repeat);
    print_times("  in single", single, parts.flops(), single_peak);
    std::printf("           the factor in single precision is %.2f times as fast\n", own.factor / single.factor);
    print_sharing(parts.pattern());
    if (const std::optional<FactorTimes> cholmod = time_cholmod_supernodal(matrix, options.repeat)) {
      print_times("CHOLMOD supernodal", *cholmod, parts.flops());
      cholmod_ratios.add(*cholmod, own);
    }
    if (size > options.eigen_up_to) continue;
    const FactorTimes eigen = time_eigen_simplicial(matrix, std::min(options.repeat, 3));
    print_times("Eigen simplicial", eigen, parts.flops());
    eigen_ratios.add(eigen, own);
  }
  cholmod_ratios.print("CHOLMOD supernodal");
  eigen_ratios.print("Eigen simplicial");
  return 0;
}

/// A process for each number of threads: a BLAS reads its own when it is loaded.
int run_each(const Options& options, int argc, char** argv) {
  print_machine();
  int worst = 0;
  for (const int threads : options.threads) {
    const std::string count = std::to_string(threads);
    std::vector<std::string> command{"/proc/self/exe"};
    command.insert(command.end(), argv + 1, argv + argc);
    command.insert(command.end(), {"--only", count});
    const ProcessEnd end =
        run_program(command, ".", "", {"OPENBLAS_NUM_THREADS=" + count, "OMP_NUM_THREADS=" + count}, 1e6);
    if (!end.good()) std::printf("%d thread(s): %s\n", threads, end.complaint().c_str());
    worst = std::max(worst, end.exit_code);
  }
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Factorisation and solution of the physical formulation's Hessians, beside CHOLMOD and Eigen.",
                  "bench_factor"};
  Options options;
  app.add_option("--sizes", options.sizes, "body tetrahedra of the fingers").split_at_commas();
  app.add_option("--threads", options.threads, "one run with each number").split_at_commas().check(within(1, 256));
  app.add_option("--repeat", options.repeat, "of which the median is given").check(within(1, 1000));
  app.add_option("--eigen-up-to", options.eigen_up_to, "body tetrahedra of the largest finger for Eigen");
  app.add_option("--only", options.only, "with this many threads, in this process").hide();
  return run_benchmark(app, argc, argv, [&] {
    return options.only > 0 ? run_with(options.only, options) : run_each(options, argc, argv);
  });
}
