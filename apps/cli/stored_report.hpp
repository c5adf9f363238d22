#pragma once

#include <filesystem>
#include <functional>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

#include "fk_report.hpp"

namespace softkin::cli {

/// Keys by which a step of the report tells which shape it left.
void add_shape(Report::Json& step, const std::string& file, const Points& positions);

/// What an interrupted run has left.
struct Finished {
  std::size_t steps = 0;  // added to the report
  State state;            // of the last of them, as if it had just been solved
  std::string remark;     // for the user
};

/// The report of a run that was interrupted, and the shapes beside it; where the run is to go on.
class StoredReport {
 public:
  using Json = Report::Json;

  /// shapes: the series' .pvd.
  StoredReport(const Model& model, std::filesystem::path report, std::filesystem::path shapes)
      : model_(model), file_(std::move(report)), shapes_(std::move(shapes)) {}

  /// Adds to report, which has no steps yet, those of the report on disk whose shapes are there as they were written.
  ///
  /// keys        entries of the head that must be the same, beside version, robot and solver
  /// check_step  refuses a step that is not what is asked for now
  /// keep        takes a step over
  /// throws      InvalidInput where it is no report, or one of another robot or with other options
  Finished take(Report& report, const std::vector<std::string>& keys,
                const std::function<void(const Json& step, std::size_t i)>& check_step,
                const std::function<void(const Json& step)>& keep) const;

  [[noreturn]] void refuse(const std::string& why) const;

 private:
  void check_head(const Json& json, const Json& head, const std::vector<std::string>& keys) const;

  const Model& model_;
  std::filesystem::path file_, shapes_;
};

}  // namespace softkin::cli
