#include <nlohmann/json.hpp>
#include <softkin/calibration/robot_fit.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/runs/body_surface.hpp>
#include <vision/rendering.hpp>

#include "fk_samples.hpp"

/// From a picture to a modulus: softkin measure --outline, and softkin calibrate robot --outlines.

namespace {

using namespace softkin;
using namespace softkin::testing;
using nlohmann::json;

std::string outlined_scene(const std::string& modulus) {
  return replaced(loaded_scene(), "{youngs_modulus: 1,", "{region: all, youngs_modulus: " + modulus + ",");
}

/// A robot as seen along y, dark on paper: x to the right, z up.
Paint seen_along_y(const Model& model, const Points& positions) {
  std::vector<std::array<Vec2, 3>> triangles;
  for (const Triangle& t : runs::body_surface(model).triangles) {
    std::array<Vec2, 3>& corners = triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) corners[i] = {positions(t[i], 0), positions(t[i], 2)};
  }
  return [triangles](const Vec2& place) -> Eigen::Vector3d {
    const auto cross = [&](const Vec2& a, const Vec2& b) {
      return (a.x() - place.x()) * (b.y() - place.y()) - (a.y() - place.y()) * (b.x() - place.x());
    };
    const bool covered = std::any_of(triangles.begin(), triangles.end(), [&](const std::array<Vec2, 3>& t) {
      const double ab = cross(t[0], t[1]), bc = cross(t[1], t[2]), ca = cross(t[2], t[0]);
      return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
    });
    return covered ? ink : paper;
  };
}

/// A block of 0.8 MPa whose tendon is pulled, its base at the picture's frame, and poses that name its pictures.
struct Outlined : BlockFolder {
  Outlined() : BlockFolder(outlined_scene("1")) {
    std::vector<std::filesystem::path> inputs;
    RequestedScene requested;
    requested.scene = write("soft.yaml", outlined_scene("0.8"));
    const calibration::NumberedRobot robot(requested, {}, inputs);
    const Model model = robot.model(Eigen::VectorXd(0));
    const Statics statics(model);
    for (const double tension : {0.0, 4.0, 8.0}) {
      Actuation command(2);
      command << 0, tension;
      const Equilibrium found = statics.solve(command, statics.rest(), {});
      EXPECT_EQ(found.report.status, Status::converged);
      Photograph photo{.width = 260, .height = 200, .to_picture = straight(9, {-4, 150}), .blur = 0.8, .noise = 3};
      photo.seed = static_cast<unsigned>(tension) + 1;
      pictures.push_back(write("p" + std::to_string(pictures.size()) + ".png",
                               encode_png(render(photo, seen_along_y(model, found.state.positions)))));
    }
    poses = write("poses.csv", "air_kPa,tendon_N,picture\n0,0,1\n0,4,2\n0,8,3\n");
  }

  [[nodiscard]] ProgramResult measure(const std::string& table) const {
    std::vector<std::string> words{"measure"};
    words.insert(words.end(), pictures.begin(), pictures.end());
    // 9 pixels in a mm, the robot's origin at (-4, 150)
    words.insert(words.end(), {"--outline", "dark", "--scale", "5,150,95,150=10mm", "-o", table});
    return run_program(words);
  }

  [[nodiscard]] ProgramResult calibrate(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"calibrate", "robot", scene, poses};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  std::vector<std::string> pictures;
  std::string poses;
};

