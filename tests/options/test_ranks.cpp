#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "cli/fk_samples.hpp"
#include "support/patience.hpp"

/// A workspace that processes of mpirun share: the file is that of a single process.

namespace {

using namespace softkin::testing;
namespace fs = std::filesystem;

/// Open MPI refuses root unless it is allowed twice, and more ranks than cores unless that is allowed.
std::string mpirun(int ranks, const std::string& command) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 exec mpirun "
         "-np " +
         std::to_string(ranks) + " " + command;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line = shell_quoted(SOFTKIN_PROGRAM);
  for (const std::string& word : words) line += " " + shell_quoted(word);
  return line;
}

/// A folder of a block robot, with its workspace.
struct RanksFolder : BlockFolder {
  std::string output = *this / "reach.csv";

  explicit RanksFolder(const std::string& text) : BlockFolder(text) {}

  [[nodiscard]] std::vector<std::string> words(std::vector<std::string> more) const {
    more.insert(more.begin(), {"workspace", scene, "-o", output, "--threads", "1"});
    return more;
  }
  [[nodiscard]] ProgramResult run(int ranks, const std::vector<std::string>& more) const {
    return run_shell(mpirun(ranks, joined(words(more))) + " </dev/null 2>&1");
  }
};

/// The block, between narrow ranges.
std::string small_ranges() {
  return replaced(replaced(physical_scene(), "range: [0.5, 3]", "range: [1, 1.6]"), "range: [0.5, 1.2]",
                  "range: [0.85, 1]");
}

/// Pressures of which some have no equilibrium: their rows hold the last good shape.
std::string large_pressures() {
  return replaced(loaded_scene(), "[-100, 3000]", "[0, 3000]");
}

std::string target_shapes() {
  return block_scene();
}

void expect_the_same_file(const std::string& scene, const std::vector<std::string>& options, int exit_code) {
  const RanksFolder alone(scene), shared(scene);
  const ProgramResult single = run_program(alone.words(options));
  ASSERT_EQ(single.exit_code, exit_code) << single.errors;
  for (const int ranks : {1, 2, 4}) {
    const ProgramResult result = shared.run(ranks, options);
    EXPECT_EQ(result.exit_code == 0, exit_code == 0) << result.output;
    EXPECT_EQ(read_text(shared.output), read_text(alone.output)) << ranks << " ranks:\n" << result.output;
  }
}

TEST(Ranks, WriteTheFileOfOneProcess) {
  expect_the_same_file(small_ranges(), {"--samples", "120", "--sampling", "sobol"}, 0);
}

TEST(Ranks, WriteTheFileOfOneProcessWhereSamplesEndAtALimit) {
  const std::vector<std::string> options{"--samples", "9"};
  expect_the_same_file(large_pressures(), options, 1);
  const RanksFolder folder(large_pressures());
  (void)folder.run(2, options);
  EXPECT_NE(read_text(folder.output).find(",limit,0."), std::string::npos) << read_text(folder.output);
}

TEST(Ranks, WriteTheFileOfOneProcessOfTargetShapes) {
  for (const char* solver : {"newton", "local-global"})
    expect_the_same_file(target_shapes(), {"--samples", "30", "--sampling", "random", "--solver", solver}, 0);
}

TEST(Ranks, ShareTheWorkspaceOfAnExample) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{"workspace",
                                       SOFTKIN_SOURCE_DIR "/examples/three_tendon_finger/three_tendon_finger.yaml",
                                       "--formulation",
                                       "target-shape",
                                       "--samples",
                                       "27",
                                       "--threads",
                                       "1",
                                       "-o"};
  std::vector<std::string> alone = words, two = words;
  alone.push_back(folder / "one.csv");
  two.push_back(folder / "two.csv");
  ASSERT_EQ(run_program(alone).exit_code, 0);
  const ProgramResult result = run_shell(mpirun(2, joined(two)) + " </dev/null 2>&1");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("2 ranks"), std::string::npos) << result.output;
  EXPECT_EQ(read_text(folder / "two.csv"), read_text(folder / "one.csv"));
}

