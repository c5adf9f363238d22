#include <nanobind/stl/array.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <softkin/calibration/actuator_report.hpp>
#include <softkin/calibration/relaxation_report.hpp>
#include <softkin/calibration/specimen_report.hpp>
#include <softkin/calibration/tensile_report.hpp>
#include <softkin/calibration/test_log.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/measurements.hpp>
#include <softkin/io/table/tensile_file.hpp>
#include <softkin/model/names.hpp>

#include "bindings.hpp"
#include "robot.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

using calibration::FittedCurve;
using Files = std::vector<std::string>;

/// A calibration with its report.
struct Calibration {
  std::string text, json, fragment;  // fragment: the materials of a scene; empty: a simulation is not converged
  std::string failure;               // why; empty: none
  Table residuals;
  Plot plot;
  std::string doubt{};  // what is probably not meant; empty: nothing
};

/// An actuator's curve with its report.
struct CurveCalibration {
  FittedCurve fitted;
  std::string text, json, file, title;
  std::optional<Table> rows{};                                 // of syringe tests
  std::optional<calibration::PressureComparison> predicted{};  // where it was requested
};

using BranchOut = std::tuple<std::vector<double>, std::vector<double>, std::vector<double>>;

BranchOut branch_out(const CurveBranch& branch) {
  return {branch.ratio.x(), branch.ratio.y(), branch.spread};
}

CurveCalibration reported(FittedCurve fitted, const std::string& head, std::string json, const std::string& made_by,
                          const std::string& title, bool measured) {
  std::string text = head + (measured ? calibration::quality_text(fitted) + "\n" : "\n");
  text += calibration::curve_text(fitted.curve);
  std::string file = actuator_curve_text(fitted.curve, "made by softkin calibrate " + made_by + " from:\n" + head);
  return {std::move(fitted), std::move(text), std::move(json), std::move(file), title};
}

/// Syringe tests as the Python layer has them.
struct SyringeTests {
  Files files;
  std::string scale, actuator;        // empty: not given
  RobotPtr robot;                     // null: not given
  std::optional<double> chamber_mm3;  // none: of the robot's mesh
  double tube_mm3 = 0, syringe_mm3 = 0, atmosphere_kPa = 100;
  bool predict = false;
  int threads = 0;
};

CurveCalibration pressure(const SyringeTests& given) {
  calibration::SyringeTask task{
      given.files, {}, {given.chamber_mm3.value_or(0), given.tube_mm3, given.syringe_mm3, given.atmosphere_kPa}};
  if (!given.scale.empty()) task.scale = given.scale == "absolute" ? PressureScale::absolute : PressureScale::gauge;
  std::optional<RobotSpec> spec;
  std::size_t chamber = 0;
  if (given.robot) {
    Source source = given.robot->source();
    spec = source.spec(false);
    chamber = calibration::tested_chamber(*spec, given.actuator);
    if (!given.chamber_mm3) task.setup.chamber_mm3 = given.robot->model().actuators[chamber].rest_measure;
  }
  return watched(std::nullopt, [&](const ProgressCallback& progress) {
    calibration::SyringeResults results = calibration::evaluate(task, "of the test");
    std::optional<calibration::PressureComparison> physics;
    if (given.predict)
      physics = calibration::compare_with_physics(*spec, chamber, results.fitted.curve, given.threads, progress);
    const calibration::PressureComparison* comparison = physics ? &*physics : nullptr;
    std::string json = calibration::pressure_json(given.files, task.setup, results.fitted, comparison);
    Table rows = calibration::syringe_table(task.setup, results.samples);
    CurveCalibration curve = reported(std::move(results.fitted), results.head, std::move(json), "pressure",
                                      "volume ratio by Eq. (19)", true);
    curve.rows = std::move(rows);
    if (physics) curve.text += "\n" + calibration::comparison_text(*physics, curve.fitted.curve, *spec);
    curve.predicted = std::move(physics);
    return curve;
  });
}

/// Ratios [-], pressures [kPa], and by branch the factor and the misfits before and after it [-].
using Prediction = std::tuple<std::vector<double>, std::vector<std::optional<double>>,
                              std::map<std::string, std::tuple<double, double, double>>>;

