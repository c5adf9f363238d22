#pragma once

#include <softkin/contact/candidates.hpp>
#include <softkin/energy/contact_laws.hpp>
#include <softkin/model/contact_model.hpp>

namespace softkin::physical {

/// Surfaces that may have contact, and the data of the potential between them.
struct ContactSurfaces {
  contact::Surface surface;
  std::vector<double> vertex_area{}, edge_area{};  // that each carries pressure for, by place in the surface [mm^2]
  double reach_mm = 0;                             // > 0: surfaces that are closer repel each other
  double modulus_MPa = 0;                          // > 0: of that repulsion
  /// For every vertex, by place: triangles with which it has no contact, ascending, including those around it.
  contact::Lists unfelt_triangles{};
  /// For every edge, by place: later edges with which it has no contact, ascending.
  contact::Lists unfelt_edges{};

  // of surfaces of several parts; else empty
  const ContactModel* rules = nullptr;
  std::vector<Index> vertex_part{}, edge_part{}, triangle_part{};  // by place
  double guard_area = 0;  // for which a vertex carries pressure against a part of a lower ContactRank [mm^2]

  /// The area for which a vertex carries pressure against a triangle [mm^2].
  [[nodiscard]] double area(Index vertex, Index triangle) const;
  /// The area for which two edges carry pressure [mm^2]; they only keep each other from crossing.
  [[nodiscard]] double area_of_edges(Index a, Index b) const;
};

/// Temporary scales of the contact law, over that of the scene.
struct ContactStiffnessScale {
  double modulus = 1;    // over the scene's
  double reach = 1;      // over the scene's, of different solids
  double foresight = 1;  // range in which future contacts are searched, over the reach
  bool operator==(const ContactStiffnessScale&) const = default;
};

/// The contact force between a vertex and a part, or two edges: it is kept from shape to shape, until the gap
/// corresponds to it.
struct ContactPush {
  Index first, second;  // vertex and part, or two edges
  bool edges;
  double push = 0;       // per area, over the modulus
  double shift = 0;      // from the current gap to that of the scene's contact at this force [mm]
  double stiffness = 0;  // [1/mm]
  Index term = -1;       // the nearest one
};

/// Excludes features of a robot that are near each other at rest from contact: pairs of its vertices, edges and
/// triangles that are nearer at rest than twice the reach.
///
/// broad     of that surface
/// together  as returned by lying_together()
void leave_out_neighbours(const Points& rest, contact::BroadPhase& broad, Team& team, ContactSurfaces& surfaces,
                          const contact::Lists& together = {});

/// Finds sheets of a robot that lie on each other or on its body at rest, and pass through each other there. Returns
/// for every row of the positions the vertices of features that are nearer at rest than twice the reach to a feature
/// with that vertex.
///
/// broad  of that surface
[[nodiscard]] contact::Lists lying_together(const Points& rest, contact::BroadPhase& broad, Team& team,
                                            const ContactSurfaces& surfaces);

/// Potential between surfaces: the barrier of the distance of every vertex to the surface before it, for the area that
/// the vertex carries, and of edges that cross. Each vertex counts the nearest features once, by inclusion and
/// exclusion: triangles, less the edges where two meet, plus the vertices where those meet. So the potential does not
/// depend on how a surface before it is cut into triangles, and its gradient is continuous.
///
/// source     barrier: energy/contact_laws.hpp; exclusion of duplicates: Li et al. 2023, "Convergent incremental
///            potential contact"
/// deviation  edges carry a small fraction of the area: they only keep crossing edges apart
class ContactPotential {
 public:
  /// surfaces and rest must outlive the object
  ContactPotential(const ContactSurfaces& surfaces, const Points& rest);

  /// Two features that are closer than the reach.
  struct Term {
    contact::Nodes nodes;
    contact::Separation separation;
    double weight = 0;        // area times modulus [N], negative where features are excluded
    double threshold = 0;     // of the mollifier of two edges [mm^4]; 0: a vertex
    contact::Pair pair{};     // whose nodes these are: of edges where there is a threshold
    energy::LengthLaw law{};  // of the gap, per area and modulus
  };

  /// The terms of a shape, always in the same order.
  ///
  /// candidates  all pairs that are closer than the reach; sorted
  void find(const Points& positions, const contact::Candidates& candidates, std::vector<Term>& terms,
            const ContactStiffnessScale& stiffness_scale = {}) const;

  /// Returns the contact forces of terms, ascending.
  [[nodiscard]] std::vector<ContactPush> pushes(const std::vector<Term>& terms) const;
  /// Replaces the laws of terms that were found by straight lines through their contact forces and the gaps at which
  /// the scene's contact has these forces. Drops the forces of terms that no longer exist, and adds those of new terms.
  void straighten(std::vector<Term>& terms, std::vector<ContactPush>& pushes) const;
  /// Updates the contact forces by these lines, after a fraction of a move of the vertices.
  void follow(const std::vector<Term>& terms, const Points& moves, double fraction,
              std::vector<ContactPush>& pushes) const;

  /// [mJ]; infinite where the gap of a pair is 0.
  [[nodiscard]] double energy(const Points& positions, const std::vector<Term>& terms) const;

  /// Adds the gradient of the energy [N].
  void add_gradient(const Points& positions, const std::vector<Term>& terms, Points& gradient) const;

  /// The gradient of one term by its nodes [N].
  [[nodiscard]] contact::Gradient gradient(const Points& positions, const Term& term) const;

  /// Second derivative of a term by its nodes [N/mm]; projected: a positive semidefinite part of it.
  void stiffness(const Points& positions, const Term& term, bool projected, contact::Hessian& out) const;

  /// Can a vertex have contact with a triangle; can two edges?
  [[nodiscard]] bool felt(Index vertex, Index triangle) const;
  [[nodiscard]] bool edges_felt(const contact::Pair& edges) const;
  /// The gap at which their contact begins, with temporary scales [mm].
  [[nodiscard]] double reach_of(Index vertex, Index triangle, const ContactStiffnessScale& stiffness_scale) const;
  [[nodiscard]] double reach_of_edges(const contact::Pair& edges, const ContactStiffnessScale& stiffness_scale) const;

 private:
  struct Feature;
  void add_vertex(const Points& positions, const contact::Candidates& candidates, std::size_t begin, std::size_t end,
                  const ContactStiffnessScale& stiffness_scale, std::vector<Term>& terms) const;
  void count(Index triangle, const contact::Separation& separation, Index count, Index pair, double reach,
             std::vector<Feature>& features) const;
  [[nodiscard]] ContactPush push_of(const Term& term) const;
  [[nodiscard]] Index count_at(Index vertex, Index corner) const;
  [[nodiscard]] Index felt_at(Index vertex, Index edge) const;

  const ContactSurfaces& surfaces_;
  const Points& rest_;
  std::vector<Index> place_;  // of a vertex in the surface
};

/// Sorts candidates by their first, then their second feature.
void sort_candidates(contact::Candidates& candidates);

}  // namespace softkin::physical