TEST(CalibrateOutline, FindsTheModulusBehindPictures) {
#ifndef SOFTKIN_OPENCV
  GTEST_SKIP() << "built without OpenCV";
#endif
  const Outlined folder;
  const std::string outlines = folder / "outlines.csv", report = folder / "fit.json";
  const ProgramResult measured = folder.measure(outlines);
  ASSERT_EQ(measured.exit_code, 0) << measured.errors;
  const std::vector<std::string> requested{"--outlines", outlines,           "--given",  "camera.rx=-90",
                                           "--given",    "camera.x=-1",      "--fit",    "materials.all.youngs_modulus",
                                           "--fit",      "base.z",           "--report", report,
                                           "--table",    folder / "fit.csv", "--plot",   folder / "fit.svg"};
  const ProgramResult fitted = folder.calibrate(requested);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors << fitted.output;
  const json found = json::parse(read_text(report));
  EXPECT_NEAR(found["numbers"][0]["value"].get<double>(), 0.8, 0.03 * 0.8);
  EXPECT_NEAR(found["numbers"][1]["value"].get<double>(), 0, 0.03);
  EXPECT_LT(found["outlines"]["fitted"]["rms_mm"].get<double>(), 0.06);
  EXPECT_EQ(found["outlines"]["points"], 120);
  EXPECT_EQ(found["given"]["camera.rx"], -90);
  EXPECT_EQ(found["poses"][2]["outline"]["picture"], 3);
  expect_words(fitted.output, {"outline off by [mm]", "120 of 120 points of outlines count, within ",
                               "deviation of a point of an outline as read: "});
  expect_words(read_text(folder / "fit.csv"), {"kept,outline_off_mm,counts\n", "1,2,outline1_x_mm,"});
  expect_words(read_text(folder / "fit.svg"), {"measured outline", "computed outline"});
  EXPECT_EQ(folder.calibrate(requested).exit_code, 0) << "what it wrote it replaces";
  // a prediction with the numbers of the scene, by fewer points
  const ProgramResult predicted = folder.calibrate({"--outlines", outlines, "--given", "camera.rx=-90", "--given",
                                                    "camera.x=-1", "--outline-points", "25", "--outline-within", "1"});
  ASSERT_EQ(predicted.exit_code, 0) << predicted.errors;
  expect_words(predicted.output, {" of 75 points of outlines count, within 1 mm"});
}

TEST(CalibrateOutline, RefusesWithAReason) {
  const BlockFolder folder(outlined_scene("1"));
  std::string square = "picture,x_mm,y_mm\n";
  for (const char* point : {"0,0", "5,0", "10,0", "10,5", "10,10", "5,10", "0,10", "0,5"})
    square += std::string("1,") + point + "\n";
  const std::string outlines = folder.write("outlines.csv", square);
  const std::string poses = folder.write("poses.csv", "tendon_N,picture\n1,1\n"),
                    unknown = folder.write("unknown.csv", "tendon_N,picture\n1,1\n2,2\n"),
                    none = folder.write("none.csv", "tendon_N,tip_x_mm\n1,20\n");
  const auto refused = [&](const std::vector<std::string>& words, const std::string& message) {
    const std::size_t files = folder.files();
    std::vector<std::string> all{"calibrate", "robot", folder.scene};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--fit", "base.z", "--table", folder / "fit.csv"});
    const ProgramResult result = run_program(all);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(folder.files(), files) << message;
  };
  refused({none, "--outlines", outlines}, "none.csv: no column 'picture'");
  refused({unknown, "--outlines", outlines}, "unknown.csv:3: column 'picture': there is no picture 2");
  refused({poses}, "poses.csv: its poses have pictures and no other reading");
  refused({poses, "--outlines", folder / "no.csv"}, "no.csv");
  refused({poses, "--outlines", outlines, "--given", "camera.rx"}, "--given 'camera.rx': expected NAME=VALUE");
  refused({poses, "--outlines", outlines, "--given", "base.z=1"}, "--given base.z: the number is given twice");
  refused({poses, "--outlines", outlines, "--given", "materials.all.youngs_modulus=1"}, "measuring frame");
  refused({poses, "--outlines", outlines, "--outline-within", "0"}, "--outline-within");
  refused({poses, "--outlines", outlines, "--outline-points", "0"}, "--outline-points");
  refused({none, "--outline-points", "10"}, "--outline-points: give --outlines too");
  refused({none, "--outline-within", "10"}, "--outline-within: give --outlines too");
}

}  // namespace