std::optional<Prediction> prediction_of(const CurveCalibration& curve) {
  if (!curve.predicted) return std::nullopt;
  Prediction all{curve.predicted->ratios, curve.predicted->predicted, {}};
  for (const auto& [branch, check] : curve.predicted->branches)
    std::get<2>(all)[branch_name(branch)] = {check.factor, check.misfit_before, check.misfit_after};
  return all;
}

CurveCalibration dea(const Files& tests, const std::string& law, const std::string& loading,
                     std::optional<double> shear_modulus_MPa, std::optional<double> permittivity,
                     std::optional<double> thickness_mm, std::optional<double> prestretch,
                     std::optional<double> prestretch_across, std::optional<double> stretch_limit,
                     std::optional<double> breakdown_kV_mm) {
  const calibration::DeaTask task{tests,         law,
                                  loading,       permittivity,
                                  thickness_mm,  shear_modulus_MPa,
                                  prestretch,    prestretch_across,
                                  stretch_limit, breakdown_kV_mm};
  auto [fitted, head, computed] = calibration::evaluate(task, "of the elastomer");
  std::string json = calibration::dea_json(tests, fitted, computed ? &*computed : nullptr);
  return reported(std::move(fitted), head, std::move(json), "dea", "area ratio by voltage", !computed);
}

Calibration tensile(const std::string& file, double poisson_ratio, double tolerance_percent, double max_strain,
                    const std::string& law, const std::string& region, bool stable,
                    const std::optional<TensileLayout>& layout) {
  const calibration::TensileTask task{file, poisson_ratio, tolerance_percent, max_strain, law, region, stable};
  const calibration::TensileResults results =
      calibration::evaluate(task, layout ? read_tensile_file(file, *layout) : read_tensile_curve(file));
  return {tensile_text(task, results), tensile_json(task, results), tensile_fragment(task, results), "",
          residual_table(results),     tensile_plot(task, results)};
}

Calibration relaxation(const calibration::RelaxationTask& task) {
  const calibration::RelaxationResults results = calibration::evaluate(task);
  return {relaxation_text(task, results), relaxation_json(task, results), relaxation_fragment(task, results), "",
          relaxation_table(results),      relaxation_plot(task, results)};
}

/// Specimens of two materials as the Python layer has them.
struct Specimens {
  std::string file, twist_file, law, grip;
  bool physical = true, target_shape = true;
  double width_mm = 20, height_mm = 10, poisson_ratio = 0.45, stiffer_shape_ratio = 1;
  int cells = 0, threads = 0;
  std::optional<double> modulus_b_MPa;
  std::vector<double> tried;
  std::array<std::string, 2> regions{"A", "B"};
  std::string journal;  // empty: none
};

calibration::SpecimenTask task_of(const Specimens& given) {
  calibration::SpecimenTask task;
  task.file = given.file;
  task.twist_file = given.twist_file;
  task.physical = given.physical;
  task.target_shape = given.target_shape;
  task.tried = given.tried;
  task.modulus_b = given.modulus_b_MPa;
  task.regions = given.regions;
  calibration::SpecimenOptions& options = task.options;
  options.width_mm = given.width_mm;
  options.height_mm = given.height_mm;
  options.poisson_ratio = given.poisson_ratio;
  options.stiffer_shape_ratio = given.stiffer_shape_ratio;
  options.cells = given.cells;
  options.statics.threads = given.threads;
  options.grip = given.grip == "sliding" ? calibration::Grip::sliding : calibration::Grip::clamped;
  for (const Law law : {Law::corotational, Law::st_venant_kirchhoff})
    if (given.law == law_name(law)) options.law = law;
  task.set_up = calibration::set_up_lines(task, [](const std::string&) { return ""; });
  return task;
}

