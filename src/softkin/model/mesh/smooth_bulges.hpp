#pragma once

#include <softkin/model/mesh/mesh_sections.hpp>
#include <softkin/model/mesh/revolved_surface.hpp>
#include <softkin/model/mesh/smooth_surface.hpp>
#include <vector>

namespace softkin {

/// By which part of itself a section of a body changes: the one that loses most, and the one that gains most.
struct SectionChange {
  double least = 0, most = 0;
  /// The larger of both, with its sign.
  [[nodiscard]] double largest() const { return -least > most ? least : most; }
};

/// Compares volumes of a mesh's sections; those with less than 3 % of their part's volume do not count.
[[nodiscard]] SectionChange section_change(const std::vector<double>& before, const std::vector<double>& after);

/// How the edges of a mesh's surface curve on a smooth surface through the vertices, and where the vertices determine
/// that it is nearer to the body than straight edges are.
///
/// Where they leave open how an edge curves, the edge stays straight along the profile. A part of the mesh is in doubt
/// where one of its sections, or all together, may then be farther from the body's volume than with straight edges.
class SmoothBulges {
 public:
  /// mesh    of order 2
  /// crease  angle at which faces meet in a crease [degrees]
  SmoothBulges(const Mesh& mesh, const std::vector<Index>& labels, double crease);

  [[nodiscard]] const SmoothSurface& surface() const { return surface_; }
  /// From the middle of an edge's chord to that of the edge [mm].
  [[nodiscard]] const Vec3& bulge(std::size_t edge) const { return ranges_[edge].bulge; }
  /// The change of sections with these bulges.
  [[nodiscard]] SectionChange change() const { return section_change(straight_, curved_); }
  /// Whether an edge belongs to a part that is in doubt.
  [[nodiscard]] bool is_in_doubt(std::size_t edge) const;
  /// Puts the parts in doubt whose sections, with the positions that the vertices got in the end, are farther from
  /// those with all bulges than those with straight edges are, and those where more than a tenth of the edges are held
  /// back: their elements are distorted so much that they bend too little. Parts without a surface of revolution and
  /// without a hollow crease, such as balls, are trusted.
  ///
  /// returns  whether there are any
  bool doubt_failed(const Points& positions);
  /// The middle of an edge of a part in doubt: of the one that may curve either way by most, else of the one that
  /// curves most [mm].
  [[nodiscard]] Vec3 doubtful_place() const;

 private:
  void find_hollow_creases(double crease);
  [[nodiscard]] BulgeRange range_of(std::size_t edge) const;
  [[nodiscard]] bool ends_in_hollow_crease(std::size_t edge) const;
  [[nodiscard]] std::vector<double> volumes(Vec3 BulgeRange::*bulge) const;
  [[nodiscard]] bool may_be_worse(std::size_t part, const std::vector<double>& least,
                                  const std::vector<double>& most) const;
  void judge();

  const Mesh& mesh_;
  SmoothSurface surface_;
  RevolvedSurface revolved_;
  MeshSections sections_;
  std::vector<std::pair<Index, Vec3>> hollow_;  // vertices on creases of hollow angles, ascending, and their direction
  std::vector<BulgeRange> ranges_;              // by edge
  std::vector<double> straight_, curved_;       // volumes of the sections [mm^3]
  std::vector<char> in_doubt_;                  // parts
  std::vector<char> has_profile_;               // parts with surfaces of revolution or with hollow creases
};

}  // namespace softkin
