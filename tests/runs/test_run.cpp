#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/shape_files.hpp>

#include "small_runs.hpp"

namespace softkin::runs {
namespace {

namespace fs = std::filesystem;
using softkin::testing::TemporaryFolder;

/// Every file of a folder, without the seconds of reports.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  static const std::regex seconds("\"seconds\": ?[-+0-9.eE]+");
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string text = softkin::testing::read_text(entry.path().string());
    if (entry.path().extension() == ".json") text = std::regex_replace(text, seconds, "seconds");
    files[entry.path().filename().string()] = std::move(text);
  }
  return files;
}

void expect_same_files(const fs::path& folder, const std::map<std::string, std::string>& expected,
                       const std::string& what) {
  const auto files = files_of(folder);
  EXPECT_EQ(files.size(), expected.size()) << what;
  for (const auto& [name, text] : expected) {
    ASSERT_TRUE(files.contains(name)) << what << ": " << name;
    EXPECT_TRUE(files.at(name) == text) << what << ": " << name;
  }
}

/// Runs the jobs of make(): undisturbed, then interrupted after every `pause` records and continued by a new one.
template <class Record>
void expect_resumable(const Model& model, const std::string& head, std::size_t pause,
                      const std::function<std::unique_ptr<Job<Record>>()>& make) {
  const TemporaryFolder undisturbed, disturbed;
  const auto files = [](const TemporaryFolder& folder) { return RunFiles{folder / "r.json", folder / "s.pvd"}; };
  {
    const auto job = make();
    Run<Record> run(model, *job, files(undisturbed), head, {});
    while (!run.is_complete()) ASSERT_EQ(run.advance({}), Advance::made);
    EXPECT_TRUE(fs::exists(undisturbed / "r.json.run"));
    EXPECT_FALSE(fs::exists(undisturbed / "r.json"));
    run.finish();
  }
  const auto expected = files_of(undisturbed / "");
  EXPECT_FALSE(expected.contains("r.json.run"));
  for (bool complete = false; !complete;) {
    const auto job = make();
    Run<Record> run(model, *job, files(disturbed), head, {});
    std::string remark;
    run.resume(remark);
    EXPECT_EQ(run.done() % pause, 0u);
    for (std::size_t i = 0; i < pause && !run.is_complete(); ++i) ASSERT_EQ(run.advance({}), Advance::made);
    complete = run.is_complete();
    // every other time as if it was killed, else as if the user had interrupted it
    if (complete || run.done() / pause % 2 == 0) run.finish();
  }
  expect_same_files(disturbed / "", expected, "paused every " + std::to_string(pause));
}

constexpr std::size_t beyond_a_fresh_start = Run<StepRecord>::fresh_every + 4;

TEST(Run, OfAPathGoesOnBitByBitAtEveryRecord) {
  for (const Model& model : {testing::bending_model(), testing::swelling_model()}) {
    const Statics statics(model);
    const auto steps = testing::steps_of(model, beyond_a_fresh_start);
    for (const std::size_t pause : {std::size_t{1}, std::size_t{7}})
      expect_resumable<StepRecord>(model, report_head(model, "block.yaml", testing::one_thread()), pause, [&] {
        statics.forget();
        return std::make_unique<PathJob>(statics, steps, "path.csv", testing::one_thread());
      });
  }
}

TEST(Run, OfAFollowedPathGoesOnBitByBit) {
  const Model model = testing::bending_model();
  const MarkerPath path = testing::path_through(model, testing::steps_of(model, beyond_a_fresh_start));
  const Statics statics(model);
  TrajectoryOptions options;
  options.inverse.statics = testing::one_thread();
  // continues from before the fresh start and from after it, once killed and once interrupted
  constexpr std::size_t pause = beyond_a_fresh_start / 2 - 1;
  expect_resumable<WaypointRecord>(model, follow_head(model, "block.yaml", options), pause, [&] {
    statics.forget();
    return std::make_unique<FollowJob>(statics, path, "path.csv", options);
  });
}

struct WalkerAndJob : Job<WalkRecord> {
  Walker walker;
  WalkJob job;

