#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <softkin/core/team.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_estimate.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/map_journal.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "robot.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

Statics statics_of(const Robot& robot, const Map* map, bool polish) {
  if (map) runs::check_robot(map->map.data(), robot.model(), map->name);
  return statics_by(robot.model(), map ? &map->map : nullptr, polish);
}

/// Callback with the numbers of equilibria and checks that were solved, the prediction error, and the current activity.
using MapTell = std::optional<nb::typed<nb::callable, nb::object(Index, Index, double, std::string)>>;

/// store: the file of the map, with its journal next to it; empty: none
/// returns  the map, and why it misses the requested accuracy; empty: it does not
std::tuple<MapPtr, std::string> make_map(const RobotPtr& robot, const MapOptions& options, const std::string& store,
                                         const MapTell& progress) {
  const Model& model = robot->model();
  (void)maps::outline_of(model);
  std::optional<runs::MapJournal> journal;
  if (!store.empty()) journal.emplace(store, model, options, true);
  Watch watch{std::nullopt};
  std::mutex mutex;
  MapProgress last;
  std::optional<MapResult> result;
  const auto work = [&] {
    try {
      result = build_map(model, options, journal ? &*journal : nullptr, [&](const MapProgress& at) {
        const std::lock_guard lock(mutex);
        last = at;
        return watch.go_on();
      });
    } catch (const InvalidInput&) {
      if (journal) journal->remove();  // no later call could continue it
      throw;
    }
  };
  watch.watch(work, [&] {
    if (!progress) return;
    std::unique_lock lock(mutex);
    const MapProgress at = last;
    lock.unlock();
    (*progress)(at.equilibria, at.checks, at.error, at.doing);
  });
  if (!result) throw InvalidInput("the making of the map was stopped");
  if (journal) {
    runs::write_map(store, result->data);
    journal->remove();
  }
  return {std::make_shared<Map>(std::move(result->data), store.empty() ? "the map" : store), result->remark};
}

MapOptions map_options(double accuracy_mm, double load_accuracy, double shape_accuracy_mm, Index most, Index checks,
                       std::uint64_t seed, const StaticsOptions& statics, int threads) {
  MapOptions options;
  options.accuracy_mm = accuracy_mm;
  options.load_accuracy = load_accuracy;
  options.shape_accuracy_mm = shape_accuracy_mm;
  options.max_equilibria = most;
  options.checks = checks;
  options.seed = seed;
  options.statics = statics;
  options.threads = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return options;
}

using SlopesOut = Array<double, nb::ndim<3>>;

/// A row per row of commands, of those outside the map zeros. What is not yet written is not touched: a system that
/// hands out pages when they are written would take longer for all of them than Ctrl-C may wait.
struct Rows {
  std::unique_ptr<double[]> outputs, slopes;
  std::vector<std::uint8_t> inside;
};

/// Hands memory over to Python.
template <class Out>
Out given_away(std::unique_ptr<double[]> values, std::initializer_list<std::size_t> sizes) {
  double* const kept = values.release();
  const nb::capsule owner(kept, [](void* memory) noexcept { delete[] static_cast<double*>(memory); });
  return Out(kept, sizes, owner);
}

class Batch {
 public:
  Batch(const KinematicMap& map, const TableIn& commands, bool sloped)
      : map_(map), commands_(commands.data()), count_(commands.shape(0)), sloped_(sloped) {
    const std::size_t outputs = count_ * static_cast<std::size_t>(map.outputs());
    rows_.outputs = std::make_unique_for_overwrite<double[]>(outputs);
    if (sloped)
      rows_.slopes = std::make_unique_for_overwrite<double[]>(outputs * static_cast<std::size_t>(map.inputs()));
    rows_.inside.resize(count_);
  }

