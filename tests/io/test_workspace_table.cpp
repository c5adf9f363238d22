#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/workspace_table.hpp>

#include "gmsh_samples.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;

const WorkspaceColumns columns{{"air_kPa", "tendon"}, {"tip_x_mm", "tip_y_mm", "tip_z_mm"}, {"tendon_tension_N"}, {1}};
const WorkspaceHead head{{"softkin workspace", "format 2"}, {"robot", "0123"}, {"samples", "3"}};
const std::string header =
    "# softkin workspace: format 2\n# robot: 0123\n# samples: 3\n"
    "sample,air_kPa,tendon,tip_x_mm,tip_y_mm,tip_z_mm,tendon_tension_N,status,reached,iterations\n";

class WorkspaceTables : public ::testing::Test {
 protected:
  WorkspaceTables() {
    std::string name = (fs::temp_directory_path() / "softkin_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
  }
  ~WorkspaceTables() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  WorkspaceTable read(const std::string& content) {
    write_file(folder_ / "w.csv", content);
    return read_workspace(folder_ / "w.csv", columns);
  }

  void expect_refused(const std::string& content, const std::string& message) {
    try {
      (void)read(content);
      ADD_FAILURE() << "not refused: " << message;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("w.csv"), std::string::npos) << error.what();
    }
  }

  fs::path folder_;
};

WorkspaceSample sample(Index number, std::mt19937& generator) {
  std::uniform_real_distribution<double> anything(-1e3, 1e3);
  WorkspaceSample made;
  made.number = number;
  made.status = Status::converged;
  made.reached = 1;
  made.iterations = 7;
  made.actuation = Eigen::Vector2d(anything(generator), anything(generator) * 1e-9);
  made.markers.resize(1, 3);
  made.markers << anything(generator), -0.0, anything(generator) * 1e20;
  made.multipliers = Eigen::Vector2d(0, anything(generator));
  return made;
}

TEST_F(WorkspaceTables, ReadBackAsTheyWereToTheLastBit) {
  std::mt19937 generator(1);
  std::string text = workspace_header(head, columns);
  EXPECT_EQ(text, header);
  std::vector<WorkspaceSample> samples;
  for (Index i = 0; i < 50; ++i) {
    samples.push_back(sample(49 - i, generator));
    text += workspace_row(samples.back(), columns);
  }
  const WorkspaceTable table = read(text);
  EXPECT_EQ(table.head, head);
  EXPECT_FALSE(table.torn);
  ASSERT_EQ(table.samples.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(table.samples[i].number, samples[i].number);
    EXPECT_EQ(table.samples[i].actuation, samples[i].actuation);
    EXPECT_EQ(table.samples[i].markers, samples[i].markers);
    EXPECT_EQ(table.samples[i].multipliers, samples[i].multipliers);
    EXPECT_EQ(table.rows[i], workspace_row(samples[i], columns));
  }
}

TEST_F(WorkspaceTables, SamplesWithoutAnEquilibriumHaveEmptyCells) {
  std::mt19937 generator(2);
  for (const Status status : {Status::limit, Status::not_converged}) {
    WorkspaceSample missed = sample(0, generator);
    missed.status = status;
    missed.markers.resize(0, 3);
    missed.multipliers.resize(0);
    missed.actuation = Eigen::Vector2d(0.25, -0.0);
    const std::string row = workspace_row(missed, columns);
    EXPECT_EQ(row, std::string("0,0.25,0,,,,,") + workspace_status(status) + ",,7\n");
    const WorkspaceTable table = read(header + row);
    ASSERT_EQ(table.samples.size(), 1u);
    EXPECT_EQ(table.samples[0].status, status);
    EXPECT_EQ(table.samples[0].markers.rows(), 0);
    EXPECT_EQ(table.samples[0].multipliers.size(), 0);
  }
}

/// Processes send each other samples as rows.
TEST_F(WorkspaceTables, ARowAloneIsReadAsInItsTable) {
  std::mt19937 generator(3);
  for (const double reached : {1.0, 0.75}) {
    WorkspaceSample written = sample(17, generator);
    written.status = reached == 1 ? Status::converged : Status::limit;
    written.reached = reached;
    const std::string row = workspace_row(written, columns);
    const WorkspaceSample found = read_workspace_row(row, columns, "rank 2");
    EXPECT_EQ(found.number, 17);
    EXPECT_EQ(found.actuation, written.actuation);
    EXPECT_EQ(found.markers, written.markers);
    EXPECT_EQ(found.multipliers, written.multipliers);
    EXPECT_EQ(found.status, written.status);
    EXPECT_EQ(found.reached, reached);
    EXPECT_EQ(found.iterations, written.iterations);
    EXPECT_EQ(workspace_row(found, columns), row);
  }
  try {
    (void)read_workspace_row("17,1,2,3,4,5,6,converged,7\n", columns, "rank 2");
    ADD_FAILURE() << "a row without the column 'reached' is read";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).rfind("rank 2: ", 0), 0u) << error.what();
  }
}

