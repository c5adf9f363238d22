#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace softkin::random_robots {

/// How a run ended. failed: with an answer that is not confirmed, or with anything but an answer or a refusal.
enum class Outcome { converged, limit, not_converged, interrupted, refused, failed };
inline constexpr int outcomes = 6;
[[nodiscard]] const char* name_of(Outcome outcome);

/// The work of the solves of a run, without those of Algorithm 1, and why steps of their paths were rejected.
struct Effort {
  static constexpr int counts = 5;
  static constexpr std::array<const char*, counts> names{"iterations", "factorisations", "projections", "equilibria",
                                                         "rejected steps"};
  std::array<int, counts> of{};
  std::map<std::string, int> rejections{};
  std::string end{};  // how it ended
};

struct RunResult {
  std::uint64_t seed = 0;
  Outcome outcome = Outcome::failed;
  bool sensible = false, physical = false;
  std::string features;  // what is odd about the robot
  std::string message;   // of a refusal; of a failure its faults
  double residual_ratio = 0, constraint_error = 0, step_ratio = 0;
  bool blurred = false, undecided = false, unstable = false, inverted = false, confirmed = false;
  std::vector<Effort> efforts;  // of each solve
  double seconds = 0;
};

/// Solves the robot of a seed and confirms the answers. verbose: prints progress on the standard output.
///
/// trace  traces the paths, too, to count the work
[[nodiscard]] RunResult run_seed(std::uint64_t seed, bool verbose, bool trace = false);

/// Falsifies confirmed answers of sensible robots and returns how many of them would be confirmed still; > 0 where
/// there was nothing to falsify.
[[nodiscard]] int count_unnoticed_lies(std::uint64_t first, std::uint64_t count);

/// Counts over many runs.
class Summary {
 public:
  void add(const RunResult& run);
  [[nodiscard]] std::string text() const;
  [[nodiscard]] const std::vector<RunResult>& failures() const { return failures_; }
  [[nodiscard]] std::size_t runs() const { return runs_; }
  /// Quantiles of the work of solves, the seeds with the most work, and why steps were rejected.
  [[nodiscard]] std::string effort_text() const;
  /// Iterations that a given fraction of all solves does not exceed.
  [[nodiscard]] int iterations_of(double fraction) const;
  /// seed, formulation, features and faults of every failure, as CSV
  [[nodiscard]] std::string failure_table() const;

 private:
  struct Counts {
    std::size_t of[outcomes] = {};
  };
  struct Extreme {
    double value = 0;
    std::uint64_t seed = 0;
    void enter(double other, std::uint64_t from) {
      if (other > value) value = other, seed = from;
    }
  };
  std::size_t runs_ = 0, sensible_ = 0, confirmed_ = 0, blurred_ = 0, undecided_ = 0, unstable_ = 0, inverted_ = 0;
  Counts by_formulation_[2], of_sensible_;
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> refusals_;  // kind: how many, one of the seeds
  Extreme residual_, constraint_, step_, seconds_;
  double total_seconds_ = 0;
  std::vector<RunResult> failures_;
  static constexpr int long_path = 150;                                             // iterations
  std::map<std::string, std::vector<std::uint64_t>> long_ways_;                     // by how they ended: the seeds
  std::array<std::vector<std::pair<int, std::uint64_t>>, Effort::counts> efforts_;  // with their seeds
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> rejections_;         // reason: how many, a seed
};

}  // namespace softkin::random_robots
