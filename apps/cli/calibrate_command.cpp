#include "calibrate_command.hpp"

#include <softkin/io/scanner.hpp>

namespace softkin::cli {

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App& calibrate = *app.add_subcommand("calibrate", "Parameters of the model from measurements");
  calibrate.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  calibrate.callback([&calibrate] {
    if (calibrate.get_subcommands().empty())
      throw CLI::RequiredError("a subcommand of calibrate (material, pressure, dea)");
  });
  calibrate.footer("Example:\n  softkin calibrate material specimens.csv");
  add_calibrate_material(calibrate, run);
  add_calibrate_pressure(calibrate, run);
  add_calibrate_dea(calibrate, run);
}

CLI::Validator positive_number() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && value > 0) return "";
    return "must be a finite number above 0, not " + text;
  };
  return CLI::Validator(check, "");
}

std::string written_text(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string text;
  for (const auto& [what, file] : files)
    if (!file.empty()) text += what + ": " + file + "\n";
  return text;
}

}  // namespace softkin::cli
