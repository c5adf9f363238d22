#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/table/marker_path.hpp>

#include "model/block_mesh.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;

/// A block of 100 x 20 x 20 mm with markers tip (100, 10, 10) and side (50, 0, 10).
Model block(bool both = true) {
  RobotSpec spec = testing::block_robot(testing::block_mesh({5, 1, 1}, {100, 20, 20}));
  spec.markers.push_back({"tip", {Vec3(100, 10, 10), {}}});
  if (both) spec.markers.push_back({"side", {Vec3(50, 0, 10), {}}});
  return compile(spec);
}

class MarkerPathFile : public ::testing::Test {
 protected:
  ~MarkerPathFile() override {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }

  MarkerPath read(const Model& model, const std::string& text, const std::string& marker = "") {
    std::ofstream(file_) << text;
    return read_marker_path(file_, model, marker);
  }

  void expect_refused(const Model& model, const std::string& text, const std::vector<std::string>& parts,
                      const std::string& marker = "") {
    try {
      (void)read(model, text, marker);
      ADD_FAILURE() << "not refused: " << text;
    } catch (const InvalidInput& error) {
      for (const std::string& part : parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << "no '" << part << "' in " << error.what();
    }
  }

  const fs::path file_ = fs::temp_directory_path() / ("softkin_path_" + std::to_string(::getpid()) + ".csv");
};

TEST_F(MarkerPathFile, OneMarker) {
  const MarkerPath path = read(block(false), "# an arc\nt_s, x_mm, y_mm, z_mm\n0,100,10,10\n0.5,99,11,12\n");
  EXPECT_EQ(path.markers, std::vector<Index>{0});
  EXPECT_EQ(path.axes[0], (std::array<bool, 3>{true, true, true}));
  ASSERT_EQ(path.waypoints.size(), 2u);
  EXPECT_EQ(path.waypoints[1].targets[0], Vec3(99, 11, 12));
  EXPECT_EQ(path.waypoints[1].time, 0.5);
  EXPECT_EQ(path.waypoints[1].line, 4u);
  EXPECT_FALSE(path.waypoints[1].inserted);
}

TEST_F(MarkerPathFile, SeveralMarkersInAnyOrderAndCoordinatesThatDoNotCount) {
  const MarkerPath path = read(block(), "side_z_mm,tip_y_mm,tip_x_mm\n1,2,3\n4,5,6\n");
  EXPECT_EQ(path.markers, (std::vector<Index>{1, 0}));
  EXPECT_EQ(path.axes[0], (std::array<bool, 3>{false, false, true}));
  EXPECT_EQ(path.axes[1], (std::array<bool, 3>{true, true, false}));
  EXPECT_EQ(path.waypoints[1].targets[0], Vec3(0, 0, 4));
  EXPECT_EQ(path.waypoints[1].targets[1], Vec3(6, 5, 0));
  EXPECT_FALSE(path.waypoints[1].time.has_value());
  EXPECT_EQ(read(block(), "x_mm,y_mm\n1,2\n", "side").markers, std::vector<Index>{1});
}

TEST_F(MarkerPathFile, RefusalsNameLineAndColumn) {
  const Model one = block(false), two = block();
  const std::string name = file_.string();
  expect_refused(one, "", {name, "no header"});
  expect_refused(one, "x_mm,y_mm\n", {name, "no row"});
  expect_refused(one, "# first\nx_m,y_mm\n1,2\n", {name + ":2", "'x_m'", "not in 'm'", "'x_mm'"});
  expect_refused(one, "x_in\n1\n", {"'x_in'", "'x_mm'"});
  expect_refused(one, "tip_z_cm\n1\n", {"'tip_z_cm'", "'tip_z_mm'"});
  expect_refused(one, "x,y\n1,2\n", {"'x'", "unit is missing", "'x_mm'"});
  expect_refused(one, "t_ms,x_mm\n1,2\n", {"'t_ms'", "t_s"});
  expect_refused(one, "time,x_mm\n1,2\n", {"'time'", "t_s"});
  expect_refused(one, "w_mm\n1\n", {"'w_mm'", "expected t_s"});
  expect_refused(one, "air\n1\n", {"'air'", "expected t_s"});
  expect_refused(two, "tpi_x_mm\n1\n", {name + ":1", "no marker 'tpi'", "did you mean 'tip'"});
  expect_refused(two, "x_mm\n1\n", {"several markers", "'tip_x_mm'", "say whose all are"});
  expect_refused(two, "x_mm\n1\n", {"no marker 'tap'", "tip"}, "tap");
  expect_refused(one, "x_mm,tip_x_mm\n1,2\n", {"two columns are the x of marker 'tip'"});
  expect_refused(one, "t_s\n1\n", {"no column is a coordinate"});
  expect_refused(one, "x_mm,y_mm\n1,2\n3,nan\n", {name + ":3", "'y_mm'", "'nan'"});
  expect_refused(one, "x_mm,y_mm\n1,2\n3,inf\n", {name + ":3", "'y_mm'"});
  expect_refused(one, "x_mm,y_mm\n1\n", {name + ":2", "1 cells"});
  expect_refused(one, "t_s,x_mm\n1,2\n1,3\n", {name + ":3", "'t_s'", "1 s follows 1 s"});
  Model none = block(false);
  none.markers.clear();
  expect_refused(none, "x_mm\n1\n", {"no markers"});
}

TEST_F(MarkerPathFile, DoubtsAboutUnits) {
  const Model model = block(false);
  EXPECT_TRUE(doubts_about(model, read(model, "x_mm,y_mm,z_mm\n100,10,10\n80,10,60\n")).empty());
  EXPECT_TRUE(doubts_about(model, read(model, "x_mm,y_mm,z_mm\n400,10,10\n")).empty());  // far, but in mm
  EXPECT_TRUE(doubts_about(model, read(model, "x_mm,y_mm,z_mm\n100.001,10,10\n")).empty());
  EXPECT_TRUE(doubts_about(model, read(model, "y_mm\n9\n")).empty());
  const auto metres = doubts_about(model, read(model, "x_mm,y_mm,z_mm\n0.1,0.01,0.01\n0.08,0.01,0.06\n"));
  ASSERT_EQ(metres.size(), 1u);
  EXPECT_NE(metres[0].find("in metres"), std::string::npos);
  const auto large = doubts_about(model, read(model, "x_mm,y_mm,z_mm\n100000,10000,10000\n"));
  ASSERT_EQ(large.size(), 1u);
  EXPECT_NE(large[0].find("another unit than mm"), std::string::npos);
}

}  // namespace
}  // namespace softkin
