#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/contact_potential.hpp>

namespace softkin::physical {

/// Where a way would lead if nothing were in the way: to first order, and with what turns add to that.
struct FreeWay {
  Points straight, turned;
};

/// Coulomb's friction of vertices on surfaces, with normal forces and directions of an earlier shape: a potential of
/// how far each vertex is from where it sticks, its anchor, whose slope is the friction coefficient times the normal
/// force once that is farther than a creep. Anchors stay from step to step where a contact sticks, and follow where it
/// slips, so that what sticks does not creep on with the number of steps.
///
/// source     potential: energy/contact_laws.hpp
/// deviation  Li et al. 2020 take the displacement since the last step instead of an anchor
class Friction {
 public:
  /// surfaces must outlive the object.
  explicit Friction(const ContactSurfaces& surfaces);

  /// Does any pair of parts rub?
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

  /// Of the normal forces of a shape, at those anchors that are in contact; in the order of the anchors.
  void hold(const Terms& terms, const std::vector<Anchor>& anchors, Holds& holds) const;

  /// Anchors of all that is in contact in a shape: those that there are, and new ones where none is.
  /// from, to: the way on which they came
  void renew(const Points& from, const Points& to, const FreeWay& free, const Terms& terms,
             std::vector<Anchor>& anchors) const;

  /// Lets the anchors of what slips follow to within the creep.
  void slide(const Points& positions, const Terms& terms, const Holds& holds, std::vector<Anchor>& anchors) const;

  /// The largest difference of two friction forces on a vertex, over the largest of them [-].
  [[nodiscard]] double disagreement(const Points& positions, const Holds& before, const Holds& after) const;

  [[nodiscard]] double energy(const Points& positions, const Holds& holds) const;  // [mJ]
  void add_gradient(const Points& positions, const Holds& holds, Points& gradient) const;
  /// Second derivative of a hold in its nodes [N/mm]; positive semidefinite.
  void stiffness(const Points& positions, const Hold& hold, contact::Hessian& out) const;

  /// Adds what moves of the vertices change of the gradient by the normal forces that they change, at a shape whose
  /// normal forces are held. Not symmetric.
  void add_response(const ContactPotential& potential, const Points& positions, const Terms& terms, const Holds& holds,
                    const Points& moves, Points& gradient) const;

  /// How far a vertex is from its anchor, across the normal [mm].
  [[nodiscard]] static Vec3 slip(const Points& positions, const Hold& hold);
  [[nodiscard]] double creep_mm() const { return creep_mm_; }
  /// Of the normal forces that are held, the share that slips [-]; 0 without any.
  [[nodiscard]] double slipping_share(const Points& positions, const Holds& holds) const;
  /// On the vertex; the nodes share it by their weights [N].
  [[nodiscard]] Vec3 force(const Points& positions, const Hold& hold) const;

 private:
  struct Touch;
  [[nodiscard]] std::vector<Touch> touches(const Terms& terms) const;
  [[nodiscard]] Anchor fresh_anchor(const Points& from, const Points& to, const FreeWay& free,
                                    const Touch& touch) const;

  const ContactSurfaces& surfaces_;
  bool any_ = false;
  double creep_mm_;
};

}  // namespace softkin::physical
