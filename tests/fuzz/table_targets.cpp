#include <softkin/io/table/commands.hpp>
#include <softkin/io/table/coupled_curves_file.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/marker_path.hpp>
#include <softkin/io/table/measurements.hpp>
#include <softkin/io/table/relaxation_runs.hpp>
#include <softkin/io/table/settings.hpp>

#include "fuzz/targets.hpp"

namespace softkin::fuzz {

namespace {

void run_csv(const Input& input) {
  const CsvTable table = read_csv(input.file("table.csv"));
  require(!table.rows.empty() && table.lines.size() == table.rows.size(), "a table without rows");
  for (const auto& row : table.rows) {
    require(row.size() == table.columns.size(), "a row of another length");
    for (const double cell : row) require_finite(cell, "a cell is not finite");
  }
}

void check(const Model& model, const Actuation& actuation) {
  require(actuation.size() == std::ssize(model.actuators), "other actuators");
  for (Index a = 0; a < actuation.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    require(actuation[a] >= actuator.low && actuation[a] <= actuator.high, "a command outside its range");
  }
}

template <const Model& (*robot)()>
void run_path(const Input& input) {
  const Model& model = robot();
  const std::string file = input.file("path.csv").string();
  for (const ActuationStep& step : read_actuation_path(model, file, Settings(model.actuators.size()))) {
    check(model, step.actuation);
    if (step.time) require_finite(*step.time, "a time is not finite");
  }
}

/// Commands and, as second part, a report with their pressures.
void run_commands(const Input& input) {
  const std::string file = input.file("commands.csv").string();
  const std::string report = input.parts() > 1 ? input.file("report.json", 1).string() : "";
  const Commands commands = read_commands(finger(), file, report);
  require(!commands.rows.empty(), "no command");
  for (const CommandRow& row : commands.rows) {
    check(finger(), row.actuation);
    require(row.pressures_kpa.allFinite(), "a pressure is not finite");
  }
}

Model squeezing_chambers() {
  Model model;
  for (const char* name : {"air", "tail"}) {
    Actuator actuator;
    actuator.name = name;
    actuator.drive = ChamberDrive{};
    model.actuators.push_back(actuator);
  }
  return model;
}

void run_coupled(const Input& input) {
  static const Model model = squeezing_chambers();
  const CoupledCurves curves = read_coupled_curves(model, input.file("coupled.csv"));
  require(curves.pressures_kPa.size() == curves.chambers.size(), "a chamber without pressures");
  std::size_t nodes = 1;
  for (const std::vector<double>& axis : curves.pressures_kPa) nodes *= axis.size();
  require(curves.ratios.size() == nodes, "a grid with holes");
  for (const Eigen::VectorXd& found : curves.pressures_for(curves.ratios.front()))
    require(found.allFinite(), "a pressure is not finite");
}

void run_marker_path(const Input& input) {
  const MarkerPath path = read_marker_path(input.file("path.csv"), finger(), input.part(1));
  require(!path.waypoints.empty() && path.axes.size() == path.markers.size(), "a path without waypoints");
  for (const Waypoint& waypoint : path.waypoints) {
    require(waypoint.targets.size() == path.markers.size(), "a waypoint of other markers");
    for (const Vec3& target : waypoint.targets) require(target.allFinite(), "a target is not finite");
  }
  (void)doubts_about(finger(), path);
}

void run_track(const Input& input) {
  const Track track = read_track(input.file("track.csv"), input.part(1), input.part(2));
  require(track.parameter.empty() || track.parameter.size() == track.points.size(), "a track of two lengths");
  for (const Vec3& point : track.points) require(point.allFinite(), "a point is not finite");
  for (std::size_t i = 1; i < track.parameter.size(); ++i)
    require(track.parameter[i - 1] < track.parameter[i], "a parameter that does not ascend");
}

void run_stretched(const Input& input) {
  for (const StretchedSpecimen& each : read_stretched_specimens(input.file("specimens.csv"))) {
    require(0 < each.interface_mm && each.interface_mm < each.length_mm, "an interface outside its bar");
    require(0 < each.interface_moved_mm && each.interface_moved_mm < each.stretch_mm, "a move beyond the stretch");
    require_finite(each.length_mm + each.stretch_mm + each.force_n.value_or(0) + each.area_mm2.value_or(0),
                   "a length is not finite");
  }
}

void run_twisted(const Input& input) {
  for (const TwistedSpecimen& each : read_twisted_specimens(input.file("specimens.csv")))
    require(each.twist_deg > 0 && each.twist_deg <= 180, "a twist out of range");
}

void run_tensile(const Input& input) {
  const TensileCurve curve = read_tensile_curve(input.file("test.csv"));
  require(curve.strain.size() == curve.stress.size() && curve.strain.size() >= 5, "too few points");
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    require_finite(curve.stress[i], "a stress is not finite");
    require(curve.strain[i] >= 0 && (i == 0 || curve.strain[i - 1] < curve.strain[i]), "strains do not ascend");
  }
}

void run_syringe(const Input& input) {
  for (const auto& scale : {std::optional<PressureScale>(), std::optional(PressureScale::gauge)}) {
    try {
      for (const SyringeRun& run : read_syringe_runs(input.file("test.csv"), scale))
        for (const SyringeRow& row : run.rows)
          require_finite(row.pressure_kPa + row.syringe_mm3, "a measurement is not finite");
    } catch (const InvalidInput&) {  // a column without a scale needs one, another contradicts it
    }
  }
}

void run_voltage(const Input& input) {
  for (const VoltageRun& run : read_voltage_runs(input.file("test.csv")))
    for (const VoltageRow& row : run.rows)
      require(
          std::isfinite(row.voltage_kV) && row.voltage_kV >= 0 && std::isfinite(row.area_ratio) && row.area_ratio > 0,
          "a measurement out of range");
}

void run_relaxation(const Input& input) {
  for (const StripSize& size : {StripSize{}, StripSize{50.0, 20.0}}) {
    try {
      for (const RelaxationRun& run : read_relaxation_runs(input.file("test.csv"), false, size))
        for (std::size_t i = 0; i < run.time_s.size(); ++i) {
          require(i == 0 || run.time_s[i - 1] < run.time_s[i], "times do not ascend");
          require(std::isfinite(run.stress_MPa[i]) && run.stretch[i] > 0 && run.stretch[i] <= 16,
                  "a measurement out of range");
        }
    } catch (const InvalidInput&) {  // a length or a force needs the specimen's size
    }
  }
}

/// Each line a setting, alone and together with those before it; and as a volume.
void run_settings(const Input& input) {
  for (const Model& model : {finger(), sheet()}) {
    std::vector<std::string> settings;
    const std::string text = input.part(0);
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      settings.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    try {
      check(model, with_settings(model.rest_actuation(), read_settings(model, "--set", settings)));
      (void)curve_remarks(model, settings);
    } catch (const InvalidInput&) {  // perhaps of the other robot
    }
  }
  require_finite(read_volume("--tube-volume", input.part(0)), "a volume is not finite");
}

}  // namespace

std::vector<Target> table_targets() {
  return {{"csv", "tables.dict", run_csv},
          {"path", "tables.dict", run_path<finger>},
          {"voltage_path", "tables.dict", run_path<sheet>},
          {"commands", "tables.dict", run_commands},
          {"coupled", "tables.dict", run_coupled},
          {"marker_path", "tables.dict", run_marker_path},
          {"track", "tables.dict", run_track},
          {"stretched", "tables.dict", run_stretched},
          {"twisted", "tables.dict", run_twisted},
          {"tensile", "tables.dict", run_tensile},
          {"syringe", "tables.dict", run_syringe},
          {"voltage", "tables.dict", run_voltage},
          {"relaxation", "tables.dict", run_relaxation},
          {"settings", "tables.dict", run_settings}};
}

}  // namespace softkin::fuzz
