#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <softkin/drive/marlin_link.hpp>
#include <softkin/drive/plan.hpp>
#include <softkin/io/scene/hardware.hpp>
#include <softkin/io/stream_log.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/runs/reports.hpp>

#include <atomic>

#include "bindings.hpp"
#include "convert.hpp"
#include "robot.hpp"

namespace softkin::python {

namespace {

using drive::Order;

struct PlanOf {
  RobotPtr robot;
  drive::Plan plan;
};

/// How a stream ended, as the Python layer names it.
struct Sent {
  drive::StreamReport report;
  std::string axes;
};

/// A board at a serial port. One program is sent at a time; other threads may order meanwhile.
class Link {
 public:
  Link(const std::string& port, int baud, double boot_wait_s) : port_(std::in_place, port, baud) {
    options_.boot_s = boot_wait_s;
  }

  /// A stop lasts until its program has ended: neither go_on() nor pause() of another thread takes it back.
  void order(Order requested) {
    Order now = order_;
    while ((now < Order::stop || requested == Order::quick_stop) && !order_.compare_exchange_weak(now, requested))
      continue;
  }
  void close() { port_.reset(); }

  /// Ctrl-C stops after the moves that the board has, a second one at once; then KeyboardInterrupt is raised.
  Sent send(const PlanOf& of, const std::string& log_file,
            const std::optional<nb::typed<nb::callable, nb::object(std::size_t)>>& progress) {
    if (!port_) throw InvalidInput("the link is closed");
    order_ = Order::go;
    std::optional<nb::python_error> raised;
    drive::LinkHooks hooks;
    std::optional<StreamLog> log;
    if (!log_file.empty()) log.emplace(log_file, [](const std::string&) {});
    if (log) hooks.log = [&](char kind, const std::string& text) { log->add(kind, text); };
    hooks.order = [&] {
      const nb::gil_scoped_acquire gil;
      if (PyErr_CheckSignals() != 0) stop(raised);
      return order_.load();
    };
    if (progress)
      hooks.progress = [&](std::size_t lines) {
        const nb::gil_scoped_acquire gil;
        try {
          (*progress)(lines);
        } catch (nb::python_error& error) {
          keep(raised, error);
        }
      };
    Sent sent{{}, of.plan.program.axes};
    {
      const nb::gil_scoped_release released;
      sent.report = drive::stream(*port_, of.plan.program, options_, hooks);
      log.reset();
    }
    if (raised) {
      last_ = sent;
      nb::python_error error = std::move(*raised);
      raised.reset();
      throw error;
    }
    last_ = sent;
    return sent;
  }
  [[nodiscard]] const std::optional<Sent>& last() const { return last_; }

 private:
  void keep(std::optional<nb::python_error>& raised, nb::python_error& error) {
    order(raised ? Order::quick_stop : Order::stop);
    if (!raised) raised.emplace(std::move(error));
  }
  void stop(std::optional<nb::python_error>& raised) {
    nb::python_error error;
    keep(raised, error);
  }

  std::optional<drive::SerialPort> port_;
  drive::LinkOptions options_;
  std::atomic<Order> order_ = Order::go;
  std::optional<Sent> last_;
};

std::shared_ptr<PlanOf> plan_of(const RobotPtr& robot, Commands commands, const std::string& hardware,
                                bool return_home) {
  return std::make_shared<PlanOf>(
      PlanOf{robot, drive::make_plan(robot->model(), read_hardware(hardware), std::move(commands), return_home)});
}

/// pressures: k x m [kPa], NaN columns: not known
Commands commands_of(const Robot& robot, const TableIn& rows, const std::optional<VectorIn>& times,
                     const std::optional<TableIn>& pressures) {
  const std::size_t actuators = robot.model().actuators.size();
  Commands commands{"the commands", std::vector<bool>(actuators, true), std::vector<bool>(actuators, false), {}};
  const auto row_of = [actuators](const TableIn& table, std::size_t row) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(table.data() + row * actuators, actuators));
  };
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    CommandRow row{row_of(rows, i), Eigen::VectorXd::Zero(actuators), {}, i + 1};
    check_actuation(robot.model(), row.actuation);
    if (pressures) row.pressures_kpa = row_of(*pressures, i);
    for (std::size_t a = 0; a < actuators && i == 0 && pressures; ++a)
      commands.pressure_known[a] = !std::isnan(row.pressures_kpa[a]);
    if (times) row.time_s = times->data()[i];
    commands.rows.push_back(std::move(row));
  }
  return commands;
}

}  // namespace

