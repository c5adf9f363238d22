// Time, memory and error of every solver on a finger that bends by 90, 180 and 240 degrees (the paper's Table III).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <softkin/core/error.hpp>
#include <string>
#include <vector>
#include "command_line.hpp"
#include "machine.hpp"
#include "newton_runs.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

enum class Solution { local_global, anderson, newton, physical, calculix, physical_quadratic, calculix_quadratic };

const std::vector<std::string>& solution_names() {
  static const std::vector<std::string> names{
      "local-global", "anderson", "newton", "physical", "calculix", "physical-quadratic", "calculix-quadratic"};
  return names;
}

Solution solution_of(const std::string& name) {
  return static_cast<Solution>(std::find(solution_names().begin(), solution_names().end(), name) -
                               solution_names().begin());
}

FingerKind kind_of(Solution solution) {
  if (solution == Solution::physical || solution == Solution::calculix) return FingerKind::physical;
  if (solution == Solution::physical_quadratic || solution == Solution::calculix_quadratic)
    return FingerKind::physical_quadratic;
  return FingerKind::target_shape;
}

bool is_calculix(Solution solution) {
  return solution == Solution::calculix || solution == Solution::calculix_quadratic;
}

struct BenchmarkOptions {
  std::vector<double> sizes{5000, 15000, 45000, 200000};  // body tetrahedra
  std::string mesh;                                       // a file in place of the sizes
  std::vector<double> bends{90, 180, 240};                // [degrees]
  std::vector<std::string> solvers;
  std::vector<int> calculix_threads{1, 2};
  int repeat = 3;
  double quadratic_up_to = 8000;  // body tetrahedra
  double chamber_weight = 0.05;
  std::string folder;  // where CalculiX works; "": a temporary one
  RunOptions run;
};

/// One line of the table.
struct Row {
  Solution solution = Solution::newton;
  int threads = 0;  // CalculiX
  int body_tetrahedra = 0, vertices = 0;
  double bend = 0;
  Run run;  // times: medians
  int runs = 0;
  double peak_mib = 0;
  std::string remark;
};

/// Prints times in the manner of the paper's Table III, the ratios between solvers and the growth of time per
/// iteration.
void print_summary(const std::vector<Row>& rows, const BenchmarkOptions& options);