  WalkerAndJob(const Model& model, const std::vector<GaitStep>& steps)
      : walker(model, testing::one_thread()), job(model, walker, steps, "gait.csv") {}
  [[nodiscard]] std::size_t size() const override { return job.size(); }
  [[nodiscard]] Codec<WalkRecord> codec() const override { return job.codec(); }
  [[nodiscard]] std::string mismatch(std::size_t number, const WalkRecord& record) const override {
    return job.mismatch(number, record);
  }
  [[nodiscard]] Made make(std::size_t number, const ProgressCallback& progress) override {
    return job.make(number, progress);
  }
  [[nodiscard]] bool keeps(const WalkRecord& record) const override { return job.keeps(record); }
  void go_on(std::size_t number, const WalkRecord& before, Points positions) override {
    job.go_on(number, before, std::move(positions));
  }
};

TEST(Run, OfAWalkGoesOnBitByBitAtEveryRecord) {
  const Model model = testing::walking_model();
  const auto gait = repeated(
      model, "gait.csv",
      {{Actuation::Zero(1), 0.0}, {Actuation::Ones(1), 0.5}, {2 * Actuation::Ones(1), 1.0}, {Actuation::Zero(1), 1.5}},
      13);
  const std::string head = walk_head(model, "block.yaml", testing::one_thread(), "gait.csv", 13, Vec3::UnitX());
  for (const std::size_t pause : {std::size_t{1}, std::size_t{9}})
    expect_resumable<WalkRecord>(model, head, pause, [&] { return std::make_unique<WalkerAndJob>(model, gait); });
}

class PathRun : public ::testing::Test {
 protected:
  PathRun() : model_(testing::bending_model()), statics_(model_), steps_(testing::steps_of(model_, 6)) {}

  /// Makes a number of records.
  void make(std::size_t count, bool finish, const std::string& head = "") {
    PathJob job = path_job();
    runs::Run<StepRecord> run = path_run(job, head);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(run.advance({}), Advance::made);
    if (finish) run.finish();
  }
  /// Goes on with what is there, to its end.
  void make_rest() {
    PathJob job = path_job();
    runs::Run<StepRecord> run = path_run(job);
    std::string remark;
    run.resume(remark);
    while (!run.is_complete()) ASSERT_EQ(run.advance({}), Advance::made);
    run.finish();
  }
  [[nodiscard]] PathJob path_job() const { return {statics_, steps_, "path.csv", testing::one_thread()}; }
  [[nodiscard]] runs::Run<StepRecord> path_run(PathJob& job, const std::string& head = "") const {
    return {model_,
            job,
            {folder_ / "r.json", folder_ / "s.pvd"},
            head.empty() ? report_head(model_, "block.yaml", testing::one_thread()) : head,
            {}};
  }
  /// Returns the remark of resume and the number of records that it finds.
  [[nodiscard]] std::pair<std::string, std::size_t> resumed() const {
    PathJob job = path_job();
    runs::Run<StepRecord> run = path_run(job);
    std::string remark;
    run.resume(remark);
    return {remark, run.done()};
  }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)resumed();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "it goes on";
  }

  TemporaryFolder folder_;
  Model model_;
  Statics statics_;
  std::vector<ActuationStep> steps_;
};

TEST_F(PathRun, WithoutFilesBeginsAndSaysSo) {
  const auto [remark, done] = resumed();
  EXPECT_EQ(remark, "there is no " + folder_ / "r.json" + " yet");
  EXPECT_EQ(done, 0u);
}

TEST_F(PathRun, GoesOnWithTheReportOfAnInterruptedRun) {
  make(3, true);
  EXPECT_FALSE(fs::exists(folder_ / "r.json.run"));
  EXPECT_EQ(resumed(), (std::pair<std::string, std::size_t>{"", 3}));
  EXPECT_TRUE(fs::exists(folder_ / "r.json.run"));
  EXPECT_EQ(resumed(), (std::pair<std::string, std::size_t>{"", 3}));
}

