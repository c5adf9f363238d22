#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <softkin/calibration/specimen_test.hpp>
#include <string>

namespace softkin::runs {
class Store;
}

namespace softkin::calibration {

/// The ratio that a specimen determines, by simulations of its test.
struct SpecimenFit {
  Status status = Status::not_converged;  // limit: no ratio from 1e-4 to 1e4 moves its interface so far
  std::string remark;                     // why, where status is not converged
  double own_log_ratio = 0;               // at which the simulated interface moves as the measured one did
  double sensitivity_mm = 0;              // by how much its move falls where the logarithm grows by 1
  int simulations = 0;
  SpecimenResponse response;  // at the ratio of all specimens
};

/// Simulated tests on disk, one by one as they are done, so that a calibration that was stopped or killed takes them
/// over instead of simulating them again. None depends on which others were simulated before, so that it ends with the
/// same numbers as one that was never stopped.
class TestLog {
 public:
  /// path    of the journal; empty: nothing outlives the program
  /// set_up  one line that identifies the simulations
  /// resume  continues the journal, where there is one
  /// throws  InvalidInput where the journal is of another set-up, or another softkin is at work on it
  TestLog(const std::filesystem::path& path, const std::string& set_up, bool resume);
  ~TestLog();

  /// The test of a name: as it was done before, or by make, and then kept unless it was interrupted.
  [[nodiscard]] SpecimenFit once(const std::string& test, const std::function<SpecimenFit()>& make);
  [[nodiscard]] std::size_t size() const { return done_.size(); }
  /// Removes the journal.
  void remove();

 private:
  std::unique_ptr<runs::Store> store_;
  std::map<std::string, SpecimenFit> done_;
};

}  // namespace softkin::calibration