Calibration specimens(const Specimens& given,
                      const std::optional<nb::typed<nb::callable, nb::object(double)>>& progress) {
  calibration::SpecimenTask task = task_of(given);
  Watch watch{std::nullopt};
  std::atomic<double> fraction = 0;
  task.options.go_on = [&watch] { return watch.go_on(); };
  calibration::SpecimenResults results;
  std::string doubt;
  const auto work = [&] {
    std::vector<StretchedSpecimen> stretched = read_stretched_specimens(task.file);
    std::vector<TwistedSpecimen> twists;
    if (!task.twist_file.empty()) twists = read_twisted_specimens(task.twist_file);
    check_modulus_b(task, stretched);
    doubt = doubt_about_areas(task, stretched);
    calibration::TestLog log(given.journal, tests_set_up(task, stretched, twists), true);
    task.options.log = &log;
    results = calibration::evaluate(task, std::move(stretched), std::move(twists),
                                    [&](const std::string&, double done) { fraction = done; });
    task.options.log = nullptr;
    if (!results.interrupted) log.remove();
  };
  watch.watch(work, [&] {
    if (progress) (*progress)(fraction.load());
  });
  Calibration calibrated{specimens_text(task, results),
                         specimens_json(task, results),
                         "",
                         calibration::failure(task, results),
                         {},
                         {},
                         doubt};
  if (!calibrated.failure.empty()) return calibrated;
  calibrated.fragment = specimens_fragment(task, results);
  calibrated.residuals = residual_table(results);
  calibrated.plot = specimens_plot(task, results);
  return calibrated;
}

void bind_curve(nb::module_& module) {
  nb::class_<CurveCalibration>(module, "CurveCalibration", "An actuator's curve and how it was found.")
      .def_ro("text", &CurveCalibration::text)
      .def_ro("json", &CurveCalibration::json)
      .def_ro("file", &CurveCalibration::file)
      .def_ro("rows", &CurveCalibration::rows)
      .def_prop_ro("prediction", &prediction_of)
      .def_prop_ro("loading", [](const CurveCalibration& c) { return branch_out(c.fitted.curve.loading); })
      .def_prop_ro("unloading",
                   [](const CurveCalibration& c) {
                     const auto& branch = c.fitted.curve.unloading;
                     return branch ? std::optional(branch_out(*branch)) : std::nullopt;
                   })
      .def_prop_ro("samples",
                   [](const CurveCalibration& c) {
                     std::vector<std::tuple<double, double, bool, std::size_t>> all;
                     for (const calibration::CurveSample& s : c.fitted.samples)
                       all.emplace_back(s.input, s.ratio, s.branch == Branch::unloading, s.repeat);
                     return all;
                   })
      .def(
          "ratio",
          [](const CurveCalibration& c, double input, bool unloading) {
            return c.fitted.curve.ratio(input, unloading ? Branch::unloading : Branch::loading);
          },
          nb::arg("input"), nb::arg("unloading"))
      .def(
          "save_plot",
          [](const CurveCalibration& c, const std::string& path) {
            write_svg(path, calibration::curve_plot(c.fitted, c.title));
          },
          nb::arg("path"));
}

}  // namespace

