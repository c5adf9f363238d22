#include "fk_resume.hpp"

#include <optional>

#include "fk_units.hpp"

namespace softkin::cli {

Finished take_finished(const Model& model, const FkOptions& options, const std::vector<Step>& asked, Report& report) {
  const StoredReport stored(model, options.report, options.output);
  const auto check_step = [&](const Report::Json& step, std::size_t i) {
    const std::string number_of_step = "step " + std::to_string(i);
    if (i >= asked.size())
      stored.refuse("it has " + number_of_step + ", but " + options.path + " ends before; the path has changed");
    const std::string where = options.path + ":" + std::to_string(asked[i].line);
    const Report::Json& actuation = step.at("actuation");
    if (actuation.size() != model.actuators.size()) stored.refuse(number_of_step + " has other actuators");
    for (std::size_t a = 0; a < model.actuators.size(); ++a) {
      const std::string& name = model.actuators[a].name;
      const double before = actuation.at(name).get<double>(), now = asked[i].actuation[static_cast<Index>(a)];
      if (before != now)
        stored.refuse(number_of_step + " was solved for " + name + " = " +
                      command_text(model.actuators[a], before, 12) + ", but " + where + " asks for " +
                      command_text(model.actuators[a], now, 12) + "; the path has changed");
    }
    const std::optional<double> time =
        step.contains("time_s") ? std::optional(step.at("time_s").get<double>()) : std::nullopt;
    if (time != asked[i].time)
      stored.refuse(number_of_step + " has another time than " + where + "; the path has changed");
  };
  return stored.take(report, {}, check_step, [](const Report::Json&) {});
}

}  // namespace softkin::cli
