#pragma once

#include <cstdint>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace softkin::view {

// The messages between server and page, as text and bytes, independent of the network.

/// A message is no longer than this [bytes].
inline constexpr std::size_t longest_message = 4096;
/// The same where so many readings may be in it.
constexpr std::size_t longest_message_of(std::size_t readings) {
  constexpr std::size_t digits = 26;  // of a number, with its comma
  return longest_message + digits * readings;
}

/// Number of a request, given by its sender: 1 to 2^53. 0: of no request.
using RequestId = std::uint64_t;

struct Hello {
  std::string secret;
};
/// Forward kinematics.
struct CommandRequest {
  RequestId id = 0;
  Actuation commands;  // m, inside the ranges
};
/// Inverse kinematics.
struct TargetRequest {
  RequestId id = 0;
  Index marker = 0;
  Vec3 at = Vec3::Zero();  // [mm]
};
/// Readings to estimate from.
struct ReadingsRequest {
  RequestId id = 0;
  Actuation commands;              // m, inside the ranges; those that are estimated do not count
  Eigen::VectorXd values;          // of the columns; NaN: not read
  std::optional<double> time_s{};  // when it was read; none: now
};
struct Take {};
struct Release {};
using ClientMessage = std::variant<Hello, CommandRequest, TargetRequest, ReadingsRequest, Take, Release>;

/// Returns the number of a request; none for other messages.
[[nodiscard]] std::optional<RequestId> id_of(const ClientMessage& message);

/// A reading is no larger than this, in its unit: up to here the squares of residuals can be summed.
inline constexpr double largest_reading = 1e9;

/// A refused message: why, in a sentence, and the number of the request where it has one.
class Refusal : public InvalidInput {
 public:
  explicit Refusal(const std::string& why, std::optional<RequestId> id = {}) : InvalidInput(why), id_(id) {}
  [[nodiscard]] std::optional<RequestId> id() const { return id_; }

 private:
  std::optional<RequestId> id_;
};

/// Returns the largest distance of a target in each coordinate [mm]: a hundred diagonals of the robot from its place at
/// rest.
[[nodiscard]] double farthest_target_mm(const Model& model);

/// Reads a page's message, JSON; unknown keys are ignored.
///
/// readings  number of columns that may be read; 0: nothing is estimated
/// returns   with as many commands as there are actuators, inside their ranges; with an existing marker and a place
///           within farthest_target_mm(); with as many readings as there are columns, NaN or up to largest_reading.
///           Where something is estimated, neither a command nor a target alone
/// throws    Refusal, and nothing else, on any other text
[[nodiscard]] ClientMessage read_client_message(std::string_view text, const Model& model, std::size_t readings = 0);
/// Throws Refusal naming the actuator where a command is outside its range.
void check_command(const Actuator& actuator, double value, std::optional<RequestId> id = {});

/// How a search for a target ended.
struct TargetAnswer {
  Index marker = 0;
  Vec3 at = Vec3::Zero();  // requested [mm]
  double error_mm = 0;     // of the shape that is shown
  bool reached = false;
  std::string why;  // not reached: why; else empty
};

/// A shape as all who watch get it.
struct LiveShape {
  RequestId id = 0;  // that it answers; 0: none
  std::string status, remark;
  Actuation commands;                             // m, of the shape
  std::vector<std::optional<double>> loads;       // m: tension [N] or gauge pressure [kPa]; none: it has none
  std::vector<std::optional<double>> measures{};  // m: over that at rest [-]; none where a page shows none
  std::vector<Vec3> markers;                      // [mm]
  int iterations = 0;
  double seconds = 0;
  std::optional<TargetAnswer> target;
  std::vector<std::string> arrays;  // that follow the positions
  std::vector<float> numbers;       // positions, x y z by vertex [mm]; then a number per vertex of each of the arrays
  std::size_t vertices = 0;
  std::string estimate{};  // JSON of the estimate from readings; empty: there were no readings
};

/// Length of the head (uint32), the head (JSON, padded with blanks to a multiple of four), the numbers as float32; all
/// little-endian.
///
/// id  instead of the shape's
[[nodiscard]] std::string frame_bytes(const LiveShape& shape, RequestId id);

/// How a connection stands.
struct LiveState {
  std::string model;  // what the page shows, hexadecimal
  bool secret = false, control = false, free = true;
  bool streamed = false;     // readings come by the other port, and nobody else controls
  std::size_t watchers = 0;  // that said hello, without who has control
};
[[nodiscard]] std::string state_text(const LiveState& state);
[[nodiscard]] std::string refused_text(const Refusal& refusal);
/// map: as runs::PageDocument writes it
[[nodiscard]] std::string map_text(std::string_view map);

/// Are both the same? Takes as long wherever they differ.
[[nodiscard]] bool same_secret(std::string_view given, std::string_view secret);

}  // namespace softkin::view