TEST_F(WorkspaceTables, SamplesAtALimitKeepTheLastGoodShape) {
  const std::string row = "0,0.25,0,1,2,3,4,limit,0.75,7\n";
  const WorkspaceTable table = read(header + row);
  EXPECT_EQ(table.samples[0].reached, 0.75);
  EXPECT_EQ(table.samples[0].markers(0, 2), 3);
  EXPECT_EQ(workspace_row(table.samples[0], columns), row);
  for (const char* wrong : {"limit,1", "limit,0", "limit,-0.1", "converged,0.5", "not_converged,0.5"})
    expect_refused(header + "0,0.25,0,1,2,3,4," + wrong + ",7\n", "w.csv:5: column 'reached' must be 1 where");
  expect_refused(header + "0,0.25,0,1,2,3,4,limit,,7\n", "without an equilibrium has values");
}

TEST_F(WorkspaceTables, LastLineThatIsTornIsNoRowWhereverItIsTorn) {
  const std::string first = "0,1,2,3,4,5,6,converged,1,7\n", second = "1,1,2,3,4,5,6,converged,1,8\n";
  for (std::size_t length = 0; length < second.size(); ++length) {
    const WorkspaceTable table = read(header + first + second.substr(0, length));
    EXPECT_EQ(table.samples.size(), 1u) << length;
    EXPECT_EQ(table.torn, length > 0) << length;
    EXPECT_EQ(table.whole_bytes, (header + first).size()) << length;
  }
}

TEST_F(WorkspaceTables, RefusesWhatIsNoWorkspaceOfTheRobot) {
  expect_refused("", "is not a workspace that softkin wrote");
  expect_refused("a,b\n1,2\n", "is not a workspace that softkin wrote");
  expect_refused("# softkin workspace: format 2\nsample,air,status,iterations\n", "w.csv:2: the columns are those of");
  expect_refused(header.substr(0, header.size() - 3), "the columns are those of another robot");
}

TEST_F(WorkspaceTables, RefusesRowsThatAreNone) {
  const std::string row = "0,1,2,3,4,5,6,converged,1,7\n";
  expect_refused(header + "x,1,2,3,4,5,6,converged,1,7\n",
                 "w.csv:5: column 'sample' must hold a whole number, not 'x'");
  expect_refused(header + "-1,1,2,3,4,5,6,converged,1,7\n", "column 'sample' must hold a whole number");
  expect_refused(header + "0,nan,2,3,4,5,6,converged,1,7\n", "column 'air_kPa' must hold a finite number");
  expect_refused(header + "0,1,2,3,inf,5,6,converged,1,7\n", "column 'tip_y_mm' must hold a finite number");
  expect_refused(header + "0,1,2,3,4,5,,converged,1,7\n", "column 'tendon_tension_N' must hold a finite number");
  expect_refused(header + "0,1,2,3,4,5,6,unsure,,7\n", "must hold converged, not_converged or limit, not 'unsure'");
  expect_refused(header + "0,1,2,3,4,5,6,limit,,7\n", "a sample without an equilibrium has values");
  expect_refused(header + "0,1,2,3,4,5,6,converged\n", "fewer cells");
  expect_refused(header + "0,1,2,3,4,5,6,converged,1,7,8\n", "more cells");
  expect_refused(header + "\n" + row, "w.csv:5");
  expect_refused(header + row + row, "w.csv:6: sample 0 stands twice");
}

TEST_F(WorkspaceTables, RefuseNamesThatACsvFileCannotHold) {
  for (const std::string name : {"a,b", "a\"b", "a\tb", "", "#a", "tip_x_mm"}) {
    WorkspaceColumns other = columns;
    other.actuators[0] = name;
    EXPECT_THROW((void)workspace_header(head, other), InvalidInput) << name;
  }
}

}  // namespace
}  // namespace softkin
