#include <algorithm>
#include <softkin/kinematics/estimate/readings.hpp>
#include <softkin/model/sensor.hpp>
#include <softkin/statics/deformation.hpp>

namespace softkin::estimate {

namespace {

/// Largest displacement of a vertex, relative to the diagonal, of the differences that differentiate lengths and
/// volumes.
constexpr double small_move = 1e-6;

double force_on(const Model& model, const PoseColumn& column, const Points& positions, const Points& at_vertices) {
  ElementDeformation deformation;
  deformation.reactions = at_vertices;
  return reactions(model, positions, deformation)[column.support].force[column.axis];
}

/// Returns the length of a cable or the volume of a chamber, [mm] or [mm^3].
double measure_at(const Model& model, Index actuator, const Points& positions) {
  const Actuator& of = model.actuators[actuator];
  return achieved_ratio(model, of, positions) * of.rest_measure;
}

bool is_measure(const PoseColumn& column) {
  return column.actuator >= 0 && (column.kind == Reading::length || column.kind == Reading::volume);
}

}  // namespace

bool is_of_shape(const PoseColumn& column) {
  return column.marker >= 0 || column.sensor >= 0 || is_measure(column);
}

double reading_at(const Model& model, const PoseColumn& column, const State& state, const Points& reactions) {
  if (column.marker >= 0) return model.markers[column.marker].at(state.positions)[column.axis];
  if (column.sensor >= 0) return model.sensors[column.sensor]->at(state.positions, column.axis);
  if (is_measure(column)) return measure_at(model, column.actuator, state.positions);
  if (column.support >= 0) return force_on(model, column, state.positions, reactions);
  return state.multipliers[column.actuator];
}

double reading_change(const Model& model, const PoseColumn& column, const State& state, const ShapeChange& change) {
  const Points& at = state.positions;
  if (column.marker >= 0) return model.markers[column.marker].velocity(at, change.moves)[column.axis];
  if (column.sensor >= 0) return model.sensors[column.sensor]->velocity(at, change.moves, column.axis);
  if (is_measure(column)) {
    const double largest = change.moves.cwiseAbs().maxCoeff();
    if (!(largest > 0)) return 0;
    const double h = small_move * model.diagonal_mm / largest;
    return (measure_at(model, column.actuator, at + h * change.moves) -
            measure_at(model, column.actuator, at - h * change.moves)) /
           (2 * h);
  }
  if (column.support >= 0) return force_on(model, column, at, change.reactions);
  return change.multipliers[column.actuator];
}

namespace {

/// Returns the vertices on which a marker or a sensor depends, some of them twice.
std::vector<Index> vertices_of(const Model& model, const PoseColumn& column) {
  if (column.marker >= 0) return model.markers[column.marker].point.vertices;
  const Sensor& sensor = *model.sensors[column.sensor];
  std::vector<Index> all;
  for (const FibrePlace& place : sensor.places) all.insert(all.end(), place.vertices.begin(), place.vertices.end());
  for (const TurningSection& section : sensor.sections)
    for (const Marker& marker : section.along)
      all.insert(all.end(), marker.point.vertices.begin(), marker.point.vertices.end());
  return all;
}

}  // namespace

Points reading_gradient(const Model& model, const PoseColumn& column, const Points& positions) {
  std::vector<Index> vertices = vertices_of(model, column);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Points gradient = Points::Zero(positions.rows(), 3), move = gradient;
  for (const Index v : vertices)
    for (Index axis = 0; axis < 3; ++axis) {
      move(v, axis) = 1;
      gradient(v, axis) = column.marker >= 0 ? model.markers[column.marker].velocity(positions, move)[column.axis]
                                             : model.sensors[column.sensor]->velocity(positions, move, column.axis);
      move(v, axis) = 0;
    }
  return gradient;
}

}  // namespace softkin::estimate
