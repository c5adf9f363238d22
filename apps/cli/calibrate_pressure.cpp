#include "calibrate_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/actuator_tests.hpp>

#include "calibrate_curve.hpp"
#include "calibrate_modulus.hpp"
#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

constexpr double mm3_per_ml = 1000;
constexpr double rest_tolerance = 0.005;  // of the atmosphere, beyond which a sensor's rest is remarked on

/// Scene and chamber of the options.
class Robot {
 public:
  Robot(const PressureOptions& options, std::vector<fs::path>& inputs) {
    if (options.scene.empty()) return;
    SolveOptions robot;
    robot.scene = options.scene;
    inputs.emplace_back(options.scene);
    spec_ = asked_spec(robot, inputs);
    chamber_ = chamber_of(options.actuator);
    const Model model = compile(*spec_);
    volume_mm3_ = model.actuators[chamber_].rest_measure;
  }

  [[nodiscard]] const std::optional<RobotSpec>& spec() const { return spec_; }
  [[nodiscard]] const std::string& actuator() const { return spec_->actuators[chamber_].name; }
  [[nodiscard]] double volume_mm3() const { return volume_mm3_; }

 private:
  [[nodiscard]] std::size_t chamber_of(const std::string& asked) const {
    std::vector<std::string> names;
    std::size_t chamber = 0;
    for (std::size_t a = 0; a < spec_->actuators.size(); ++a) {
      if (spec_->actuators[a].kind != ActuatorKind::pneumatic) continue;
      names.push_back(spec_->actuators[a].name);
      if (names.back() == asked || asked.empty()) chamber = a;
    }
    if (names.empty()) throw InvalidInput({spec_->name}, "the scene has no pneumatic actuator");
    if (asked.empty() && names.size() > 1)
      throw InvalidInput({spec_->name},
                         "the scene has several pneumatic actuators: say by --actuator which one was "
                         "tested" +
                             suggest_name("", names));
    if (!asked.empty() && std::find(names.begin(), names.end(), asked) == names.end())
      throw InvalidInput("--actuator " + excerpt(asked) + ": no such pneumatic actuator" + suggest_name(asked, names));
    return chamber;
  }

  std::optional<RobotSpec> spec_;
  std::size_t chamber_ = 0;
  double volume_mm3_ = 0;
};

class PressureRun {
 public:
  explicit PressureRun(const PressureOptions& options)
      : options_(options), inputs_(options.tests.begin(), options.tests.end()), robot_(options, inputs_) {
    check_outputs(options.outputs(), inputs_);
    read_setup();
    read_runs();
    samples_ = calibration::chamber_ratios(setup_, runs_);
    fit();
  }

  int run() {
    const OutputFolders folders(options_.outputs());
    ModulusReport physics;
    if (options_.predict) {
      ProgressLine line;
      line.show(-1, "solving the physical formulation");
      catch_interrupt();
      physics = compare_with_physics(*robot_.spec(), robot_.actuator(), fitted_->curve, options_.threads);
    }
    write();
    if (options_.json) {
      Json json = this->json();
      if (options_.predict) json["physical"] = physics.json;
      print(json);
    } else {
      print(text() + (options_.predict ? physics.text : "") + files());
    }
    if (physics.complete) return done;
    std::fprintf(stderr, "softkin: the physical formulation has no equilibrium at some of the ratios\n");
    return not_converged;
  }

 private:
  void say(const std::string& line) { head_ += line + "\n"; }

  void read_setup() {
    setup_.atmosphere_kPa = options_.atmosphere_kPa.value_or(setup_.atmosphere_kPa);
    setup_.syringe_mm3 = volume_of("--syringe-volume", options_.syringe);
    setup_.tube_mm3 = options_.tube.empty() ? 0 : volume_of("--tube-volume", options_.tube);
    const bool given = !options_.chamber.empty();
    if (!given && !robot_.spec())
      throw InvalidInput(
          "the chamber's volume at rest is not known: give --scene SCENE, whose mesh has it, or "
          "--chamber-volume");
    setup_.chamber_mm3 = given ? volume_of("--chamber-volume", options_.chamber) : robot_.volume_mm3();
    say("chamber " + number(setup_.chamber_mm3) + " mm^3 at rest" +
        (given ? "" : " (actuator " + robot_.actuator() + " of " + options_.scene + ")") + ", tube " +
        number(setup_.tube_mm3) + " mm^3" + (options_.tube.empty() ? " (default)" : "") + ", syringe " +
        number(setup_.syringe_mm3) + " mm^3");
    say("atmosphere " + number(setup_.atmosphere_kPa) + " kPa" +
        (options_.atmosphere_kPa ? "" : " (default, as in the paper's Eq. (19))"));
  }

  void read_runs() {
    std::optional<PressureScale> scale;
    if (!options_.scale.empty()) scale = options_.scale == "absolute" ? PressureScale::absolute : PressureScale::gauge;
    for (const std::string& file : options_.tests) {
      const std::vector<SyringeRun> runs = read_syringe_runs(file, scale);
      const bool absolute = runs.front().scale == PressureScale::absolute;
      std::size_t rows = 0;
      for (const SyringeRun& run : runs) rows += run.rows.size();
      say(file + ": " + counted(runs.size(), "run") + ", " + counted(rows, "row") + ", " +
          (absolute ? "absolute" : "gauge") + " pressures");
      runs_.insert(runs_.end(), runs.begin(), runs.end());
    }
  }