TEST(Ranks, ReportAnErrorOnce) {
  const RanksFolder folder(small_ranges());
  const ProgramResult refused =
      run_shell(mpirun(2, joined({"workspace", folder / "no.yaml", "--samples", "4", "-o", folder / "no.csv"})) +
                " </dev/null 2>&1");
  EXPECT_NE(refused.exit_code, 0);
  const std::size_t first = refused.output.find("no such file");
  EXPECT_NE(first, std::string::npos) << refused.output;
  EXPECT_EQ(refused.output.find("no such file", first + 1), std::string::npos) << refused.output;
  EXPECT_FALSE(fs::exists(folder / "no.csv"));
}

/// mpirun with ranks whose process numbers are in files.
class StartedRanks {
 public:
  StartedRanks(const RanksFolder& folder, int ranks, const std::vector<std::string>& options) : folder_(folder) {
    const std::string script =
        folder.write("rank.sh", "echo $$ >" + shell_quoted(folder / "pid") + "$OMPI_COMM_WORLD_RANK\nexec " +
                                    joined(folder.words(options)) + "\n");
    const std::string line =
        mpirun(ranks, "sh " + shell_quoted(script)) + " </dev/null >" + shell_quoted(folder / "log") + " 2>&1";
    process_ = ::fork();
    if (process_ == 0) {
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      ::_exit(127);
    }
    if (process_ < 0) throw std::runtime_error("cannot start mpirun");
  }
  ~StartedRanks() {
    if (process_ > 0) {
      ::kill(process_, SIGTERM);
      ::waitpid(process_, nullptr, 0);
    }
  }
  StartedRanks(const StartedRanks&) = delete;
  StartedRanks& operator=(const StartedRanks&) = delete;

  [[nodiscard]] pid_t launcher() const { return process_; }
  [[nodiscard]] pid_t rank(int number) const {
    return static_cast<pid_t>(std::stol("0" + read_text(folder_ / ("pid" + std::to_string(number)))));
  }
  [[nodiscard]] std::size_t rows() const {
    std::size_t count = 0;
    for (const std::string& line : lines_of(read_text(folder_.output))) count += !line.empty() && line[0] != '#';
    return count == 0 ? 0 : count - 1;  // the line of the columns
  }
  /// false where a minute passed before, more where all is slow.
  template <class Condition>
  [[nodiscard]] static bool wait_until(const Condition& condition) {
    for (int i = 0; i < 200 * patient(60); ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  [[nodiscard]] int wait() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  const RanksFolder& folder_;
  pid_t process_ = -1;
};

const std::vector<std::string> many{"--samples", "6000", "--sampling", "sobol"};

std::vector<std::string> resumed() {
  std::vector<std::string> options = many;
  options.emplace_back("--resume");
  return options;
}

/// An interrupted run leaves no process behind, and another run continues its table.
void expect_resumed(int ranks, const std::function<void(const StartedRanks&)>& end) {
  static const std::string whole = [] {
    const RanksFolder alone(small_ranges());
    EXPECT_EQ(run_program(alone.words(many)).exit_code, 0);
    return read_text(alone.output);
  }();
  const RanksFolder folder(small_ranges());
  std::vector<pid_t> processes;
  {
    StartedRanks started(folder, ranks, many);
    ASSERT_TRUE(started.wait_until([&] { return started.rows() > 20; })) << read_text(folder / "log");
    for (int rank = 0; rank < ranks; ++rank) processes.push_back(started.rank(rank));
    end(started);
    EXPECT_NE(started.wait(), 0) << read_text(folder / "log");
  }
  for (const pid_t process : processes)
    EXPECT_TRUE(StartedRanks::wait_until([&] { return ::kill(process, 0) != 0; })) << "process " << process << " runs";
  EXPECT_LT(read_text(folder.output).size(), whole.size());
  const ProgramResult result = folder.run(ranks, resumed());
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find(" of 6000 samples were done before: going on"), std::string::npos) << result.output;
  EXPECT_EQ(read_text(folder.output), whole);
}

TEST(Ranks, AKilledRankEndsTheRunWhichIsResumed) {
  expect_resumed(2, [](const StartedRanks& started) { ::kill(started.rank(1), SIGKILL); });
}

TEST(Ranks, TheFirstRankKilledEndsTheRunWhichIsResumed) {
  expect_resumed(4, [](const StartedRanks& started) { ::kill(started.rank(0), SIGKILL); });
}

TEST(Ranks, AnInterruptOfMpirunEndsTheRunWhichIsResumed) {
  expect_resumed(2, [](const StartedRanks& started) { ::kill(started.launcher(), SIGINT); });
}

}  // namespace
