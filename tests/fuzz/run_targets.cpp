#include <nlohmann/json.hpp>
#include <softkin/drive/marlin_answer.hpp>
#include <softkin/io/table/workspace_table.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/report_comparison.hpp>
#include <softkin/runs/workspace_file.hpp>

#include "fuzz/targets.hpp"

namespace softkin::fuzz {

namespace {

/// A report beside a second one, or beside itself.
void run_report(const Input& input) {
  const std::string first = input.file("first.json").string();
  const std::string second = input.parts() > 1 ? input.file("second.json", 1).string() : first;
  const runs::ReportedPath path = runs::read_reported_path(first);
  for (const runs::ReportedStep& step : path.steps) {
    require_finite(step.elapsed, "a time is not finite");
    for (const auto& [name, value] : step.actuation) require_finite(value, "a command is not finite");
    for (const auto& [name, place] : step.markers) require(place.allFinite(), "a place is not finite");
  }
  const runs::ReportComparison comparison = runs::compare_reports({first, second}, "", {}, {});
  (void)comparison.json();
  (void)comparison.steps();
  (void)comparison.times();
  (void)comparison.plot();
}

const Statics& statics_of_finger() {
  static const Statics statics(finger());
  return statics;
}

runs::PathJob& path_job() {
  static const std::vector<ActuationStep> steps(4, {finger().rest_actuation(), {}, 2});
  static runs::PathJob job(finger(), statics_of_finger(), steps, "path.csv", {});
  return job;
}

runs::FollowJob& follow_job() {
  static const MarkerPath path{{0}, {{true, false, true}}, {{{Vec3(30, 0, 15)}, {}, 2, false}}};
  static runs::FollowJob job(finger(), statics_of_finger(), path, "path.csv", {});
  return job;
}

/// Every line that is a record is the same when it is written and read again.
template <class Record>
void check_records(const runs::Codec<Record>& codec, const std::string& text) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string written;
    try {
      written = codec.write(codec.read(std::string_view(text).substr(begin, end - begin)));
    } catch (const InvalidInput&) {  // no record
    }
    if (!written.empty()) require(codec.write(codec.read(written)) == written, "a written record reads otherwise");
    begin = end + 1;
  }
}

/// What --resume goes on from: journal, its head fitting or not, or as second part a report.
template <class Record>
void resume(const Input& input, const runs::Job<Record>& job) {
  check_records(job.codec(), input.part(0));
  (void)input.file("report.json.run");
  (void)input.file("report.json", 1);
  const std::string head = R"({"softkin":"1","robot_fingerprint":"0","solver":{},"follow":{}})";
  runs::TypedLog<Record> log(finger(), {input.path("report.json"), input.path("shapes.pvd")}, head, {"follow"},
                             job.codec());
  for (const bool journal : {true, false}) {
    if (!journal) std::filesystem::remove(input.path("report.json.run"));
    std::string remark;
    try {
      log.resume([&](std::size_t number, const Record& record) { return job.mismatch(number, record); }, remark);
      log.report([](std::string_view) {});
    } catch (const InvalidInput&) {  // the report may be good where the journal is not
    }
  }
}

void run_path_journal(const Input& input) {
  resume(input, path_job());
}

void run_follow_journal(const Input& input) {
  resume(input, follow_job());
}

/// A workspace is the same when it is written and read again.
void run_workspace(const Input& input) {
  const runs::WorkspaceColumns columns = runs::workspace_columns(finger());
  const auto text_of = [&](const std::filesystem::path& file) {
    const WorkspaceTable table = read_workspace(file, columns);
    std::string text = workspace_header(table.head, columns);
    for (const WorkspaceSample& sample : table.samples) text += workspace_row(sample, columns);
    return text;
  };
  const std::string text = text_of(input.file("workspace.csv"));
  const Input again(text, input.path(""));
  require(again.parts() > 1 || text_of(again.file("again.csv")) == text, "a written workspace reads otherwise");
}

void run_marlin(const Input& input) {
  const drive::MarlinAnswer answer = drive::parse_answer(input.part(0));
  for (const auto& [letter, place] : answer.position) require_finite(place, "a board is nowhere");
}

}  // namespace

std::vector<Target> run_targets() {
  return {{"report", "reports.dict", run_report},
          {"path_journal", "reports.dict", run_path_journal},
          {"follow_journal", "reports.dict", run_follow_journal},
          {"workspace", "tables.dict", run_workspace},
          {"marlin", "marlin.dict", run_marlin}};
}

}  // namespace softkin::fuzz