  /// threads  0: as many as the machine has
  void solve(int threads) {
    if (count_ <= few) return solve_block(0);
    if (count_ <= block) {
      const nb::gil_scoped_release released;
      return solve_block(0);
    }
    Watch watch{std::nullopt};
    const auto blocks = static_cast<Index>((count_ + block - 1) / block);
    const auto work = [&] {
      Team team(std::min<int>(threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()), blocks));
      team.each(blocks, [&](Index number) {
        if (watch.go_on()) solve_block(number);
      });
    };
    watch.watch(work, {});
  }
  [[nodiscard]] Rows finish() { return std::move(rows_); }

 private:
  static constexpr std::size_t few = 32;      // to give the GIL away for so many may take longer than they do
  static constexpr std::size_t block = 4096;  // some milliseconds

  void solve_block(std::size_t number) {
    const auto inputs = static_cast<std::size_t>(map_.inputs()), outputs = static_cast<std::size_t>(map_.outputs());
    for (std::size_t n = number * block; n < std::min(count_, (number + 1) * block); ++n) {
      double* const values = rows_.outputs.get() + n * outputs;
      double* const slopes = sloped_ ? rows_.slopes.get() + n * inputs * outputs : nullptr;
      rows_.inside[n] = map_.evaluate(commands_ + n * inputs, values, slopes).has_value();
      if (rows_.inside[n]) continue;
      std::fill_n(values, outputs, 0.0);
      if (sloped_) std::fill_n(slopes, inputs * outputs, 0.0);
    }
  }

  const KinematicMap& map_;
  const double* commands_;
  std::size_t count_;
  bool sloped_;
  Rows rows_;
};

/// Outputs, slopes inputs by outputs, and which rows are inside the map.
std::tuple<TableOut, std::optional<SlopesOut>, Array<std::uint8_t, nb::ndim<1>>> solve_rows(const Map& map,
                                                                                            const TableIn& commands,
                                                                                            bool sloped, int threads) {
  const std::size_t count = commands.shape(0);
  const auto inputs = static_cast<std::size_t>(map.map.inputs()), outputs = static_cast<std::size_t>(map.map.outputs());
  Batch batch(map.map, commands, sloped);
  batch.solve(threads);
  Rows rows = batch.finish();
  std::optional<SlopesOut> slopes;
  if (sloped) slopes = given_away<SlopesOut>(std::move(rows.slopes), {count, inputs, outputs});
  return {given_away<TableOut>(std::move(rows.outputs), {count, outputs}), std::move(slopes),
          list_of(rows.inside.data(), count)};
}

/// Why commands are outside.
std::string refusal(const Map& map, const VectorIn& commands) {
  for (std::size_t i = 0; i < map.map.data().inputs.size(); ++i) {
    const MapInput& input = map.map.data().inputs[i];
    const double command = commands.data()[i];
    if (command >= input.low && command <= input.high) continue;
    return "'" + input.name + "' is " + number(command) + ", outside the map, which takes " + number(input.low) +
           " to " + number(input.high) + (input.unit.empty() ? "" : " " + input.unit);
  }
  return "the commands are outside the map: when it was made, no accurate answer was found there";
}

TableOut shape_at(const Map& map, const VectorIn& commands) {
  Eigen::VectorXd values(map.map.outputs());
  const auto place = map.map.evaluate(commands.data(), values.data());
  if (!place) throw InvalidInput(refusal(map, commands));
  const Points points = map.map.shape(commands.data(), *place);
  return table_of<double>(points.data(), points.rows(), 3);
}

/// Commands, covariance of the unknowns by rows, outputs; chi-square, freedoms, misfit; converged.
using EstimateOut = std::tuple<VectorOut, TableOut, VectorOut, double, double, double, bool>;
EstimateOut estimate_at(const Map& map, const std::vector<Index>& inputs, const VectorIn& means,
                        const VectorIn& spreads, const VectorIn& commands, const VectorIn& values,
                        const VectorIn& deviations) {
  std::vector<MapUnknown> unknowns;
  for (std::size_t i = 0; i < inputs.size(); ++i) unknowns.push_back({inputs[i], means.data()[i], spreads.data()[i]});
  const auto reported =
      estimate_by_map(map.map, unknowns, vector_of(commands), vector_of(values), vector_of(deviations));
  if (!reported) throw InvalidInput(refusal(map, commands));
  const maps::RowMatrix covariance = reported->covariance;
  return {vector_out(reported->commands),
          table_of<double>(covariance.data(), inputs.size(), inputs.size()),
          vector_out(reported->computed),
          reported->chi_square,
          reported->freedoms,
          reported->misfit(),
          reported->converged};
}

/// Name, unit, requested accuracy, largest and mean error.
using OutputOut = std::tuple<std::string, std::string, double, double, double>;
std::vector<OutputOut> outputs_of(const Map& map) {
  const MapData& data = map.map.data();
  std::vector<OutputOut> all;
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    const MapOutput& output = data.outputs[q];
    const Index at = q;
    all.emplace_back(output.name, output.unit, output.accuracy, data.check.largest[at], data.check.mean[at]);
  }
  return all;
}

