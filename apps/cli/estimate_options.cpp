#include "estimate_options.hpp"

namespace softkin::cli {

namespace {

/// In the order of Reading.
constexpr const char* deviation_options[][2] = {{"--deviation", "MM"},          {"--deviation-pressure", "KPA"},
                                                {"--deviation-tension", "N"},   {"--deviation-length", "MM"},
                                                {"--deviation-volume", "MM^3"}, {"--deviation-force", "N"},
                                                {"--deviation-angle", "DEG"},   {"--deviation-direction", "D"}};

}  // namespace

std::vector<EstimatedUnknown> EstimateOptions::requested_unknowns() const {
  std::vector<EstimatedUnknown> parsed;
  for (const std::string& text : unknowns) parsed.push_back(parse_unknown("--unknown", text));
  return parsed;
}

std::array<double, readings> EstimateOptions::requested_deviations() const {
  std::array<double, readings> requested{};
  for (std::size_t k = 0; k < readings; ++k) requested[k] = deviations[k].value_or(0);
  return requested;
}

EstimatorOptions EstimateOptions::how(const StaticsOptions& statics) const {
  EstimatorOptions how;
  how.statics = statics;
  how.fade_s = fade_s;
  how.leave_out = !keep_all;
  return how;
}

std::array<std::string, readings> deviation_names() {
  std::array<std::string, readings> names;
  for (std::size_t k = 0; k < readings; ++k) names[k] = deviation_options[k][0];
  return names;
}

CLI::Option* add_unknowns(CLI::App& command, EstimateOptions& options) {
  return add_repeated(command, "--unknown", options.unknowns, "NAME",
                      "Unknown to estimate: a force, wrench or pressure with a `range`, or\nNAME:place, where on its "
                      "region a force acts, too; a command that\nwas not measured; materials.REGION.stiffness. "
                      "With\n=MEAN+-DEVIATION: known before (default: half of its range)");
}

void add_deviations(CLI::App& command, std::array<std::optional<double>, readings>& deviations,
                    const std::string& unsaid) {
  for (std::size_t k = 0; k < readings; ++k) {
    const auto kind = static_cast<Reading>(k);
    add_value(command, deviation_options[k][0], deviations[k], deviation_options[k][1],
              std::string("Standard deviation of ") + (kind == Reading::angle ? "an " : "a ") + reading_names[k] +
                  " that was read" + unsaid +
                  (kind == Reading::direction ? "; of each\ncomponent: 0.017 for a degree" : ""),
              positive("a number > 0" + in_unit(kind)));
  }
}

void add_fade(CLI::App& command, EstimateOptions& options, const std::string& then) {
  add_value(command, "--fade", options.fade_s, "S", "Time in which the forces may become any others: " + then,
            positive_time());
  command.add_flag("--keep-all", options.keep_all, "Leave no reading out that contradicts the others");
}

}  // namespace softkin::cli