void bind_drive(nb::module_& module) {
  nb::class_<PlanOf>(module, "Plan", "Commands as moves of motors and pressures, within all limits.")
      .def_static(
          "of_file",
          [](const RobotPtr& robot, const std::string& file, const std::string& pressures, const std::string& hardware,
             bool return_home) {
            return plan_of(robot, read_commands(robot->model(), file, pressures), hardware, return_home);
          },
          nb::arg("robot"), nb::arg("file"), nb::arg("pressures"), nb::arg("hardware"), nb::arg("return_home"))
      .def_static(
          "of_rows",
          [](const RobotPtr& robot, const TableIn& rows, const std::optional<VectorIn>& times,
             const std::optional<TableIn>& pressures, const std::string& hardware, bool return_home) {
            return plan_of(robot, commands_of(*robot, rows, times, pressures), hardware, return_home);
          },
          nb::arg("robot"), nb::arg("rows"), nb::arg("times").none(), nb::arg("pressures").none(), nb::arg("hardware"),
          nb::arg("return_home"))
      .def_prop_ro("gcode", [](const PlanOf& of) { return drive::gcode_text(of.plan.machine, of.plan.program); })
      .def_prop_ro("schedule", [](const PlanOf& of) { return drive::schedule_csv(of.plan.schedule); })
      .def_prop_ro("has_motors", [](const PlanOf& of) { return of.plan.has_motors(); })
      .def_prop_ro("has_chambers", [](const PlanOf& of) { return !of.plan.machine.chambers.empty(); })
      .def_prop_ro("lines", [](const PlanOf& of) { return of.plan.program.lines.size(); })
      .def_prop_ro("seconds", [](const PlanOf& of) { return of.plan.motion.seconds; })
      .def_prop_ro("defaults", [](const PlanOf& of) { return of.plan.machine.defaults; })
      .def("json", [](const PlanOf& of) { return runs::drive_report(of.robot->model().name, of.plan, true, nullptr); });
  nb::class_<Sent>(module, "Sent", "How a program was sent.")
      .def_prop_ro("end", [](const Sent& sent) { return drive::name_of(sent.report.end); })
      .def_prop_ro("finished", [](const Sent& sent) { return sent.report.end == drive::StreamEnd::finished; })
      .def_prop_ro("message", [](const Sent& sent) { return sent.report.message; })
      .def_prop_ro("lines", [](const Sent& sent) { return sent.report.lines; })
      .def_prop_ro("acknowledged", [](const Sent& sent) { return sent.report.acknowledged; })
      .def_prop_ro("sent", [](const Sent& sent) { return sent.report.sent; })
      .def_prop_ro("resends", [](const Sent& sent) { return sent.report.resends; })
      .def_prop_ro("timeouts", [](const Sent& sent) { return sent.report.timeouts; })
      .def_prop_ro("position_known", [](const Sent& sent) { return sent.report.position_known; })
      .def_prop_ro("position", [](const Sent& sent) {
        std::vector<std::pair<std::string, double>> all;
        if (sent.report.position_known)
          for (std::size_t i = 0; i < sent.report.position.size(); ++i)
            all.emplace_back(std::string(1, sent.axes[i]), sent.report.position[i]);
        return all;
      });
  nb::class_<Link>(module, "Link", "A Marlin board at a serial port.")
      .def(nb::init<const std::string&, int, double>(), nb::arg("port"), nb::arg("baud"), nb::arg("boot_wait_s"))
      .def("send", &Link::send, nb::arg("plan"), nb::arg("log"), nb::arg("progress").none())
      .def("pause", [](Link& link) { link.order(Order::pause); })
      .def("go_on", [](Link& link) { link.order(Order::go); })
      .def("stop", [](Link& link) { link.order(Order::stop); })
      .def("quick_stop", [](Link& link) { link.order(Order::quick_stop); })
      .def_prop_ro("last", &Link::last)
      .def("close", &Link::close);
}

}  // namespace softkin::python