std::string label(const Row& row) {
  const std::string& name = solution_names()[static_cast<std::size_t>(row.solution)];
  return is_calculix(row.solution) ? name + " x" + std::to_string(row.threads) : name;
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

std::string not_done(const Run& run) {
  if (run.out_of_time)
    return "not done in " + text("%.0f", run.seconds()) + " s, tip still " + text("%.3g", run.tip_error) + " mm away";
  return "not done, tip " + text("%.3g", run.tip_error) + " mm away";
}

void print_row(const Row& row) {
  const Run& run = row.run;
  std::printf("%9d %5.0f  %-22s %10.3f %9.3f %9.3f %7d %7d %10.2g %9.0f %4d  %s\n", row.body_tetrahedra, row.bend,
              label(row).c_str(), run.seconds(), run.setup, run.solve, run.iterations, run.factorisations,
              run.tip_error, row.peak_mib, row.runs, row.remark.c_str());
  std::fflush(stdout);
}

/// A folder for CalculiX that is removed at the end if it is a temporary one.
class WorkFolder {
 public:
  explicit WorkFolder(const std::string& wanted) : path_(wanted), temporary_(wanted.empty()) {
    if (temporary_) {
      std::string name = (std::filesystem::temp_directory_path() / "softkin_bench_XXXXXX").string();
      if (::mkdtemp(name.data()) == nullptr) throw InvalidInput({.file = name}, "the folder cannot be made");
      path_ = name;
    } else {
      std::filesystem::create_directories(path_);
    }
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (temporary_) std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool temporary_;
};

/// Measures all requested quantities of one finger.
class FingerTable {
 public:
  FingerTable(const FingerSource& source, const BenchmarkOptions& options, const std::string& folder,
              std::vector<Row>& rows)
      : source_(source), options_(options), folder_(folder), rows_(rows) {}

  void measure_all() {
    for (const std::string& name : options_.solvers) {
      const Solution solution = solution_of(name);
      const FingerKind kind = kind_of(solution);
      const Answers* answers = answers_of(kind);
      if (answers == nullptr) continue;
      for (int bend = 0; bend < answers->count; ++bend) {
        if (!is_calculix(solution)) {
          measure_row(solution, 0, *answers, bend);
          continue;
        }
        for (const int threads : options_.calculix_threads) measure_row(solution, threads, *answers, bend);
      }
    }
  }

 private:
  /// Found once; null where there are none, or where the mesh is too large for quadratic elements.
  const Answers* answers_of(FingerKind kind) {
    const auto known = answers_.find(kind);
    if (known != answers_.end()) return known->second ? &*known->second : nullptr;
    std::optional<Answers>& found = answers_[kind];
    if (kind == FingerKind::physical_quadratic && source_.file.empty() &&
        static_cast<double>(body_tetrahedra(source_.cell_mm)) > options_.quadratic_up_to)
      return nullptr;
    const Measured<Answers> measured =
        find_answers(source_, kind, options_.bends, options_.run.threads, 20 * options_.run.limit);
    if (!measured.result) {
      std::printf("  no answers: %s\n", measured.end.complaint().c_str());
      return nullptr;
    }
    found = measured.result;
    print_answers(kind, *found);
    return &*found;
  }

  void print_answers(FingerKind kind, const Answers& answers) const {
    constexpr const char* names[] = {"target-shape", "physical", "physical of order 2"};
    std::printf("  %s, %s: %d body tetrahedra, %d vertices, %d unknowns; converged answers found in %.1f s:\n",
                source_.name().c_str(), names[static_cast<int>(kind)], answers.body_tetrahedra, answers.vertices,
                answers.unknowns, answers.seconds);
    for (int i = 0; i < answers.count; ++i) {
      const Target& t = answers.targets[i];
      std::printf("    bend %.2f degrees: volume ratio %.5f, pressure %.3f kPa, tip (%.4f, %.4f, %.4f) mm\n", t.degrees,
                  t.ratio, t.pressure_kpa, t.tip[0], t.tip[1], t.tip[2]);
    }
    if (answers.count < static_cast<int>(options_.bends.size()))
      std::printf("    it was not bent by more than %.1f degrees\n", answers.farthest_degrees);
    std::fflush(stdout);
  }

  void measure_row(Solution solution, int threads, const Answers& answers, int bend) {
    Row row;
    row.solution = solution;
    row.threads = threads;
    row.body_tetrahedra = answers.body_tetrahedra;
    row.vertices = answers.vertices;
    row.bend = options_.bends[bend];
    std::vector<double> setups, solves;
    double spent = 0;
    while (row.runs < options_.repeat && (row.runs == 0 || (row.run.done && spent < options_.run.limit))) {
      run_once(row, answers, answers.targets[bend]);
      ++row.runs;
      setups.push_back(row.run.setup);
      solves.push_back(row.run.solve);
      spent += row.run.seconds();
    }
    row.run.setup = median(setups);
    row.run.solve = median(solves);
    print_row(row);
    rows_.push_back(row);
  }

  void run_once(Row& row, const Answers& answers, const Target& target) const {
    if (is_calculix(row.solution)) {
      const CalculixRun found =
          run_calculix(source_, kind_of(row.solution), answers, target, folder_, row.threads, options_.run);
      row.run = found.run;
      row.peak_mib = std::max(row.peak_mib, found.peak_mib);
      row.remark = "R_n " + text("%g", found.residual) + ", C_n " + text("%g", found.correction);
      if (!row.run.done) row.remark += "; " + not_done(row.run) + ": " + found.complaint;
      return;
    }
    const Measured<Run> found =
        row.solution == Solution::local_global || row.solution == Solution::anderson
            ? run_local_global(source_, target, row.solution == Solution::anderson ? 6 : 0, options_.run)
            : run_newton(source_, kind_of(row.solution), target, options_.run);
    row.peak_mib = std::max(row.peak_mib, found.end.peak_mib);
    row.run = found.result.value_or(Run{});
    row.remark = !found.result ? found.end.complaint() : row.run.done ? "" : not_done(row.run);
  }

  FingerSource source_;
  const BenchmarkOptions& options_;
  std::string folder_;
  std::vector<Row>& rows_;
  std::map<FingerKind, std::optional<Answers>> answers_;
};

const Row* find_row(const std::vector<Row>& rows, Solution solution, int size, double bend) {
  const Row* best = nullptr;
  for (const Row& row : rows)
    if (row.solution == solution && row.body_tetrahedra == size && row.bend == bend &&
        (best == nullptr || (row.run.done && row.run.seconds() < best->run.seconds())))
      best = &row;
  return best;
}

/// "12.3", "> 12.3" where the slow one was not done, "-" where there is nothing to compare.
std::string ratio_text(const Row* slow, const Row* fast) {
  if (slow == nullptr || fast == nullptr || !fast->run.done || !(fast->run.seconds() > 0)) return "-";
  if (!slow->run.done && !slow->run.out_of_time) return "-";
  return (slow->run.done ? "" : "> ") + text("%.1f", slow->run.seconds() / fast->run.seconds());
}

void print_ratios(const std::vector<Row>& rows, int size, double bend) {
  const auto at = [&](Solution solution) { return find_row(rows, solution, size, bend); };
  const auto print = [&](const char* what, Solution slow, Solution fast) {
    const std::string ratio = ratio_text(at(slow), at(fast));
    if (ratio != "-") std::printf("%9d %5.0f  %-58s %10s\n", size, bend, what, ratio.c_str());
  };
  print("newton (target-shape) faster than local-global", Solution::local_global, Solution::newton);
  print("newton (target-shape) faster than local-global + Anderson", Solution::anderson, Solution::newton);
  print("physical faster than CalculiX (its best)", Solution::calculix, Solution::physical);
  print("physical of order 2 faster than CalculiX (its best)", Solution::calculix_quadratic,
        Solution::physical_quadratic);
}

void print_growth(const std::vector<Row>& rows, Solution solution, double bend) {
  std::vector<double> sizes, times;
  for (const Row& row : rows)
    if (row.solution == solution && row.bend == bend && row.run.done) {
      sizes.push_back(row.vertices);
      times.push_back(row.run.solve / row.run.iterations);
    }
  if (sizes.size() < 2) return;
  std::printf("growth of time per iteration, %s at %.0f degrees: vertices^%.2f from %.0f to %.0f vertices (",
              solution_names()[static_cast<std::size_t>(solution)].c_str(), bend, growth(sizes, times), sizes.front(),
              sizes.back());
  for (std::size_t i = 0; i < times.size(); ++i) std::printf("%s%.1f", i == 0 ? "" : ", ", 1e3 * times[i]);
  std::printf(" ms)\n");
}

std::vector<Row> measure_table(const BenchmarkOptions& options) {
  const WorkFolder folder(options.folder);
  std::vector<FingerSource> sources;
  for (const double size : options.sizes) {
    FingerSource source;
    source.chamber_weight = options.chamber_weight;
    if (options.mesh.empty()) source.cell_mm = cell_for(size);
    source.file = options.mesh;
    sources.push_back(source);
    if (!options.mesh.empty()) break;
  }
  std::printf("%9s %5s  %-22s %10s %9s %9s %7s %7s %10s %9s %4s\n", "body tets", "bend", "solver", "time [s]", "setup",
              "solve", "iterat.", "factor.", "error [mm]", "peak[MiB]", "runs");
  std::vector<Row> rows;
  for (const FingerSource& source : sources) FingerTable(source, options, folder.path(), rows).measure_all();
  return rows;
}

void print_summary(const std::vector<Row>& rows, const BenchmarkOptions& options) {
  std::printf("\nTime from rest to a bend [s] (median; as Table III)\n%9s  %-22s", "body tets", "solver");
  for (const double bend : options.bends) std::printf(" %9.0f deg", bend);
  std::map<std::pair<int, std::string>, std::map<double, const Row*>> lines;
  std::vector<std::pair<int, std::string>> order;
  for (const Row& row : rows) {
    const std::pair<int, std::string> key{row.body_tetrahedra, label(row)};
    if (!lines.contains(key)) order.push_back(key);
    lines[key][row.bend] = &row;
  }
  for (const auto& key : order) {
    std::printf("\n%9d  %-22s", key.first, key.second.c_str());
    for (const double bend : options.bends) {
      const auto found = lines[key].find(bend);
      const bool done = found != lines[key].end() && found->second->run.done;
      std::printf(" %13s", done ? text("%.3f", found->second->run.seconds()).c_str() : "-");
    }
  }
  std::printf("\n\nRatios of times (to the same bend and tip error)\n");
  std::vector<int> sizes;
  for (const Row& row : rows)
    if (std::find(sizes.begin(), sizes.end(), row.body_tetrahedra) == sizes.end()) sizes.push_back(row.body_tetrahedra);
  for (const int size : sizes)
    for (const double bend : options.bends) print_ratios(rows, size, bend);
  for (const double bend : options.bends)
    for (const Solution solution : {Solution::newton, Solution::physical}) print_growth(rows, solution, bend);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Every solver from rest to 90, 180 and 240 degrees of bend of the tip face (the paper's Table III).",
                  "bench_newton"};
  BenchmarkOptions options;
  options.solvers = {"local-global", "anderson", "newton", "physical", "physical-quadratic"};
  if (on_path("ccx")) options.solvers.insert(options.solvers.end(), {"calculix", "calculix-quadratic"});
  app.add_option("--sizes", options.sizes, "body tetrahedra of the fingers").split_at_commas();
  app.add_option("--mesh", options.mesh, "this mesh instead (regions body, chamber, fixed, tip)")
      .check(existing_file());
  app.add_option("--bends", options.bends, "angles [degrees], ascending").split_at_commas().check(within(1.0, 1000.0));
  app.add_option("--solvers", options.solvers, "of these").split_at_commas().check(one_of(solution_names()));
  app.add_option("--repeat", options.repeat, "runs of each, of which the median is given").check(within(1, 100));
  app.add_option("--limit", options.run.limit, "longest run [s]").check(positive());
  app.add_option("--tip-error", options.run.tip_error_mm, "distance from the converged tip that counts as done [mm]")
      .check(positive());
  app.add_option("--threads", options.run.threads, "of softkin; 0: all").check(within(0, 256));
  app.add_option("--calculix-threads", options.calculix_threads, "of CalculiX, a row for each")
      .split_at_commas()
      .check(within(1, 256));
  app.add_option("--quadratic-up-to", options.quadratic_up_to, "body tetrahedra of the largest finger of order 2");
  app.add_option("--chamber-weight", options.chamber_weight, "w of the chamber's elements, target-shape")
      .check(positive());
  app.add_option("--folder", options.folder, "where CalculiX works and its files stay; none: a temporary one");
  return run_benchmark(app, argc, argv, [&] {
    print_machine();
    std::printf(
        "Newton and local-global start at rest; done: tip within %g mm of the converged answer; limit %g s a run\n",
        options.run.tip_error_mm, options.run.limit);
    print_summary(measure_table(options), options);
    return 0;
  });
}
