#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <softkin/calibration/robot_parameters.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/changes.hpp>

namespace softkin::calibration {

namespace {

constexpr std::array<const char*, 6> frame_parts{"x", "y", "z", "rx", "ry", "rz"};

/// Which coordinate of the frame a name is; 0 to 5.
std::optional<int> frame_part(const std::string& name, const std::string& frame) {
  for (std::size_t i = 0; i < frame_parts.size(); ++i)
    if (name == frame + "." + frame_parts[i]) return static_cast<int>(i);
  return std::nullopt;
}

bool is_of_frame(const std::string& name) {
  return frame_part(name, "base") || frame_part(name, "camera");
}

/// Turns about x, then y, then z of the frame that stands still.
Mat3 turned(const Vec3& degrees) {
  const Vec3 angle = degrees * std::numbers::pi / 180;
  return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace

/// Coordinates of a frame.
struct NumberedRobot::Six {
  Vec3 place{0, 0, 0}, degrees{0, 0, 0};

  void set(int part, double value) { (part < 3 ? place[part] : degrees[part - 3]) = value; }
};

NumberedRobot::Six NumberedRobot::six_of(const Eigen::VectorXd& values, const std::string& frame) const {
  Six six;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (const auto part = frame_part(numbers_[i].name, frame)) six.set(*part, values[i]);
  for (const GivenNumber& given : given_)
    if (const auto part = frame_part(given.name, frame)) six.set(*part, given.value);
  return six;
}

FittedNumber parse_fitted_number(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput(option + " " + excerpt(text) + ": " + why); };
  const auto number = [&](std::string_view part) {
    double value = 0;
    if (!parse_real(part, value)) refuse("expected a finite number, not " + excerpt(part));
    return value;
  };
  FittedNumber fitted;
  fitted.option = option;
  const std::size_t equals = text.find('=');
  fitted.name = text.substr(0, equals);
  if (fitted.name.empty()) refuse("expected NAME, NAME=START, NAME=START,LOW,HIGH or NAME=MEAN+-DEVIATION");
  if (equals == std::string::npos) return fitted;
  std::string_view rest = std::string_view(text).substr(equals + 1);
  const std::size_t comma = rest.find(',');
  std::string_view first = rest.substr(0, comma);
  if (const std::size_t sign = first.find("+-"); sign != std::string_view::npos) {
    fitted.deviation = number(trimmed(first.substr(sign + 2)));
    if (!(*fitted.deviation > 0)) refuse("the deviation must be above 0");
    first = first.substr(0, sign);
  }
  fitted.start = number(trimmed(first));
  if (comma == std::string_view::npos) return fitted;
  rest = rest.substr(comma + 1);
  const std::size_t second = rest.find(',');
  if (second == std::string_view::npos) refuse("expected both bounds, as NAME=START,LOW,HIGH");
  fitted.low = number(trimmed(rest.substr(0, second)));
  fitted.high = number(trimmed(rest.substr(second + 1)));
  if (!(fitted.low < fitted.high)) refuse("the low bound must be below the high one");
  if (*fitted.start < fitted.low || *fitted.start > fitted.high) refuse("the start is outside its bounds");
  return fitted;
}

std::vector<FittedNumber> parse_fitted_numbers(const std::string& option, const std::vector<std::string>& texts) {
  std::vector<FittedNumber> numbers;
  for (const std::string& text : texts) numbers.push_back(parse_fitted_number(option, text));
  return numbers;
}

GivenNumber parse_given_number(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput(option + " " + excerpt(text) + ": " + why); };
  const std::size_t equals = text.find('=');
  GivenNumber given{text.substr(0, equals), 0, option};
  if (equals == std::string::npos) refuse("expected NAME=VALUE");
  if (!is_of_frame(given.name))
    refuse(
        "only numbers of the measuring frame are given: base.x, base.rx, ... or camera.x, camera.rx, ...; the "
        "scene says all others");
  const std::string value(trimmed(std::string_view(text).substr(equals + 1)));
  if (!parse_real(value, given.value)) refuse("expected a finite number, not " + excerpt(value));
  return given;
}

std::vector<GivenNumber> parse_given_numbers(const std::string& option, const std::vector<std::string>& texts) {
  std::vector<GivenNumber> numbers;
  for (const std::string& text : texts) numbers.push_back(parse_given_number(option, text));
  return numbers;
}

NumberedRobot::NumberedRobot(const RequestedScene& requested, const std::vector<FittedNumber>& numbers,
                             std::vector<std::filesystem::path>& inputs, const std::vector<GivenNumber>& given)
    : file_(requested.scene),
      requested_(requested),
      numbers_(numbers),
      given_(given),
      files_(std::make_shared<FileContents>()) {
  check_names();
  root_ = scene::parse_yaml(read_scene_file(requested.scene), requested.scene);
  for (const std::string& material : requested.materials)
    root_ = scene::changed(root_, "--material", material, "materials");
  for (const std::string& each : requested.changes) root_ = scene::changed(root_, "--change", each, "");
  for (FittedNumber& number : numbers_) {
    if (!number.start)
      number.start = is_of_frame(number.name) ? 0.0 : scene::number_at(root_, number.option, number.name);
    if (*number.start < number.low || *number.start > number.high)
      throw InvalidInput(number.option + " " + number.name + ": its start, " + softkin::number(*number.start) +
                         ", is outside its bounds");
    const bool bounded = std::isfinite(number.high - number.low);
    const bool turns = number.name.find(".r") != std::string::npos && is_of_frame(number.name);
    sizes_.push_back(*number.start != 0 ? std::abs(*number.start)
                     : number.deviation ? *number.deviation
                     : bounded          ? 0.5 * (number.high - number.low)
                     : turns            ? 10.0
                                        : 1.0);
  }
  (void)spec(start());
  const std::vector<std::filesystem::path> read = files_->paths();
  inputs.insert(inputs.end(), read.begin(), read.end());
}

void NumberedRobot::check_names() const {
  std::set<std::string> names;
  for (const FittedNumber& number : numbers_)
    if (!names.insert(number.name).second)
      throw InvalidInput(number.option + " " + number.name + ": the number is given twice");
  for (const GivenNumber& number : given_)
    if (!names.insert(number.name).second)
      throw InvalidInput(number.option + " " + number.name + ": the number is given twice, or fitted, too");
}

Eigen::VectorXd NumberedRobot::start() const {
  Eigen::VectorXd values(numbers_.size());
  for (std::size_t i = 0; i < numbers_.size(); ++i) values[i] = *numbers_[i].start;
  return values;
}

RobotSpec NumberedRobot::spec(const Eigen::VectorXd& values) const {
  std::shared_ptr<const scene::Node> root = root_;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (!is_of_frame(numbers_[i].name))
      root = scene::changed(root, numbers_[i].option, numbers_[i].name + "=" + exact(values[i]), "");
  RobotSpec spec = parse_scene(*root, file_, files_->kept(true));
  change(spec, requested_);
  spec.loads.gravity = turned(six_of(values, "base").degrees).transpose() * spec.loads.gravity;
  return spec;
}

Model NumberedRobot::model(const Eigen::VectorXd& values) const {
  return compile(spec(values));
}

MeasuringFrame NumberedRobot::frame(const Eigen::VectorXd& values) const {
  const Six base = six_of(values, "base"), camera = six_of(values, "camera");
  const Mat3 rotation = turned(camera.degrees);
  return {rotation * turned(base.degrees), rotation * base.place + camera.place};
}

bool NumberedRobot::of_frame(std::size_t number) const {
  return is_of_frame(numbers_[number].name);
}

bool NumberedRobot::of_camera(std::size_t number) const {
  return frame_part(numbers_[number].name, "camera").has_value() ||
         frame_part(numbers_[number].name, "base").value_or(5) < 3;
}

}  // namespace softkin::calibration