void bind_calibrate(nb::module_& module) {
  bind_curve(module);
  nb::class_<Calibration>(module, "Calibration", "Materials and how they were found.")
      .def_ro("text", &Calibration::text)
      .def_ro("json", &Calibration::json)
      .def_ro("fragment", &Calibration::fragment)
      .def_ro("failure", &Calibration::failure)
      .def_ro("doubt", &Calibration::doubt)
      .def_ro("residuals", &Calibration::residuals)
      .def(
          "save_plot", [](const Calibration& c, const std::string& path) { write_svg(path, c.plot); }, nb::arg("path"));
  nb::class_<Specimens>(module, "Specimens", "Stretched bars of two materials and how they are simulated.")
      .def(nb::init<>())
      .def_rw("file", &Specimens::file)
      .def_rw("twist_file", &Specimens::twist_file)
      .def_rw("law", &Specimens::law)
      .def_rw("grip", &Specimens::grip)
      .def_rw("physical", &Specimens::physical)
      .def_rw("target_shape", &Specimens::target_shape)
      .def_rw("width_mm", &Specimens::width_mm)
      .def_rw("height_mm", &Specimens::height_mm)
      .def_rw("poisson_ratio", &Specimens::poisson_ratio)
      .def_rw("stiffer_shape_ratio", &Specimens::stiffer_shape_ratio)
      .def_rw("cells", &Specimens::cells)
      .def_rw("threads", &Specimens::threads)
      .def_rw("modulus_b_MPa", &Specimens::modulus_b_MPa)
      .def_rw("tried", &Specimens::tried)
      .def_rw("regions", &Specimens::regions)
      .def_rw("journal", &Specimens::journal);
  module.def("calibrate_specimens", &specimens, nb::arg("specimens"), nb::arg("progress").none());
  nb::class_<TensileLayout>(module, "TensileLayout", "How the file of a testing machine is read.")
      .def(nb::init<>())
      .def_rw("strain_column", &TensileLayout::strain_column)
      .def_rw("stress_column", &TensileLayout::stress_column)
      .def_rw("strain_unit", &TensileLayout::strain_unit)
      .def_rw("stress_unit", &TensileLayout::stress_unit)
      .def_rw("true_strain", &TensileLayout::true_strain)
      .def_rw("true_stress", &TensileLayout::true_stress)
      .def_rw("length_mm", &TensileLayout::length_mm)
      .def_rw("area_mm2", &TensileLayout::area_mm2)
      .def("set_branch", [](TensileLayout& layout, int branch) { layout.branch = static_cast<TensileBranch>(branch); })
      .def("set_zero", [](TensileLayout& layout, int zero) { layout.zero = static_cast<TensileZero>(zero); });
  module.def("calibrate_tensile", &tensile, nb::arg("file"), nb::arg("poisson_ratio"), nb::arg("tolerance_percent"),
             nb::arg("most_strain"), nb::arg("law"), nb::arg("region"), nb::arg("stable"), nb::arg("layout").none(),
             nb::call_guard<nb::gil_scoped_release>());
  using calibration::RelaxationTask;
  nb::class_<RelaxationTask>(module, "RelaxationTask",
                             "Relaxation, creep and cyclic tests and the fit requested of them.")
      .def(nb::init<>())
      .def_rw("tests", &RelaxationTask::tests)
      .def_rw("creep", &RelaxationTask::creep)
      .def_rw("law", &RelaxationTask::law)
      .def_rw("constants", &RelaxationTask::constants)
      .def_rw("branches", &RelaxationTask::branches)
      .def_prop_rw(
          "length_mm", [](const RelaxationTask& task) { return task.size.length_mm; },
          [](RelaxationTask& task, std::optional<double> value) { task.size.length_mm = value; })
      .def_prop_rw(
          "area_mm2", [](const RelaxationTask& task) { return task.size.area_mm2; },
          [](RelaxationTask& task, std::optional<double> value) { task.size.area_mm2 = value; })
      .def_rw("poisson_ratio", &RelaxationTask::poisson_ratio)
      .def_rw("region", &RelaxationTask::region);
  module.def("calibrate_relaxation", &relaxation, nb::arg("task"), nb::call_guard<nb::gil_scoped_release>());
  nb::class_<SyringeTests>(module, "SyringeTests", "Syringe tests of a chamber.")
      .def(nb::init<>())
      .def_rw("files", &SyringeTests::files)
      .def_rw("scale", &SyringeTests::scale)
      .def_rw("actuator", &SyringeTests::actuator)
      .def_rw("robot", &SyringeTests::robot)
      .def_rw("chamber_mm3", &SyringeTests::chamber_mm3)
      .def_rw("tube_mm3", &SyringeTests::tube_mm3)
      .def_rw("syringe_mm3", &SyringeTests::syringe_mm3)
      .def_rw("atmosphere_kPa", &SyringeTests::atmosphere_kPa)
      .def_rw("predict", &SyringeTests::predict)
      .def_rw("threads", &SyringeTests::threads);
  module.def("calibrate_pressure", &pressure, nb::arg("tests"));
  module.def("calibrate_dea", &dea, nb::arg("tests"), nb::arg("law"), nb::arg("loading"),
             nb::arg("shear_modulus_MPa").none(), nb::arg("permittivity").none(), nb::arg("thickness_mm").none(),
             nb::arg("prestretch").none(), nb::arg("prestretch_across").none(), nb::arg("stretch_limit").none(),
             nb::arg("breakdown_kV_mm").none(), nb::call_guard<nb::gil_scoped_release>());
  module.def("volume_mm3", &read_volume, nb::arg("option"), nb::arg("text"));
}

}  // namespace softkin::python