/// Name, unit, low and high end, rest.
using InputOut = std::tuple<std::string, std::string, double, double, double>;
std::vector<InputOut> inputs_of(const Map& map) {
  std::vector<InputOut> all;
  const MapData& data = map.map.data();
  for (const MapInput& input : data.inputs)
    all.emplace_back(input.name, input.unit, input.low, input.high, data.actuation[input.actuator]);
  return all;
}

/// Points, outside, seed; of the shape: vertices (0: the map has none), accuracy, largest and mean error [mm], largest
/// error of strains.
using CheckOut = std::tuple<Index, Index, std::uint64_t, Index, double, double, double, double>;
CheckOut check_of(const Map& map) {
  const MapData& data = map.map.data();
  return {data.check.points,
          data.check.outside,
          data.check.seed,
          data.shape ? static_cast<Index>(data.shape->mean.size()) / 3 : 0,
          data.shape ? data.shape->accuracy_mm : 0,
          data.check.shape_largest_mm,
          data.check.shape_mean_mm,
          data.check.strain_largest};
}

}  // namespace

Session::Session(RobotPtr of, MapPtr by, bool polish)
    : robot(std::move(of)), map(std::move(by)), polishes(polish), statics(statics_of(*robot, map.get(), polish)) {}

void bind_map(nb::module_& module) {
  nb::class_<MapOptions>(module, "MapOptions", "How a map is made.")
      .def(
          "__init__",
          [](MapOptions* self, double accuracy_mm, double load_accuracy, double shape_accuracy_mm, Index most,
             Index checks, std::uint64_t seed, const StaticsOptions& statics, int threads) {
            new (self) MapOptions(
                map_options(accuracy_mm, load_accuracy, shape_accuracy_mm, most, checks, seed, statics, threads));
          },
          nb::arg("accuracy_mm"), nb::arg("load_accuracy"), nb::arg("shape_accuracy_mm"), nb::arg("most"),
          nb::arg("checks"), nb::arg("seed"), nb::arg("statics"), nb::arg("threads"));
  nb::class_<Map>(module, "Map", "A robot's equilibria in closed form.")
      .def_static(
          "of_file", [](const std::string& file) { return std::make_shared<Map>(runs::read_map(file), file); },
          nb::arg("file"))
      .def_static(
          "unpickled",
          [](nb::bytes bytes, const std::string& name) {
            return std::make_shared<Map>(runs::map_from_bytes({bytes.c_str(), bytes.size()}, name), name);
          },
          nb::arg("bytes"), nb::arg("name"))
      .def("pickled",
           [](const Map& m) {
             const std::string bytes = runs::map_bytes(m.map.data());
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def(
          "save", [](const Map& m, const std::string& path) { runs::write_map(path, m.map.data()); }, nb::arg("path"))
      .def_ro("name", &Map::name)
      .def_prop_ro("robot", [](const Map& m) { return m.map.data().robot; })
      .def_prop_ro("robot_name", [](const Map& m) { return m.map.data().name; })
      .def_prop_ro("equilibria", [](const Map& m) { return m.map.data().equilibria; })
      .def_prop_ro("inputs", &inputs_of)
      .def_prop_ro("outputs", &outputs_of)
      .def_prop_ro("check", &check_of)
      .def("text", [](const Map& m) { return runs::map_text(m.map.data()); })
      .def("solve", &solve_rows, nb::arg("commands"), nb::arg("sloped"), nb::arg("threads"))
      .def("refusal", &refusal, nb::arg("commands"))
      .def("estimate", &estimate_at, nb::arg("inputs"), nb::arg("means"), nb::arg("spreads"), nb::arg("commands"),
           nb::arg("values"), nb::arg("deviations"))
      .def("shape", &shape_at, nb::arg("commands"))
      .def(
          "save_c",
          [](const Map& m, const std::string& path, bool floats) {
            const auto numbers = floats ? runs::CNumbers::floats : runs::CNumbers::doubles;
            write_file(path, runs::map_c_header(m.map.data(), numbers));
          },
          nb::arg("path"), nb::arg("floats"))
      .def(
          "save_js",
          [](const Map& m, const std::string& path, const std::string& types) {
            write_file(path, runs::map_js_module(m.map.data()));
            write_file(types, runs::map_js_types(m.map.data()));
          },
          nb::arg("path"), nb::arg("types"))
      .def(
          "save_npz", [](const Map& m, const std::string& path) { write_file(path, runs::map_npz(m.map.data())); },
          nb::arg("path"));
  module.def("make_map", &make_map, nb::arg("robot"), nb::arg("options"), nb::arg("store"), nb::arg("progress").none());
}

}  // namespace softkin::python
