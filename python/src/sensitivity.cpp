#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/scene/changes.hpp>
#include <softkin/kinematics/estimate/readings.hpp>
#include <softkin/kinematics/jacobian.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "robot.hpp"

namespace softkin::python {

namespace {

/// By which a number is changed, of what it is.
constexpr double perturbation = 1e-5;

/// A robot's description, of which a number at a time is changed.
struct Description {
  Source source;
  std::shared_ptr<const scene::Node> tree;  // as it is

  explicit Description(const Source& of) : source(of), tree(of.tree) {}

  Model changed(const std::string& number, double value) {
    source.tree = scene::changed(tree, "number", number + "=" + exact(value), "");
    return compile(source.spec(false));
  }
};

/// throws  InvalidInput: with the nearest name where the scene can have no such number
double value_of(Description& robot, const std::string& number) {
  try {
    return scene::number_at(robot.tree, "number", number);
  } catch (const InvalidInput&) {
    (void)robot.changed(number, 1);
    throw InvalidInput("number " + number + ": the description does not say it; give it a value there");
  }
}

/// A number that is a little larger and smaller; where the scene refuses it smaller, as it is.
struct Changed {
  double value;
  Model more, less;
  double difference;

  Changed(Description& robot, const std::string& number)
      : value(value_of(robot, number)), more(robot.changed(number, value + half())) {
    try {
      less = robot.changed(number, value - half());
      difference = 2 * half();
    } catch (const InvalidInput&) {
      less = robot.changed(number, value);
      difference = half();
    }
  }
  [[nodiscard]] double half() const { return perturbation * (value != 0 ? std::abs(value) : 1); }
};

/// The requested numbers of a robot.
struct Numbers {
  std::vector<std::unique_ptr<Changed>> all;
  std::vector<Perturbed> perturbed;

  Numbers(const Source& source, const std::vector<std::string>& names) {
    Description robot(source);
    for (const std::string& name : names) {
      const Changed& each = *all.emplace_back(std::make_unique<Changed>(robot, name));
      perturbed.push_back({each.more, each.less, each.difference});
    }
  }
};

[[noreturn]] void refuse_singular() {
  throw InvalidInput("the shape stands at a limit of existence or a branch, where it has no derivatives");
}

/// A number as it is, and per unit of it: moves (n, 3), those of markers (k, 3), loads of actuators (m,).
using NumberSlopes = std::tuple<double, TableOut, TableOut, VectorOut>;

std::vector<NumberSlopes> sensitivity_of(const Shape& shape, const std::vector<std::string>& numbers) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<double> values;
  std::vector<Rows> moves, markers;
  std::vector<Eigen::VectorXd> loads;
  {
    const nb::gil_scoped_release released;
    const State& state = shape.found().state;
    const Numbers requested(shape.robot()->source(), numbers);
    const ParameterSensitivity found =
        Perturbations(shape.robot()->statics(), requested.perturbed).at(state, shape.options());
    if (!found.regular) refuse_singular();
    for (std::size_t p = 0; p < numbers.size(); ++p) {
      values.push_back(requested.all[p]->value);
      moves.emplace_back(found.positions[p]);
      loads.emplace_back(found.multipliers.col(p));
      Rows& rows = markers.emplace_back(static_cast<Eigen::Index>(shape.model().markers.size()), 3);
      for (Eigen::Index m = 0; m < rows.rows(); ++m)
        rows.row(m) = marker_slope(shape.model(), requested.perturbed[p], m, state.positions, found.positions[p]);
    }
  }
  const auto table = [](const Rows& rows) { return table_of<double>(rows.data(), rows.rows(), rows.cols()); };
  std::vector<NumberSlopes> out;
  for (std::size_t p = 0; p < numbers.size(); ++p)
    out.emplace_back(values[p], table(moves[p]), table(markers[p]), vector_out(loads[p]));
  return out;
}

/// Returns a gradient by markers, (k, 3), as one by the positions of the vertices.
Points by_places(const Shape& shape, const Points& by_markers) {
  Points sum = Points::Zero(shape.positions().rows(), 3);
  for (Eigen::Index m = 0; m < by_markers.rows(); ++m)
    for (int axis = 0; axis < 3; ++axis)
      if (const double by = by_markers(m, axis); by != 0)
        sum += by * estimate::reading_gradient(shape.model(), {{}, static_cast<Index>(m), axis}, shape.positions());
  return sum;
}

VectorOut gradient_of(const Shape& shape, const std::vector<std::string>& numbers, const PointsIn& by_positions,
                      const PointsIn& by_markers, const VectorIn& by_loads) {
  Eigen::VectorXd gradient;
  {
    const Points markers = points_of(by_markers);
    ShapeGradient reported{points_of(by_positions), vector_of(by_loads)};
    const nb::gil_scoped_release released;
    const State& state = shape.found().state;
    const Numbers requested(shape.robot()->source(), numbers);
    reported.by_places += by_places(shape, markers);
    const Eigen::MatrixXd found =
        Perturbations(shape.robot()->statics(), requested.perturbed).gradients(state, {reported}, shape.options());
    if (found.cols() != std::ssize(numbers)) refuse_singular();
    gradient = found.row(0).transpose();
    const Points still = Points::Zero(state.positions.rows(), 3);  // how markers move in the shape as it is
    for (std::size_t p = 0; p < numbers.size(); ++p)
      for (Eigen::Index m = 0; m < markers.rows(); ++m)
        if (!markers.row(m).isZero(0))
          gradient[p] +=
              markers.row(m) * marker_slope(shape.model(), requested.perturbed[p], m, state.positions, still);
  }
  return vector_out(gradient);
}

}  // namespace

void bind_sensitivity(nb::module_& module) {
  module.def("sensitivity", &sensitivity_of, nb::arg("shape"), nb::arg("numbers"),
             "Per number: its value, and by it the moves (n, 3), those of markers (k, 3) and loads (m,).");
  module.def("gradient", &gradient_of, nb::arg("shape"), nb::arg("numbers"), nb::arg("by_positions"),
             nb::arg("by_markers"), nb::arg("by_loads"),
             "Derivatives by the numbers of what has these by positions (n, 3), markers (k, 3) and loads (m,).");
}

}  // namespace softkin::python