TEST_F(PathRun, GoesOnBeforeAShapeThatIsNotThatOfItsRecord) {
  make(4, false);
  fs::copy_file(folder_ / "s_0000.vtu", folder_ / "s_0002.vtu", fs::copy_options::overwrite_existing);
  EXPECT_EQ(resumed(), (std::pair<std::string, std::size_t>{
                           folder_ / "s_0002.vtu" + " is missing or not the shape of the report", 2}));
  EXPECT_EQ(resumed(), (std::pair<std::string, std::size_t>{"", 2}));
}

TEST_F(PathRun, RefusesRecordsThatAreNotItsOwn) {
  make(3, false);
  const std::string journal = softkin::testing::read_text(folder_ / "r.json.run");
  const auto damaged = [&](const std::string& part, const std::string& by) {
    folder_.write("r.json.run", softkin::testing::replaced(journal, part, by));
    const std::string why = refusal();
    EXPECT_EQ(softkin::testing::read_text(folder_ / "r.json.run"), softkin::testing::replaced(journal, part, by));
    return why;
  };
  const auto expect_reported = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find("cannot go on from this report: " + part), std::string::npos) << text;
  };
  expect_reported(damaged("\"status\"", "\"state\""), "it is not a report that this command wrote");
  expect_reported(damaged("{\"softkin\"", "\"softkin\""), "it is not a report that this command wrote");
  expect_reported(damaged("\"robot_fingerprint\":\"", "\"robot_fingerprint\":\"0"), "it is of another robot");
  expect_reported(damaged("\"max_iterations\":500", "\"max_iterations\":7"), "it was made with other solver options");
  const std::string deep = std::string(300000, '[') + std::string(300000, ']');
  expect_reported(damaged("\"robot_fingerprint\":\"", "\"robot_fingerprint\":" + deep + ",\"x\":\""),
                  "it is not a report that this command wrote");
  steps_[1].actuation[0] += 1e-3;
  folder_.write("r.json.run", journal);
  expect_reported(refusal(), "step 1 was solved for air = ");
  EXPECT_EQ(softkin::testing::read_text(folder_ / "r.json.run"), journal);
}

TEST_F(PathRun, InterruptedWhileItRepeatsKeepsWhatIsThere) {
  make(3, false);
  PathJob job = path_job();
  runs::Run<StepRecord> run = path_run(job);
  std::string remark;
  run.resume(remark);
  EXPECT_EQ(run.advance([](const Progress&) { return false; }), Advance::interrupted);
  EXPECT_EQ(run.done(), 3u);
  EXPECT_EQ(run.advance({}), Advance::made);
  EXPECT_EQ(run.done(), 4u);
}

/// A stopped run writes the shape on the path to the next record next to the series; a finished run leaves no trace of
/// it.
TEST_F(PathRun, StoppedLeavesTheLastShapeOnItsWay) {
  PathJob job = path_job();
  runs::Run<StepRecord> run = path_run(job);
  ASSERT_EQ(run.advance({}), Advance::made);
  ASSERT_EQ(run.advance([](const Progress&) { return false; }), Advance::interrupted);
  ASSERT_NE(run.stopped(), nullptr);
  run.finish();
  EXPECT_EQ(run.done(), 1u);
  const nlohmann::json report = nlohmann::json::parse(softkin::testing::read_text(folder_ / "r.json"));
  EXPECT_EQ(report["steps"].size(), 1u);
  EXPECT_EQ(report["stopped"]["status"], "interrupted");
  EXPECT_EQ(report["stopped"]["reached"], 0);
  const std::string shape = folder_ / "s_stopped.vtu";
  EXPECT_EQ(report["stopped"]["shape"], "s_stopped.vtu");
  const State state = read_state(shape, model_);
  EXPECT_EQ(state.positions, read_vtu_points(folder_ / "s_0000.vtu"));
  EXPECT_EQ(state.actuation, steps_[0].actuation);
  make_rest();
  EXPECT_FALSE(std::filesystem::exists(shape));
  EXPECT_FALSE(nlohmann::json::parse(softkin::testing::read_text(folder_ / "r.json")).contains("stopped"));
}

}  // namespace
}  // namespace softkin::runs
