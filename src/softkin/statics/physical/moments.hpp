#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

/// Moments on rigid regions, which keep their direction: on some of its vertices, at x, forces w x (x - mean), w so
/// that these add up to the moment in the present shape. They grow with the share of what is done at once, but for what
/// is commanded.
///
/// Such a load has no energy. What is told is its work as it is now on all of the way from rest.
///
/// source  Ziegler 1968, Principles of structural stability: moments of a fixed axis have no potential
class Moments : public NodeLoads {
 public:
  /// model must outlive the object.
  explicit Moments(const Model& model);

  [[nodiscard]] bool conservative() const override { return false; }
  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  void add_change(const Demand& from, const Demand& to, const Points& positions, Term::Scratch& scratch, Points& force,
                  Team& team) const override;
  void add_derivative(Index command, const Demand& demand, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const override;
  [[nodiscard]] bool loads(Index command) const override;
  [[nodiscard]] bool grows() const override;

 private:
  /// A component of a moment. Its load is that of 1 N mm.
  struct Component {
    const RegionMoment& of;
    int axis;
    Index command = -1;  // -1: none
  };
  [[nodiscard]] std::size_t parts() const override { return components_.size(); }
  [[nodiscard]] const std::vector<Index>& nodes_of_part(std::size_t part) const override {
    return components_[part].of.vertices;
  }
  [[nodiscard]] double scale(std::size_t part, const Demand& demand) const override;
  [[nodiscard]] Blocks slopes(std::size_t part, const Points& positions) const override;

  const Model& model_;
  std::vector<Component> components_;
};

}  // namespace softkin::physical
