#include "robot.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <softkin/model/layer.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/chamber_json.hpp>
#include <softkin/runs/finding_text.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/runs/turns.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "pickles.hpp"
#include "solve.hpp"

namespace softkin::python {

const ElementDeformation& Shape::deformation() const {
  std::call_once(measured_, [this] { deformation_ = robot_->statics().measured(found_.state); });
  return deformation_;
}

const runs::StepRecord& Shape::record() const {
  std::call_once(recorded_, [this] {
    record_ = runs::step_record(model(), found_, deformation());
    record_.self_overlap = robot_->overlaps().in(positions());
    if (!turns_.markers.empty()) record_.marker_turns = turns_.markers;
  });
  return record_;
}

std::vector<FindingOut> finding_lines_of(const Model& model, const runs::StepRecord& record) {
  std::vector<FindingOut> lines;
  for (runs::FindingLine& line : runs::finding_lines(model, record, "solver=softkin.Solver(stable=True)"))
    lines.emplace_back(line.kind, line.is_warning, std::move(line.text));
  return lines;
}

double Shape::turn(const std::string& marker, const std::optional<std::string>& to) const {
  if (!to) {
    const auto m = static_cast<std::size_t>(robot_->oriented_marker(marker));
    return turns_.markers.empty() ? runs::marker_turns(model(), positions())[m] : turns_.markers.at(m);
  }
  const runs::MarkerLine line = runs::read_marker_line(model(), {marker, *to}, "turn").value();
  if (!turns_.lines.empty()) return turns_.lines.at(runs::LineTurns::number(line));
  const auto place = [this](Index m) { return model().markers[static_cast<std::size_t>(m)].at(positions()); };
  return runs::TurnMeter(line.at_rest(model())).next(place(line.to) - place(line.from));
}

namespace {

/// The report of `softkin fk` with this shape as its only step.
std::string report_of(const Shape& shape) {
  const Model& model = shape.model();
  const runs::RecordLog log = runs::step_report(model, model.name, {}, shape.options(), shape.record());
  std::string text;
  log.report([&](std::string_view piece) { text += piece; });
  return text;
}

/// Of a layer under voltage: charge, capacitance, largest field.
using LayerOut = std::array<double, 3>;
/// Of a cable with friction: tension at its far end, fraction that sticks.
using TendonOut = std::array<double, 2>;
/// Of a sealed chamber: its amount [mL]. Of connected ones: the volume of each [mL].
using ChamberOut = std::pair<std::optional<double>, std::vector<double>>;
/// An actuator in a shape: requested, ratio, measure, load, input by its curve, slack, layer, tendon, chamber.
using ActuatorOut = std::tuple<double, double, double, std::optional<double>, std::optional<double>, bool,
                               std::optional<LayerOut>, std::optional<TendonOut>, ChamberOut>;
ActuatorOut actuator_of(const Shape& shape, std::size_t a, const runs::ActuatorRecord& record) {
  const Actuator& actuator = shape.model().actuators[a];
  const bool loaded = !multiplier_key(actuator).empty() && shape.model().formulation == Formulation::physical;
  std::optional<LayerOut> layer;
  if (record.layer) layer = {record.layer->charge_nC, record.layer->capacitance_pF, record.layer->field_kV_mm};
  std::optional<TendonOut> tendon;
  if (has_friction(actuator))
    if (const auto& of = shape.deformation().tendons.at(a)) tendon = {of->end_N, of->sticks};
  const std::optional<double> amount =
      filling_of(actuator) ? std::optional(runs::amount_mL(actuator, record)) : std::nullopt;
  return {record.requested,
          record.achieved,
          record.achieved * actuator.rest_measure,
          loaded ? std::optional(record.multiplier) : std::nullopt,
          record.by_curve,
          record.slack,
          layer,
          tendon,
          {amount, record.volumes_mL}};
}

void bind_fields(nb::class_<Shape>& type) {
  type.def_prop_ro(
          "volume_ratio",
          [](const Shape& s) {
            const auto& values = s.deformation().volume_ratio;
            return list_of(values.data(), values.size());
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "strain", [](const Shape& s) { return rows_out(s.deformation().strain); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "von_mises",
          [](const Shape& s) {
            const auto& values = s.deformation().stress.von_mises;
            return list_of(values.data(), values.size());
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "principal_stress", [](const Shape& s) { return rows_out(s.deformation().stress.principal); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "vertex_reactions",
          [](nb::pointer_and_handle<Shape> s) { return view_of(s.p->deformation().reactions, s.h); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "reactions",
          [](const Shape& s) {
            using Three = std::array<double, 3>;
            using Chambers = std::vector<std::tuple<std::string, Three, Three>>;
            std::vector<std::tuple<Three, Three, Three, Chambers>> all;
            for (const Reaction& r : s.record().forces.reactions) {
              Chambers chambers;
              for (const ChamberForce& of : r.chambers)
                chambers.emplace_back(s.model().actuators[of.actuator].name, array_of(of.force), array_of(of.moment));
              all.emplace_back(array_of(r.force), array_of(r.moment), array_of(r.center), std::move(chambers));
            }
            return all;
          },
          "Force [N], moment [N mm] and centre [mm] of every support; and by chambers that it closes, name, force and "
          "moment of the pressure on it.")
      .def_prop_ro(
          "magnetic_load",
          [](const Shape& s) {
            using Three = std::array<double, 3>;
            std::optional<std::tuple<Three, Three, Three>> load;
            if (const auto& of = s.record().forces.magnetic)
              load.emplace(array_of(of->force), array_of(of->moment), array_of(of->center));
            return load;
          },
          "Force [N], moment [N mm] and centre [mm] of magnetic fields; None where there is none.")
      .def_prop_ro(
          "fibres",
          [](const Shape& s) {
            std::vector<std::tuple<std::string, std::array<double, 3>, std::array<double, 3>, double, double>> all;
            for (std::size_t f = 0; f < s.record().forces.fibres.size(); ++f) {
              const FibreForces& of = s.record().forces.fibres[f];
              all.emplace_back(s.model().reinforcement.fibres[f].name, std::array{of.mean_N, of.largest_N, of.min_N},
                               array_of(of.where), of.stretch, of.slack);
            }
            return all;
          },
          "Name, mean, largest and least tension [N], where the largest is [mm], stretch and slack fraction of each.")
      .def_prop_ro(
          "layers",
          [](const Shape& s) {
            using Three = std::array<double, 3>;
            std::vector<std::tuple<std::string, std::array<double, 2>, Three, Three>> all;
            for (std::size_t l = 0; l < s.record().forces.layers.size(); ++l) {
              const LayerForces& of = s.record().forces.layers[l];
              all.emplace_back(s.model().reinforcement.layers[l]->name, std::array{of.largest_N_mm, of.min_N_mm},
                               array_of(of.where), std::array{of.strain, of.wrinkled, of.slack});
            }
            return all;
          },
          "Name, largest and least tension [N/mm], where the first is [mm], largest strain, fractions wrinkled and "
          "slack "
          "of each.")
      .def_prop_ro(
          "contacts",
          [](const Shape& s) {
            using Three = std::array<double, 3>;
            std::vector<std::tuple<std::string, std::string, Three, Three, Three, std::array<double, 4>>> all;
            if (!s.record().forces.contacts) return all;
            const auto name = [&](Index part) { return s.model().contact.parts[part].name; };
            for (const PairForces& pair : *s.record().forces.contacts)
              all.emplace_back(name(pair.a), name(pair.b), array_of(pair.force), array_of(pair.moment),
                               array_of(pair.center),
                               std::array{pair.normal_N, pair.pressure_kPa, pair.area_mm2, pair.gap_mm});
            return all;
          },
          "Contacts: names, force [N], moment [N mm], centre [mm]; normal force [N], pressure [kPa], area [mm^2], "
          "gap [mm].")
      .def_prop_ro(
          "contact_pressure",
          [](const Shape& s) {
            const auto& contacts = s.deformation().contacts;
            return contacts ? list_of(contacts->pressure_kPa.data(), contacts->pressure_kPa.size())
                            : list_of(static_cast<const double*>(nullptr), 0);
          },
          nb::rv_policy::automatic)
      .def_prop_ro("self_overlap", [](const Shape& s) {
        const SelfOverlap& overlap = s.record().self_overlap;
        return std::tuple(overlap.points, overlap.deepest_mm, array_of(overlap.where));
      });
}

}  // namespace

nb::bytes picture_of(const Shape& shape, const std::vector<double>& view, const std::string& title,
                     const std::vector<Goal>& goals) {
  std::string bytes;
  {
    const nb::gil_scoped_release released;
    bytes = runs::image_png(shape.model(), shape.positions(), view, title, goals);
  }
  return nb::bytes(bytes.data(), bytes.size());
}

namespace {

/// An array over points or cells: (n,) or (n, components).
nb::object array_of_field(const Field& field) {
  const std::size_t columns = field.components, rows = field.values.size() / columns;
  if (columns == 1) return nb::cast(list_of(field.values.data(), rows));
  return nb::cast(table_of(field.values.data(), rows, columns));
}

/// By name.
nb::dict arrays_of_fields(const std::vector<Field>& fields) {
  nb::dict arrays;
  for (const Field& field : fields) arrays[nb::str(field.name.c_str())] = array_of_field(field);
  return arrays;
}

using ArraysByName = nb::typed<nb::dict, nb::str, Array<double>>;

void bind_content(nb::module_& module) {
  nb::class_<VtuContent>(module, "ShapeContent", "What the .vtu of a shape holds.")
      .def_prop_ro("point_data", [](const VtuContent& c) -> ArraysByName { return arrays_of_fields(c.point_fields); })
      .def_prop_ro("cell_data", [](const VtuContent& c) -> ArraysByName { return arrays_of_fields(c.cell_fields); })
      .def_prop_ro(
          "cell_regions", [](const VtuContent& c) { return list_of(c.cell_regions.data(), c.cell_regions.size()); },
          nb::rv_policy::automatic)
      .def_ro("region_names", &VtuContent::region_names)
      .def_ro("constants", &VtuContent::constants)
      .def_prop_ro("arrays", [](const VtuContent& c) -> ArraysByName { return arrays_of_fields(c.arrays); })
      .def_prop_ro(
          "triangles", [](const VtuContent& c) { return cells_out(c.triangles); }, nb::rv_policy::automatic);
}

}  // namespace

void bind_shape(nb::module_& module) {
  bind_content(module);
  nb::class_<Shape> type(module, "Shape", "An equilibrium of a robot.");
  type.def_prop_ro("robot", [](const Shape& s) { return s.robot(); })
      .def_prop_ro(
          "positions", [](nb::pointer_and_handle<Shape> s) { return view_of(s.p->positions(), s.h); },
          nb::rv_policy::automatic)
      .def("marker",
           [](const Shape& s, std::size_t marker) { return array_of(s.model().markers.at(marker).at(s.positions())); })
      .def("turn", &Shape::turn, nb::arg("marker"), nb::arg("to").none(), "[degrees]")
      .def("actuators",
           [](const Shape& s) {
             std::vector<ActuatorOut> all;
             const auto records = runs::actuator_records(s.model(), s.found());
             for (std::size_t a = 0; a < records.size(); ++a) all.push_back(actuator_of(s, a, records[a]));
             return all;
           })
      .def_prop_ro(
          "actuation", [](const Shape& s) { return vector_out(s.found().actuation); }, nb::rv_policy::automatic)
      .def_prop_ro("status", [](const Shape& s) { return name_of(s.found().report.status); })
      .def_prop_ro("converged", [](const Shape& s) { return s.found().report.status == Status::converged; })
      .def_prop_ro("reached", [](const Shape& s) { return s.found().report.reached; })
      .def_prop_ro("remark", [](const Shape& s) { return s.found().report.remark; })
      .def_prop_ro("iterations", [](const Shape& s) { return s.found().report.iterations; })
      .def_prop_ro("seconds", [](const Shape& s) { return s.found().report.seconds; })
      .def_prop_ro("unstable_modes", [](const Shape& s) { return s.found().report.physical.unstable_modes; })
      .def("report",
           [](const Shape& s) {
             const nb::gil_scoped_release released;
             return report_of(s);
           })
      .def_prop_ro("fingerprint", [](const Shape& s) { return fingerprint_of(s.positions()); })
      .def("measure",
           [](const Shape& s) {
             const nb::gil_scoped_release released;
             (void)s.record();
           })
      .def("findings",
           [](const Shape& s) {
             const nb::gil_scoped_release released;
             return finding_lines_of(s.model(), s.record());
           })
      .def("content",
           [](const Shape& s) {
             const nb::gil_scoped_release released;
             return runs::shape_content(s.model(), s.found().state, s.deformation(),
                                        s.found().report.status == Status::converged);
           })
      .def(
          "save_vtu",
          [](const Shape& s, const std::string& path) {
            const nb::gil_scoped_release released;
            runs::write_shape(path, s.model(), s.found().state, s.deformation(),
                              s.found().report.status == Status::converged);
          },
          nb::arg("path"))
      .def(
          "png",
          [](const Shape& s, const std::vector<double>& view, const std::string& title) {
            return picture_of(s, view, title);
          },
          nb::arg("view"), nb::arg("title"))
      .def("pickled",
           [](const Shape& s) {
             Writer writer;
             writer(s.found(), s.options(), s.turns());
             return nb::bytes(writer.bytes().data(), writer.bytes().size());
           })
      .def_static(
          "unpickled",
          [](RobotPtr robot, nb::bytes bytes) {
            Equilibrium found;
            StaticsOptions options;
            RunTurns turns;
            Reader reader({bytes.c_str(), bytes.size()});
            reader(found, options, turns);
            reader.finish();
            if (found.state.positions.rows() != robot->model().rest.rows())
              throw InvalidInput("the pickled shape is one of another robot");
            return std::make_shared<Shape>(std::move(robot), std::move(found), options, std::move(turns));
          },
          nb::arg("robot"), nb::arg("bytes"));
  bind_fields(type);
}

}  // namespace softkin::python