  void fit() {
    std::vector<calibration::CurveSample> samples;
    for (const calibration::SyringeSample& each : samples_) samples.push_back(each.sample);
    calibration::CurveFit fit = calibration::fit_curve(samples);
    const std::string name = options_.output.empty() ? "of the test" : options_.output;
    fitted_ = FittedCurve{
        {name, CurveInput::pressure, setup_.atmosphere_kPa, "", std::move(fit.loading), std::move(fit.unloading)},
        fit.loading_quality,
        fit.unloading_quality,
        std::move(samples)};
    for (const SyringeRun& run : runs_) remark_on_rest(run);
  }

  /// By Eq. (19) the ratio is 1 at rest only where the sensor then reads the atmosphere.
  void remark_on_rest(const SyringeRun& run) {
    const std::optional<double> rest = calibration::rest_pressure(setup_, run);
    if (rest && std::abs(*rest - setup_.atmosphere_kPa) > rest_tolerance * setup_.atmosphere_kPa)
      say("note: " + run.file + ", " + run.name + ": the sensor reads " + number(*rest, 5) +
          " kPa absolute with the syringe at rest, and the atmosphere counts as " + number(setup_.atmosphere_kPa, 5) +
          " kPa: if the sensor is right, give --atmosphere " + number(*rest, 5));
  }

  [[nodiscard]] std::string text() const {
    return head_ + quality_text(*fitted_) + "\n" + curve_table(*fitted_) + "\n";
  }

  [[nodiscard]] std::string files() const {
    std::string text;
    if (!options_.output.empty())
      text += "curve: " + options_.output + " (name it in the scene: curve: FILE; then --set " +
              (robot_.spec() ? robot_.actuator() : "air") + "=" +
              number(0.5 * fitted_->curve.loading.ratio.x().back(), 2) + "kPa)\n";
    if (!options_.table.empty()) text += "rows: " + options_.table + "\n";
    if (!options_.plot.empty()) text += "plot: " + options_.plot + "\n";
    return text;
  }

  [[nodiscard]] Json json() const {
    Json json{
        {"softkin", SOFTKIN_VERSION},        {"tests", options_.tests},     {"atmosphere_kPa", setup_.atmosphere_kPa},
        {"chamber_mm3", setup_.chamber_mm3}, {"tube_mm3", setup_.tube_mm3}, {"syringe_mm3", setup_.syringe_mm3}};
    json.update(curve_json(*fitted_));
    return json;
  }

  [[nodiscard]] std::string rows_csv() const {
    std::string text = "p_gauge_kpa,p_abs_kpa,ratio,unloading,sweep,run,line\n";
    for (const calibration::SyringeSample& each : samples_)
      text += number(each.sample.input, 10) + "," + number(each.sample.input + setup_.atmosphere_kPa, 10) + "," +
              number(each.sample.ratio, 10) + "," + (each.sample.branch == Branch::unloading ? "1" : "0") + "," +
              std::to_string(each.sample.repeat) + "," + std::to_string(each.run) + "," + std::to_string(each.line) +
              "\n";
    return text;
  }

  void write() const {
    if (!options_.output.empty())
      write_file(options_.output,
                 actuator_curve_text(fitted_->curve, "made by softkin calibrate pressure from:\n" + head_));
    if (!options_.table.empty()) write_file(options_.table, rows_csv());
    if (!options_.plot.empty()) write_svg(options_.plot, curve_plot(*fitted_, "volume ratio by Eq. (19)"));
  }

  const PressureOptions& options_;
  std::vector<fs::path> inputs_;
  Robot robot_;
  calibration::SyringeSetup setup_;
  std::vector<SyringeRun> runs_;
  std::vector<calibration::SyringeSample> samples_;
  std::optional<FittedCurve> fitted_;
  std::string head_;
};

}  // namespace

std::vector<Output> PressureOptions::outputs() const {
  std::vector<Output> outputs;
  for (const auto& [option, file] : {std::pair{"--output", output}, {"--table", table}, {"--plot", plot}})
    if (!file.empty()) outputs.push_back({option, file, 0});
  return outputs;
}

double volume_of(const char* option, const std::string& text) {
  const std::string name = std::string(option) + " " + excerpt(text) + ": ";
  for (const auto& [unit, factor] :
       {std::pair{"mm3", 1.0}, {"mL", mm3_per_ml}, {"ml", mm3_per_ml}, {"cm3", mm3_per_ml}}) {
    if (!text.ends_with(unit)) continue;
    std::string digits = text.substr(0, text.size() - std::string(unit).size());
    if (digits.ends_with(' ')) digits.pop_back();
    double value = 0;
    if (parse_real(digits, value) && value >= 0) return factor * value;
  }
  throw InvalidInput(name + "must be a volume with its unit, mm3, mL or cm3, such as 12.5mL");
}

int calibrate_pressure(const PressureOptions& options) {
  return PressureRun(options).run();
}

}  // namespace softkin::cli
