#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/contact_potential.hpp>

namespace softkin::physical {

/// Target of a motion without contact: to first order, and with the rotations of elements added.
struct FreeMotion {
  Points straight, turned;
};

/// Coulomb's friction of vertices on surfaces, with normal forces and directions of an earlier shape. It is a potential
/// of the distance of each vertex from its anchor, the point where it sticks; its slope is the friction coefficient
/// times the normal force once the distance exceeds the creep. Anchors stay from step to step where a contact sticks,
/// and follow where it slips, so that creep does not add up over steps.
///
/// source     potential: energy/contact_laws.hpp
/// deviation  Li et al. 2020 take the displacement since the last step instead of an anchor
class Friction {
 public:
  /// surfaces must outlive the object.
  explicit Friction(const ContactSurfaces& surfaces);

  /// Does any pair of parts have friction?
  [[nodiscard]] bool any() const { return any_; }

  /// A vertex on a triangle to which it sticks.
  struct Hold {
    contact::Pair pair;
    Index part;  // of the triangle
    contact::Nodes nodes;
    Eigen::Vector4d weights;  // of the nodes: their sum is how far the vertex is from its anchor
    Vec3 normal;
    double limit = 0;  // friction coefficient times normal force [N]
  };
  using Holds = std::vector<Hold>;
  using Terms = std::vector<ContactPotential::Term>;

  /// Fills holds with the normal forces of a shape at those anchors that are in contact, in the order of the anchors.
  void hold(const Terms& terms, const std::vector<Anchor>& anchors, Holds& holds) const;

  /// Sets the anchors of all contacts in a shape: keeps those that exist, and adds new ones where there is none.
  /// from, to: start and end of the motion to that shape
  void renew(const Points& from, const Points& to, const FreeMotion& free, const Terms& terms,
             std::vector<Anchor>& anchors) const;

  /// Moves the anchors of slipping contacts after these, to within the creep.
  void slide(const Points& positions, const Terms& terms, const Holds& holds, std::vector<Anchor>& anchors) const;

  /// The largest difference of two friction forces on a vertex, over the largest of them [-].
  [[nodiscard]] double disagreement(const Points& positions, const Holds& before, const Holds& after) const;

  [[nodiscard]] double energy(const Points& positions, const Holds& holds) const;  // [mJ]
  void add_gradient(const Points& positions, const Holds& holds, Points& gradient) const;
  /// Second derivative of a hold in its nodes [N/mm]; positive semidefinite.
  void stiffness(const Points& positions, const Hold& hold, contact::Hessian& out) const;

  /// Adds the change of the gradient along moves of the vertices that comes from the change of the normal forces, at a
  /// shape whose normal forces are fixed. It is not symmetric.
  void add_response(const ContactPotential& potential, const Points& positions, const Terms& terms, const Holds& holds,
                    const Points& moves, Points& gradient) const;

  /// Returns the displacement of a vertex from its anchor, across the normal [mm].
  [[nodiscard]] static Vec3 slip(const Points& positions, const Hold& hold);
  [[nodiscard]] double creep_mm() const { return creep_mm_; }
  /// Returns the fraction of the fixed normal forces whose contacts slip [-]; 0 without any.
  [[nodiscard]] double slipping_fraction(const Points& positions, const Holds& holds) const;
  /// Returns the force on the vertex; its nodes take it in proportion to their weights [N].
  [[nodiscard]] Vec3 force(const Points& positions, const Hold& hold) const;

 private:
  struct Touch;
  [[nodiscard]] std::vector<Touch> touches(const Terms& terms) const;
  [[nodiscard]] Anchor fresh_anchor(const Points& from, const Points& to, const FreeMotion& free,
                                    const Touch& touch) const;

  const ContactSurfaces& surfaces_;
  bool any_ = false;
  double creep_mm_;
};

}  // namespace softkin::physical
