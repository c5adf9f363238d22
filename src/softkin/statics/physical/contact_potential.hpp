#pragma once

#include <softkin/contact/candidates.hpp>
#include <softkin/energy/contact_laws.hpp>
#include <softkin/model/contact_model.hpp>

namespace softkin::physical {

/// Surfaces that may touch, and what the potential between them needs.
struct ContactSurfaces {
  contact::Surface surface;
  std::vector<double> vertex_area{}, edge_area{};  // that each carries pressure for, by place in the surface [mm^2]
  double reach_mm = 0;                             // > 0: surfaces that are closer repel each other
  double modulus_MPa = 0;                          // > 0: of that repulsion
  /// Of every vertex, by place: triangles that it does not feel, ascending, those around it among them.
  contact::Lists unfelt_triangles{};
  /// Of every edge, by place: edges after it that it does not feel, ascending.
  contact::Lists unfelt_edges{};

  // of surfaces of several parts; else empty
  const ContactModel* rules = nullptr;
  std::vector<Index> vertex_part{}, edge_part{}, triangle_part{};  // by place
  double guard_area = 0;  // for which a vertex carries pressure against what it stands behind in rank [mm^2]

  /// For which a vertex carries pressure against a triangle [mm^2].
  [[nodiscard]] double area(Index vertex, Index triangle) const;
  /// For which two edges do; they only keep each other from crossing.
  [[nodiscard]] double area_of_edges(Index a, Index b) const;
};

/// How contact is felt for a while, other than the scene has it.
struct ContactFirmness {
  double modulus = 1;    // over the scene's
  double reach = 1;      // over the scene's, of different solids
  double foresight = 1;  // up to so many reaches surfaces are looked at that do not feel each other yet
  bool operator==(const ContactFirmness&) const = default;
};

/// With what a vertex and a part, or two edges, push each other: kept from shape to shape, while gaps come to what goes
/// with it.
struct ContactPush {
  Index first, second;  // vertex and part, or two edges
  bool edges;
  double push = 0;       // per area, over the modulus
  double shift = 0;      // from the gap in the shape at hand to that at which firm contact pushes so [mm]
  double stiffness = 0;  // [1/mm]
  Index term = -1;       // that is nearest
};

/// Closeness of a robot to itself at rest is no contact: none of its vertices and edges feels what is nearer than twice
/// the reach at rest.
///
/// broad     of that surface
/// together  of lying_together
void leave_out_neighbours(const Points& rest, contact::BroadPhase& broad, Team& team, ContactSurfaces& surfaces,
                          const contact::Lists& together = {});

/// Sheets of a robot that lie on each other at rest, or on its body, pass through each other there: of every row of the
/// positions vertices of features that are nearer at rest than twice the reach to one of which it is.
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
/// deviation  edges carry a small share of the area: they only keep crossing edges apart
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
            const ContactFirmness& firmness = {}) const;

  /// What terms push with, ascending.
  [[nodiscard]] std::vector<ContactPush> pushes(const std::vector<Term>& terms) const;
  /// Straightens the laws of terms that were found: lines through what they push with and the gaps that go with it in
  /// the scene's contact. Forgets what is gone, and adds what begins to push.
  void straighten(std::vector<Term>& terms, std::vector<ContactPush>& pushes) const;
  /// What they push with after so much of a move of the vertices, by these lines.
  void follow(const std::vector<Term>& terms, const Points& moves, double share,
              std::vector<ContactPush>& pushes) const;

  /// [mJ]; infinite where a pair touches.
  [[nodiscard]] double energy(const Points& positions, const std::vector<Term>& terms) const;

  /// Adds the gradient of the energy [N].
  void add_gradient(const Points& positions, const std::vector<Term>& terms, Points& gradient) const;

  /// That of one term in its nodes [N].
  [[nodiscard]] contact::Gradient gradient(const Points& positions, const Term& term) const;

  /// Second derivative of a term in its nodes [N/mm]; projected: a positive semidefinite part of it.
  void stiffness(const Points& positions, const Term& term, bool projected, contact::Hessian& out) const;

  /// May a vertex come to feel a triangle; may two edges?
  [[nodiscard]] bool felt(Index vertex, Index triangle) const;
  [[nodiscard]] bool edges_felt(const contact::Pair& edges) const;
  /// How near they come to do so, as contact is felt for a while [mm].
  [[nodiscard]] double reach_of(Index vertex, Index triangle, const ContactFirmness& firmness) const;
  [[nodiscard]] double reach_of_edges(const contact::Pair& edges, const ContactFirmness& firmness) const;

 private:
  struct Feature;
  void add_vertex(const Points& positions, const contact::Candidates& candidates, std::size_t begin, std::size_t end,
                  const ContactFirmness& firmness, std::vector<Term>& terms) const;
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
