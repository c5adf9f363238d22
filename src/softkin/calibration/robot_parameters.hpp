#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <softkin/io/scene/file_contents.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A number that is fitted: of the scene by its path, as --change has it, or a coordinate of the frame in which was
/// measured: base.x, base.y, base.z [mm], base.rx, base.ry, base.rz [degrees], where the robot's frame stands in it;
/// camera.x and so on, the same where gravity turns along, as when nothing but the camera was moved.
struct FittedNumber {
  std::string name;               // its path in the scene, or the coordinate's name
  std::optional<double> start{};  // none: the scene's
  double low = -std::numeric_limits<double>::infinity(),
         high = std::numeric_limits<double>::infinity();  // bounds, in its unit
  std::optional<double> deviation{};                      // of the start as a prior; none: nothing is known before
  std::string option{};                                   // that asks for it, for messages
};

/// "NAME", "NAME=start", "NAME=start,low,high", "NAME=mean+-deviation" or "NAME=mean+-deviation,low,high".
///
/// throws  InvalidInput naming option and text
[[nodiscard]] FittedNumber parse_fitted_number(const std::string& option, const std::string& text);
[[nodiscard]] std::vector<FittedNumber> parse_fitted_numbers(const std::string& option,
                                                             const std::vector<std::string>& texts);

/// A coordinate of the measuring frame that is known, named as those that are fitted.
struct GivenNumber {
  std::string name;      // of a coordinate of the frame
  double value = 0;      // [mm, degrees]
  std::string option{};  // that gives it, for messages
};

/// "NAME=value", NAME being one of the measuring frame.
///
/// throws  InvalidInput naming option and text
[[nodiscard]] GivenNumber parse_given_number(const std::string& option, const std::string& text);
[[nodiscard]] std::vector<GivenNumber> parse_given_numbers(const std::string& option,
                                                           const std::vector<std::string>& texts);

/// Where the robot's frame stands in that of the measurements: x = rotation X + place.
struct MeasuringFrame {
  Mat3 rotation = Mat3::Identity();  // of the robot's axes, in the frame of the measurements
  Vec3 place{0, 0, 0};               // of the robot's origin there [mm]
};

/// A robot as a function of some of its numbers. Files are read once. For one thread at a time.
class NumberedRobot {
 public:
  /// inputs  the files that the scene names are added
  /// given   coordinates of the measuring frame that stay; others are 0 where they are not among the numbers
  /// throws  InvalidInput: what reading the scene throws; numbers that it does not have, starts outside their bounds,
  ///         a number that is there twice
  NumberedRobot(const RequestedScene& requested, const std::vector<FittedNumber>& numbers,
                std::vector<std::filesystem::path>& inputs, const std::vector<GivenNumber>& given = {});

  /// Those that are fitted, in the order of all values below.
  [[nodiscard]] const std::vector<FittedNumber>& numbers() const { return numbers_; }
  /// Coordinates of the measuring frame that stay.
  [[nodiscard]] const std::vector<GivenNumber>& given() const { return given_; }
  /// Where a fit begins: what was given, else the scene's value.
  [[nodiscard]] Eigen::VectorXd start() const;
  /// What a number is of the order of: what steps of it are measured by.
  [[nodiscard]] double size(std::size_t number) const { return sizes_[number]; }

  /// The robot with these numbers.
  [[nodiscard]] Model model(const Eigen::VectorXd& values) const;
  /// The measuring frame with these numbers.
  [[nodiscard]] MeasuringFrame frame(const Eigen::VectorXd& values) const;
  /// Is it one of the measuring frame?
  [[nodiscard]] bool of_frame(std::size_t number) const;
  /// Is it one of the frame alone, which the robot does not know of?
  [[nodiscard]] bool of_camera(std::size_t number) const;

 private:
  struct Six;

  void check_names() const;
  [[nodiscard]] Six six_of(const Eigen::VectorXd& values, const std::string& frame) const;
  [[nodiscard]] RobotSpec spec(const Eigen::VectorXd& values) const;

  std::string file_;
  RequestedScene requested_;
  std::shared_ptr<const scene::Node> root_;
  std::vector<FittedNumber> numbers_;
  std::vector<GivenNumber> given_;
  std::vector<double> sizes_;
  std::shared_ptr<FileContents> files_;
};

}  // namespace softkin::calibration
