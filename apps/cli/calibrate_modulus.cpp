#include "calibrate_modulus.hpp"

#include <algorithm>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/model.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int compared = 8;  // ratios

Index index_of(const RobotSpec& spec, const std::string& name) {
  for (std::size_t a = 0; a < spec.actuators.size(); ++a)
    if (spec.actuators[a].name == name) return static_cast<Index>(a);
  throw InvalidInput("no actuator '" + name + "'");
}

/// The chamber's volume is controlled up to the highest ratio; the other chambers are open.
void prepare(RobotSpec& spec, std::size_t chamber, double highest) {
  spec.formulation = Formulation::physical;
  for (std::size_t a = 0; a < spec.actuators.size(); ++a) {
    ActuatorSpec& each = spec.actuators[a];
    if (each.kind != ActuatorKind::pneumatic) continue;
    each.curve.reset();
    each.branch = Branch::loading;
    const bool tested = a == chamber;
    each.control = tested ? Control::ratio : Control::load;
    each.low = tested ? 1 : 0;
    each.high = tested ? highest : 0;
    each.rest = tested ? 1 : 0;
  }
}

bool is_loaded(const RobotSpec& spec) {
  const bool weight = spec.gravity != Vec3(0, 0, 0);
  return weight || std::any_of(spec.forces.begin(), spec.forces.end(),
                               [](const ForceSpec& force) { return force.force != Vec3(0, 0, 0); });
}

/// Measured and predicted pressures of the ratios that both know.
struct Pairs {
  std::vector<double> measured, predicted;

  Pairs(const MonotoneCurve& curve, const std::vector<double>& ratios,
        const std::vector<std::optional<double>>& pressures) {
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      if (!pressures[i] || ratios[i] < curve.y().front() || ratios[i] > curve.y().back()) continue;
      measured.push_back(curve.inverse(ratios[i]));
      predicted.push_back(*pressures[i]);
    }
  }
};

std::string percent(double share) {
  return number(100 * share, 3) + " %";
}

class Report {
 public:
  explicit Report(ModulusReport& report) : report_(report) {}

  void add_branch(Branch branch, const CurveBranch& of, const std::vector<double>& ratios,
                  const std::vector<std::optional<double>>& pressures) {
    const Pairs pairs(of.ratio, ratios, pressures);
    if (pairs.measured.size() < 2) return;
    const calibration::ModulusCheck check = calibration::check_modulus(pairs.measured, pairs.predicted);
    factors_.push_back(check.factor);
    report_.text += std::string(branch_name(branch)) + ": measured = " + number(check.factor, 4) +
                    " x predicted; they differ by " + percent(check.misfit_before) + " rms, with the factor by " +
                    percent(check.misfit_after) + "\n";
    report_.json[branch_name(branch)] = {
        {"factor", check.factor}, {"misfit_before", check.misfit_before}, {"misfit_after", check.misfit_after}};
  }

  /// What to write into the scene: the loading branch is what a robot under slow inflation follows.
  void suggest(const RobotSpec& spec) {
    if (factors_.empty()) return;
    for (const MaterialSpec& material : spec.materials)
      if (material.elastic && material.elastic->youngs_modulus)
        report_.text += "suggestion: material '" + material.region + "': youngs_modulus " +
                        number(*material.elastic->youngs_modulus) + " -> " +
                        number(factors_.front() * *material.elastic->youngs_modulus, 4) + " MPa (loading)\n";
      else if (material.elastic)
        report_.text += "suggestion: material '" + material.region + "': its moduli times " +
                        number(factors_.front(), 4) + " (loading)\n";
    if (is_loaded(spec))
      report_.text +=
          "note: weight and forces act too, which do not grow with the moduli: repeat this with the new ones\n";
  }

 private:
  ModulusReport& report_;
  std::vector<double> factors_;
};

std::string table_of(const ActuatorCurve& curve, const std::vector<double>& ratios,
                     const std::vector<std::optional<double>>& pressures, Json& json) {
  std::vector<std::vector<std::string>> rows{{"volume ratio [-]", "loading [kPa]"}};
  if (curve.unloading) rows[0].emplace_back("unloading [kPa]");
  rows[0].emplace_back("predicted [kPa]");
  json["ratio"] = ratios;
  json["predicted_kPa"] = Json::array();
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const auto cell = [&](const MonotoneCurve& branch) {
      return ratios[i] >= branch.y().front() && ratios[i] <= branch.y().back() ? decimal(branch.inverse(ratios[i]), 2)
                                                                               : "-";
    };
    rows.push_back({number(ratios[i], 5), cell(curve.loading.ratio)});
    if (curve.unloading) rows.back().push_back(cell(curve.unloading->ratio));
    rows.back().push_back(pressures[i] ? decimal(*pressures[i], 2) : "no equilibrium");
    json["predicted_kPa"].push_back(pressures[i] ? Json(*pressures[i]) : Json());
  }
  return joined(aligned(rows, std::string(rows.front().size(), 'r')), "");
}

}  // namespace

ModulusReport compare_with_physics(RobotSpec spec, const std::string& actuator, const ActuatorCurve& curve,
                                   int threads) {
  const double low = std::max(1.0, curve.loading.ratio.y().front()), high = curve.loading.ratio.y().back();
  if (!(high > 1)) throw InvalidInput("--predict compares ratios above 1, and the loading branch has none");
  const Index chamber = index_of(spec, actuator);
  const std::string scene = spec.name;
  prepare(spec, static_cast<std::size_t>(chamber), high);
  const Model model = compile(spec);
  std::vector<double> ratios;
  for (int i = 1; i <= compared; ++i) ratios.push_back(i == compared ? high : low + (high - low) * i / compared);
  const auto pressures =
      calibration::predicted_pressures(model, chamber, ratios, threads, [](const Progress&) { return !interrupted(); });
  ModulusReport report;
  report.json = Json::object();
  report.text =
      "gauge pressures of the physical formulation of " + scene + ", " + actuator + " inflated, other chambers open:\n";
  report.text += table_of(curve, ratios, pressures, report.json);
  report.complete =
      std::all_of(pressures.begin(), pressures.end(), [](const auto& pressure) { return pressure.has_value(); });
  Report words(report);
  words.add_branch(Branch::loading, curve.loading, ratios, pressures);
  if (curve.unloading) words.add_branch(Branch::unloading, *curve.unloading, ratios, pressures);
  words.suggest(spec);
  return report;
}

}  // namespace softkin::cli
