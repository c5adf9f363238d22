#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// The surface that the faces of a mesh approximate: smooth except at creases, through the mesh's vertices.
///
/// Faces are those of one element and those between elements of different labels. Two faces at an edge belong to one
/// smooth sheet where the angle between their normals is at most the crease angle. Flat faces, those around a vertex
/// with all faces in one plane, are an exception: between two of these any angle above 2 degrees is a crease, between
/// one of these and another face any above 25. So chamfers and flat sides are preserved.
class SmoothSurface {
 public:
  /// labels  of the tetrahedra: the boundary between two labels is a surface too
  /// crease  angle [degrees]
  SmoothSurface(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra, const std::vector<Index>& labels,
                double crease);

  /// The edges of the faces, by ascending ends.
  [[nodiscard]] std::size_t edges() const { return edge_starts_.size() - 1; }
  /// Its ends, ascending.
  [[nodiscard]] std::array<Index, 2> ends(std::size_t edge) const;

  /// From the middle of a chord to that of the edge on the smooth surface [mm].
  ///
  /// likely  on an arc whose curvature is the harmonic mean of those by the surface's tangents at both ends; 0 where
  ///         they differ in sign, as where a groove of few elements meets its rim
  /// most    by the larger one of both curvatures; far from the likely one where the mesh is too coarse
  struct Bulge {
    Vec3 likely{0, 0, 0}, most{0, 0, 0};
  };
  /// On a crease tangents are those of the two sheets' intersection. 0 where nothing curves.
  ///
  /// source  the mean: F. N. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic
  ///         interpolants, 1984
  [[nodiscard]] Bulge bulge(std::size_t edge) const;
  /// Is it a crease of the body's surface into the body, as at the bottom of a notch or of a groove of two elements?
  [[nodiscard]] bool is_hollow_crease(std::size_t edge) const;
  /// The same of an edge through the inside, or across a side, whose ends both lie on sheets that are nearly parallel,
  /// as on both sides of a thin wall; of several the largest, of none 0.
  [[nodiscard]] Vec3 inner_bulge(Index a, Index b) const;

  /// One sheet at an edge: the normals of its faces there and the smooth normals at the ends, by ascending ends.
  struct Side {
    Vec3 face, low, high;
  };
  /// The sheets that meet at an edge: one where it is smooth.
  [[nodiscard]] std::vector<Side> sides(std::size_t edge) const;

 private:
  // Half edge and corner 3 f + i are those of face f at its i-th vertex: the edge leads to the next vertex.
  struct Half {
    Index low, high, id;
  };
  /// The corners of one sheet at one vertex.
  struct Sector {
    std::size_t begin = 0, end = 0;  // in around_
    bool closed = false;             // all around the vertex
    Vec3 normal{0, 0, 0};            // as that of its first corner's face
  };

  [[nodiscard]] Index vertex_of(Index corner) const { return faces_[corner / 3][corner % 3]; }
  [[nodiscard]] Vec3 normal_at(Index corner) const { return sign_[corner] * sectors_[sector_[corner]].normal; }
  [[nodiscard]] Index corner_at(Index face, Index vertex) const;
  [[nodiscard]] double turned(Index half, Index other) const;  // 1: the faces' normals agree, -1: they do not
  void find_faces(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Index>& labels);
  void find_edges();
  void pair_halves(double crease);
  void find_sectors();
  void spread_sector(Index first);
  void find_flat_faces();
  void part_flat_faces();
  void find_normals();
  [[nodiscard]] Vec3 mean_normal(const Sector& sector) const;
  [[nodiscard]] Vec3 fitted_normal(const Sector& sector, const Vec3& mean) const;
  [[nodiscard]] std::vector<Index> neighbours(const Sector& sector) const;

  const Points& vertices_;
  std::vector<Triangle> faces_;
  std::vector<Vec3> normals_;
  std::vector<bool> outer_;  // of faces: of one element
  std::vector<bool> flat_;   // of faces
  std::vector<Half> halves_;
  std::vector<std::size_t> edge_starts_;  // in halves_, and the end
  std::vector<Index> partner_;            // of half edges: the one of the same sheet, or -1
  std::vector<Index> sector_;             // of corners
  std::vector<double> sign_;              // of corners: their face's normal against the sector's
  std::vector<Sector> sectors_;
  std::vector<Index> around_;                                     // corners by sectors
  std::vector<std::pair<Index, std::size_t>> sectors_of_vertex_;  // ascending
};

}  // namespace softkin
