#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/body_surface.hpp>
#include <softkin/runs/records.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// A number for every vertex of the page.
struct VertexField {
  std::string name;
  std::vector<float> values;
};

/// The unit of an actuator's length, area or volume where that is a result besides its load and its command: "× rest"
/// or "mL"; else "".
[[nodiscard]] std::string page_measure_unit(const Model& model, const Actuator& actuator);

/// What the page (apps/view/web) shows of a robot, its steps and its map, as JSON. Arrays of numbers are
/// {"f32": base64}, little-endian; also "u16" and "u32". Those of steps are rounded, to 1/131,070 of the span of each
/// component: {"u16": base64, "low": [...], "step": [...]} stands for low + step u16. Vertices are numbered in the
/// order of vertices(); lengths in mm, strains without unit, pressures in kPa, forces in N, times in s. An actuator of
/// a uniform magnetic field has "flux_density": what one mT of its command adds to that field, a vector [mT].
class PageDocument {
 public:
  /// model must outlive the object. command: the line that made it, for people
  PageDocument(const Model& model, std::string command);

  /// The model's vertices that the page knows: of the surface, ascending; then those that cables need beside them, and
  /// those of bodies.
  [[nodiscard]] const std::vector<Index>& vertices() const { return vertices_; }

  /// What a shape shows in colours: "strain", the greatest principal one [-], "volume_ratio" [-] and, where the robot
  /// may touch anything, "contact_pressure" [kPa]. Of elements the mean around each vertex, weighted by their volumes.
  [[nodiscard]] std::vector<VertexField> fields(const ElementDeformation& deformation) const;

  [[nodiscard]] std::size_t steps() const { return steps_.size(); }
  /// One more step. positions: #V by 3 of the model [mm]; deformation: of them
  void add(const StepRecord& record, const Points& positions, const ElementDeformation& deformation);
  /// Where a marker gets, #samples by 3 [mm].
  void show_reach(Index marker, const Points& positions);

  /// All of it on one line.
  ///
  /// map     to bend the robot by in the page; null: none
  /// throws  InvalidInput where the shape of the map has other vertices than the model
  [[nodiscard]] std::string text(const MapData* map) const;
  /// The map alone, as text() has it. Throws as that
  [[nodiscard]] std::string map_text(const MapData& map) const;

 private:
  void take(const std::vector<Index>& more);
  [[nodiscard]] Index number(Index vertex) const { return numbers_[vertex]; }
  [[nodiscard]] std::vector<float> mean_at_vertices(const std::vector<double>& of_elements) const;

  const Model& model_;
  std::string command_;
  BodySurface surface_;
  std::vector<Index> vertices_;
  std::vector<Index> numbers_;        // by the model's vertices; -1: not in the page
  Bounds drawn_;                      // the robot in all of its shapes
  Points last_;                       // shape, for what is drawn around it
  std::string reach_{};               // JSON; empty: none
  std::vector<std::string> steps_{};  // JSON
};

}  // namespace softkin::runs
