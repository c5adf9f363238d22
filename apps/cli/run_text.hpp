#pragma once

#include <softkin/core/progress.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/finding_text.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/model_summary.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <softkin/runs/turns.hpp>
#include <string>
#include <vector>

#include "terminal.hpp"

namespace softkin::cli {

/// Returns the message of a resumed run: how many records are done. what: "step", "waypoint" or "sample".
[[nodiscard]] std::string resumed_text(std::size_t done, std::size_t all, const std::string& what);

/// The progress of a run that was stopped, and what it leaves on disk.
struct Stopped {
  std::size_t done = 0, all = 0;
  std::string what;                          // "step"
  std::string where{};                       // what is finished is kept
  bool resumes = false;                      // by --resume
  const runs::StepRecord* record = nullptr;  // the shape on the path to the next; null: none
  std::string shape{};                       // its file; empty: not written
};
/// Prints the message on stderr; returns the exit code.
[[nodiscard]] int report_stopped(const Stopped& stopped);

/// Returns the progress of a run that --resume continues. series: file of its shapes
template <class Record>
Stopped stopped_of(const runs::Run<Record>& run, const std::string& what, const std::string& where,
                   const std::filesystem::path& series) {
  Stopped stopped{run.done(), run.size(), what, where, true};
  if (!run.stopped()) return stopped;
  stopped.record = &run.stopped()->record;
  stopped.shape = stopped_file(series).string();
  return stopped;
}

/// Takes over the records on disk and prints their number; removes half-written files that a killed run left.
template <class Record>
void resume_run(runs::Run<Record>& run, const std::vector<Output>& outputs, const std::string& what, bool quiet) {
  std::string remark;
  run.resume(remark);
  remove_torn_files(outputs);
  if (quiet) return;
  if (!remark.empty()) print(remark + "\n");
  print(resumed_text(run.done(), run.size(), what) + "\n");
}

/// The turn of a line from record to record, for the column that --turn asks for.
class LineTurn {
 public:
  LineTurn(const Model& model, const std::optional<runs::MarkerLine>& line) : line_(line) {
    if (line) meter_.emplace(line->at_rest(model));
  }

  /// Returns the turn in the next record [degrees]; none where --turn is not given.
  std::optional<double> next(const runs::StepRecord& record) {
    if (!line_) return std::nullopt;
    return meter_->next(line_->in(record.markers));
  }
  /// Follows the turn through the records of a resumed run.
  template <class Record>
  void catch_up(runs::Run<Record>& run) {
    if (line_) run.log().each([&](std::size_t, const Record& record) { (void)next(record); });
  }

 private:
  std::optional<runs::MarkerLine> line_;
  std::optional<runs::TurnMeter> meter_;
};

/// Prints the report on stdout.
template <class Record>
void show_report(runs::Run<Record>& run) {
  run.log().report(print_piece);
  print(std::string());
}

/// Records done, time and time left, on the terminal.
class RunProgress {
 public:
  /// first: the record with which the work begins.
  RunProgress(std::size_t first, std::size_t all, std::string what);

  void begin(std::size_t record);
  /// detail: of the record that is being made. fraction: how much of it is done, 0 to 1
  void show(const std::string& detail, double fraction = 0);
  void clear() { line_.clear(); }

 private:
  ProgressLine line_;
  std::size_t first_, all_, at_;
  std::string what_;
  double start_;  // [s]
  TimeLeft left_;
  double fraction_ = 0;  // of this record
};

/// Estimates the progress towards an equilibrium from the solver's progress reports.
class EquilibriumProgress {
 public:
  [[nodiscard]] double fraction(const Progress& progress);
  [[nodiscard]] static std::string text(const Progress& progress);

 private:
  double first_move_ = 0;  // [mm]
  double guess_ = 0;       // does not fall
};

using runs::ActuatorRecord;
using runs::OverlapTally;
using runs::StepRecord;

/// Makes the records that are missing and prints each as a line of the table, until one cannot be made or the user
/// interrupts.
///
/// what  a record is: "step"
/// describe  shows the progress of the current record: void(RunProgress&, const Progress&)
/// row   of the table, for the last record: Table::Row()
template <class Record, class Reporter, class Row>
runs::Advance advance_run(runs::Run<Record>& run, const Table& table, const std::string& what, bool quiet,
                          Reporter describe, Row row) {
  const bool fits = fits_output(table.header());
  if (fits && !quiet && !run.is_complete()) print(table.header() + "\n");
  RunProgress line(run.done(), run.size(), what);
  while (!run.is_complete()) {
    line.begin(run.done());
    const auto go_on = [&](const Progress& progress) {
      describe(line, progress);
      return !interrupted();
    };
    const bool over = interrupted() && run.done() > 0;  // else there is a shape to begin with
    const runs::Advance end = over ? runs::Advance::interrupted : run.advance(go_on);
    if (end != runs::Advance::made) return end;
    line.clear();
    const auto made = row();
    if (!quiet) print(fits ? table.line(made) + "\n" : joined(table.turned(made), "") + "\n");
  }
  return runs::Advance::made;
}

/// Strains, slack cables and what a step may hide, a line each.
[[nodiscard]] std::string findings_text(const Model& model, const StepRecord& step);

/// "warning: the equilibrium of steps 3 to 5 is unstable", with the cure. what: "step"
[[nodiscard]] std::string unstable_text(const std::string& what, const std::vector<std::size_t>& numbers);

}  // namespace softkin::cli
