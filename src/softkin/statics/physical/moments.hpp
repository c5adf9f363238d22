#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

/// Moments on rigid regions, which keep their direction: on some vertices of a region, at x, act forces w x (x - mean),
/// with w such that they add up to the moment in the current shape. Moments that are not commanded grow with the load
/// factor.
///
/// Such a load has no potential. Its reported energy is minus the work of the current forces along the whole
/// displacement from rest.
///
/// source  Ziegler 1968, Principles of structural stability: moments of a fixed axis have no potential
class Moments : public NodeLoads {
 public:
  /// model must outlive the object.
  explicit Moments(const Model& model);

  [[nodiscard]] bool conservative() const override { return false; }
  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                  Points& force, Team& team) const override;
  void add_derivative(Index command, const LoadState& load_state, const Points& positions, Term::Scratch& scratch,
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
  [[nodiscard]] double scale(std::size_t part, const LoadState& load_state) const override;
  [[nodiscard]] Blocks slopes(std::size_t part, const Points& positions) const override;

  const Model& model_;
  std::vector<Component> components_;
};

}  // namespace softkin::physical
