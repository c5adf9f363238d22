#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/material_tables.hpp>

#include "calibrate_results.hpp"
#include "command.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

class SpecimenRun {
 public:
  explicit SpecimenRun(const MaterialOptions& options) : options_(options) {}

  int run() {
    read();
    check_outputs(options_.outputs(), options_.inputs());
    const OutputFolders folders(options_.outputs());
    remark_on_area();
    solve();
    progress_.clear();
    const std::string failure = results_.failure(options_);
    if (failure.empty()) write();
    tell();
    if (failure.empty()) return done;
    std::fprintf(stderr, "softkin: %s%s\n", failure.c_str(), options_.outputs().empty() ? "" : "; no file was written");
    return not_converged;
  }

 private:
  void read() {
    results_.specimens = read_stretched_specimens(options_.specimens);
    if (!options_.twist.empty()) results_.twists = read_twisted_specimens(options_.twist);
    bool any_force = false;
    for (const StretchedSpecimen& s : results_.specimens) any_force = any_force || s.force_n.has_value();
    if (any_force && options_.modulus_b)
      throw InvalidInput("--modulus-b is for specimens without a force, but " + options_.specimens +
                         " has a column of it: leave out one of the two");
    if (options_.formulation == "physical" && !options_.fragment.empty() && !any_force && !options_.modulus_b)
      throw InvalidInput("--output " + options_.fragment + ": materials of the physical formulation need a modulus; " +
                         options_.specimens + " has no column force_n: add it, or give --modulus-b");
  }

  /// A force belongs to an area; that of the file and that of the simulation should be one.
  void remark_on_area() const {
    constexpr double most = 0.05;
    const double simulated = options_.specimen.width_mm * options_.specimen.height_mm;
    for (const StretchedSpecimen& s : results_.specimens)
      if (s.area_mm2 && std::abs(*s.area_mm2 / simulated - 1) > most) {
        std::fprintf(stderr,
                     "softkin: %s:%zu: note: the area is %s mm^2, but the simulated cross-section has %s; --width and "
                     "--height set it\n",
                     options_.specimens.c_str(), s.line, number(*s.area_mm2).c_str(), number(simulated).c_str());
        return;
      }
  }

  [[nodiscard]] calibration::ShareDone shown(const std::string& what) {
    return [this, what](double share) { progress_.show(share, what); };
  }

  void solve() {
    std::vector<double> logs, weights;
    for (const StretchedSpecimen& s : results_.specimens) {
      logs.push_back(std::log(calibration::elasticity_ratio(s)));
      weights.push_back(calibration::rod_sensitivity_mm(s));
    }
    results_.rod = calibration::combined_ratio(logs, weights);
    results_.rod_moduli =
        calibration::rod_moduli(results_.specimens, options_.specimen.width_mm * options_.specimen.height_mm);
    if (options_.formulation != "target-shape") fit(Formulation::physical, results_.physical, results_.physical_twists);
    if (options_.formulation == "physical") return;
    fit(Formulation::target_shape, results_.target, results_.target_twists);
    for (const double ratio : options_.tried) look_at(ratio);
  }

  void fit(Formulation formulation, std::optional<calibration::RatioFit>& found,
           std::vector<calibration::SpecimenResponse>& twisted) {
    const std::string name = formulation == Formulation::physical ? "physical" : "target-shape";
    found = calibration::fit_ratio(results_.specimens, options_.specimen, formulation, shown(name + " tensile tests"));
    if (found->estimate.specimens > 0)
      twisted = calibration::predict(results_.twists, options_.specimen, formulation, std::log(found->estimate.ratio),
                                     shown(name + " twist tests"));
  }

  void look_at(double ratio) {
    const auto predicted = [&](const auto& specimens) {
      return calibration::predict(specimens, options_.specimen, Formulation::target_shape, std::log(ratio),
                                  shown("ratios to try"));
    };
    results_.tried.push_back({ratio, predicted(results_.specimens), predicted(results_.twists)});
  }

  void write() const {
    if (!options_.fragment.empty()) write_file(options_.fragment, specimens_fragment(results_, options_));
    if (!options_.plot.empty()) write_svg(options_.plot, specimens_plot(results_, options_));
    if (!options_.residuals.empty()) write_file(options_.residuals, specimens_residuals(results_));
  }

  void tell() const {
    if (options_.json)
      print(specimens_json(results_, options_));
    else
      print(specimens_text(results_, options_));
  }

  const MaterialOptions& options_;
  SpecimenResults results_;
  ProgressLine progress_;
};

std::string status_text(Status status) {
  return status == Status::limit ? "limit" : status == Status::interrupted ? "interrupted" : "not converged";
}

}  // namespace

int calibrate_specimens(const MaterialOptions& options) {
  return SpecimenRun(options).run();
}

double off_percent(double found, double measured) {
  return 100 * (found / measured - 1);
}

std::string SpecimenResults::failure(const MaterialOptions& options) const {
  std::string failure;
  const auto look = [&](const std::string& file, std::size_t line, const std::string& what, Status status,
                        const std::string& remark) {
    if (!failure.empty() || status == Status::converged) return;
    failure = file + ":" + std::to_string(line) + ": the simulated " + what + " test has status " +
              status_text(status) + (remark.empty() ? "" : ": " + remark);
  };
  for (const auto* fit : {&physical, &target}) {
    if (!*fit) continue;
    const std::string name = fit == &physical ? "physical" : "target-shape";
    for (std::size_t i = 0; i < specimens.size(); ++i)
      look(options.specimens, specimens[i].line, name + " tensile", (*fit)->specimens[i].status,
           (*fit)->specimens[i].remark);
    const std::vector<calibration::SpecimenResponse>& twisted = fit == &physical ? physical_twists : target_twists;
    for (std::size_t i = 0; i < twisted.size(); ++i)
      look(options.twist, twists[i].line, name + " twist", twisted[i].status, twisted[i].remark);
  }
  for (const TriedRatio& each : tried) {
    for (std::size_t i = 0; i < specimens.size(); ++i)
      look(options.specimens, specimens[i].line, "--try tensile", each.stretched[i].status, each.stretched[i].remark);
    for (std::size_t i = 0; i < twists.size(); ++i)
      look(options.twist, twists[i].line, "--try twist", each.twisted[i].status, each.twisted[i].remark);
  }
  return failure;
}

}  // namespace softkin::cli
