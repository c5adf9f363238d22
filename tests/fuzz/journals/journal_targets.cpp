#include <softkin/runs/jobs.hpp>

#include "fuzz/targets.hpp"

namespace softkin::fuzz {

namespace {

const Statics& statics_of_finger() {
  static const Statics statics(finger());
  return statics;
}

runs::PathJob& path_job() {
  static const std::vector<ActuationStep> steps(4, {finger().rest_actuation(), {}, 2});
  static runs::PathJob job(statics_of_finger(), steps, "path.csv", {});
  return job;
}

runs::FollowJob& follow_job() {
  static const MarkerPath path{{0}, {{true, false, true}}, {{{Vec3(30, 0, 15)}, {}, 2, false}}};
  static runs::FollowJob job(statics_of_finger(), path, "path.csv", {});
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

/// Resumes from a journal, with a matching head or another one, or from a report as the second part.
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

}  // namespace

std::vector<Target> all_targets() {
  return {{"path_journal", "reports.dict", run_path_journal}, {"follow_journal", "reports.dict", run_follow_journal}};
}

}  // namespace softkin::fuzz
