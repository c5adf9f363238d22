#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/smooth_surface.hpp>

namespace softkin {

namespace {

constexpr double radians = std::numbers::pi / 180;
const double flat_cosine = std::cos(0.5 * radians);     // within this faces are of one plane
const double flat_crease = std::cos(2 * radians);       // more is a crease between flat faces,
const double flat_to_round = std::cos(25 * radians);    // and between a flat one and another
const double parallel_sheets = std::cos(45 * radians);  // both sides of a wall
constexpr double min_turn = 0.5;                        // cosine of 60 degrees, of a tangent against its chord
constexpr double min_crossing = 0.17;                   // sine of the angle at which sheets cross in a line

/// Direction of a curve at the end of a chord: along one sheet or, where the other is given, where the two intersect.
Vec3 tangent(const Vec3& chord, const Vec3& normal, const Vec3* other) {
  Vec3 along = chord - chord.dot(normal) * normal;
  if (other) {
    const Vec3 line = normal.cross(*other);
    if (line.norm() > min_crossing) along = line.dot(chord) < 0 ? Vec3(-line) : line;
  }
  const double length = along.norm();
  return along.dot(chord) >= min_turn * length && length > 0 ? Vec3(along / length) : chord;
}

/// From the middle of a chord to that of an arc with these tangents at its ends: c / 4 (tan(a / 2) + tan(b / 2)) for
/// the angles a and b in the plane in which the surface turns, and the chord's extent c in it; exact for circles and,
/// where the chord runs aslant to that plane, for cylinders. In place of the mean of both ends is their harmonic one.
///
/// in_plane  the chord's extent in the plane over its length
SmoothSurface::Bulge arc_bulge(const Vec3& chord, const Vec3& at_start, const Vec3& at_end, double in_plane) {
  const double length = chord.norm();
  const Vec3 along = chord / length;
  const auto across = [&](const Vec3& t) {
    const Vec3 rise = t - t.dot(along) * along;
    return Vec3(length / 2 * rise / (1 + std::sqrt(std::max(0.25, 1 - rise.squaredNorm() / (in_plane * in_plane)))));
  };
  const Vec3 start = across(at_start), end = -across(at_end);
  const double a = start.norm(), b = end.norm();
  const bool one_sided = start.dot(end) > 0;
  return {one_sided ? Vec3((b * start + a * end) / (a + b)) : Vec3(Vec3::Zero()), a > b ? start : end};
}

/// The arc between two places of one sheet with these normals.
SmoothSurface::Bulge sheet_bulge(const Vec3& chord, const Vec3& at_start, const Vec3& at_end) {
  constexpr double min_turning = 0.02, min_fraction = 0.3;
  const Vec3 along = chord.normalized(), axis = at_start.cross(at_end);
  double in_plane = 1;
  if (axis.norm() > min_turning) in_plane = std::max(min_fraction, axis.normalized().cross(along).norm());
  return arc_bulge(chord, tangent(along, at_start, nullptr), tangent(along, at_end, nullptr), in_plane);
}

}  // namespace

SmoothSurface::SmoothSurface(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                             const std::vector<Index>& labels, double crease)
    : vertices_(vertices) {
  find_faces(tetrahedra, labels);
  find_edges();
  pair_halves(std::cos(crease * radians));
  find_sectors();
  find_flat_faces();
  part_flat_faces();
  find_sectors();
  find_normals();
}

void SmoothSurface::find_faces(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Index>& labels) {
  ElementFaces all = faces_of(tetrahedra, {});
  visit_same_faces(all.triangles, [&](const ElementFace<3>* begin, const ElementFace<3>* end) {
    if (end > begin + 1 && labels[begin->owner] == labels[(begin + 1)->owner]) return;
    const auto& [a, b, c] = begin->vertices;
    const Vec3 at = vertex_at(vertices_, a);
    const Vec3 normal = (vertex_at(vertices_, b) - at).cross(vertex_at(vertices_, c) - at);
    if (!(normal.norm() > 0)) return;
    faces_.push_back(begin->vertices);
    normals_.push_back(normal.normalized());
    outer_.push_back(end == begin + 1);
  });
}

void SmoothSurface::find_edges() {
  halves_.reserve(3 * faces_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(faces_[f][i], faces_[f][(i + 1) % 3]);
      halves_.push_back({low, high, static_cast<Index>(3 * f) + i});
    }
  const auto key = [](const Half& h) { return std::tuple(h.low, h.high, h.id); };
  std::sort(halves_.begin(), halves_.end(), [&](const Half& a, const Half& b) { return key(a) < key(b); });
  for (std::size_t h = 0; h < halves_.size(); ++h)
    if (h == 0 || halves_[h].low != halves_[h - 1].low || halves_[h].high != halves_[h - 1].high)
      edge_starts_.push_back(h);
  edge_starts_.push_back(halves_.size());
}

std::array<Index, 2> SmoothSurface::ends(std::size_t edge) const {
  const Half& half = halves_[edge_starts_[edge]];
  return {half.low, half.high};
}

double SmoothSurface::turned(Index half, Index other) const {
  return vertex_of(half) == vertex_of(other) ? -1 : 1;  // neighbours that agree pass their edge in opposite directions
}

/// Pairs each half edge with the one at the smallest angle, if that is mutual.
void SmoothSurface::pair_halves(double crease) {
  partner_.assign(halves_.size(), -1);
  for (std::size_t e = 0; e < edges(); ++e) {
    const std::size_t begin = edge_starts_[e], end = edge_starts_[e + 1];
    const auto best_of = [&](std::size_t h) {
      std::size_t best = end;
      double most = crease;
      for (std::size_t other = begin; other < end; ++other) {
        if (other == h) continue;
        const Index a = halves_[h].id, b = halves_[other].id;
        const double cosine = turned(a, b) * normals_[a / 3].dot(normals_[b / 3]);
        if (cosine >= most && (best == end || cosine > most)) {
          best = other;
          most = cosine;
        }
      }
      return best;
    };
    for (std::size_t h = begin; h < end; ++h)
      if (const std::size_t best = best_of(h); best < end && best_of(best) == h)
        partner_[halves_[h].id] = halves_[best].id;
  }
}

Index SmoothSurface::corner_at(Index face, Index vertex) const {
  const Triangle& corners = faces_[face];
  return 3 * face + (corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2);
}

void SmoothSurface::find_sectors() {
  sectors_.clear();
  around_.clear();
  sectors_of_vertex_.clear();
  sector_.assign(halves_.size(), -1);
  sign_.assign(halves_.size(), 1);
  for (Index corner = 0; corner < std::ssize(halves_); ++corner)
    if (sector_[corner] < 0) spread_sector(corner);
  std::sort(sectors_of_vertex_.begin(), sectors_of_vertex_.end());
}

void SmoothSurface::spread_sector(Index first) {
  const Index number = sectors_.size();
  const Index vertex = vertex_of(first);
  Sector sector{around_.size(), around_.size(), true};
  sector_[first] = number;
  around_.push_back(first);
  for (std::size_t at = sector.begin; at < around_.size(); ++at) {
    const Index corner = around_[at], face = corner / 3;
    for (const Index half : {corner, 3 * face + (corner % 3 + 2) % 3}) {
      const Index other = partner_[half];
      if (other < 0) {
        sector.closed = false;
        continue;
      }
      const Index next = corner_at(other / 3, vertex);
      if (sector_[next] >= 0) continue;
      sector_[next] = number;
      sign_[next] = sign_[corner] * turned(half, other);
      around_.push_back(next);
    }
  }
  sector.end = around_.size();
  sectors_of_vertex_.emplace_back(vertex, sectors_.size());
  sectors_.push_back(sector);
}

/// Finds the faces around a vertex with all faces in one plane, and those that continue them in their plane.
void SmoothSurface::find_flat_faces() {
  flat_.assign(faces_.size(), false);
  std::vector<Index> reached;
  for (const Sector& sector : sectors_) {
    if (!sector.closed) continue;
    const Vec3& first = normals_[around_[sector.begin] / 3];
    bool flat = true;
    for (std::size_t at = sector.begin; at < sector.end && flat; ++at)
      flat = sign_[around_[at]] * normals_[around_[at] / 3].dot(first) >= flat_cosine;
    for (std::size_t at = sector.begin; at < sector.end && flat; ++at)
      if (const Index face = around_[at] / 3; !flat_[face]) {
        flat_[face] = true;
        reached.push_back(face);
      }
  }
  for (std::size_t at = 0; at < reached.size(); ++at)
    for (int i = 0; i < 3; ++i) {
      const Index half = 3 * reached[at] + i, other = partner_[half];
      if (other < 0 || flat_[other / 3]) continue;
      if (turned(half, other) * normals_[half / 3].dot(normals_[other / 3]) < flat_cosine) continue;
      flat_[other / 3] = true;
      reached.push_back(other / 3);
    }
}

void SmoothSurface::part_flat_faces() {
  for (Index half = 0; half < std::ssize(halves_); ++half) {
    const Index other = partner_[half];
    if (other < 0 || !(flat_[half / 3] || flat_[other / 3])) continue;
    const double least = flat_[half / 3] && flat_[other / 3] ? flat_crease : flat_to_round;
    if (turned(half, other) * normals_[half / 3].dot(normals_[other / 3]) < least)
      partner_[half] = partner_[other] = -1;
  }
}

void SmoothSurface::find_normals() {
  for (Sector& sector : sectors_) {
    Vec3 flat = Vec3::Zero();
    for (std::size_t at = sector.begin; at < sector.end; ++at)
      if (const Index face = around_[at] / 3; flat_[face]) flat += sign_[around_[at]] * normals_[face];
    if (flat.norm() > 1e-3) {
      sector.normal = flat.normalized();
      continue;
    }
    const Vec3 mean = mean_normal(sector);
    sector.normal = fitted_normal(sector, mean);
  }
}

/// source  N. Max, Weights for computing vertex normals from facet normals, 1999: exact on a sphere
Vec3 SmoothSurface::mean_normal(const Sector& sector) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t at = sector.begin; at < sector.end; ++at) {
    const Index corner = around_[at];
    const Triangle& face = faces_[corner / 3];
    const int i = static_cast<int>(corner % 3);
    const Vec3 here = vertex_at(vertices_, face[i]);
    const Vec3 u = vertex_at(vertices_, face[(i + 1) % 3]) - here, v = vertex_at(vertices_, face[(i + 2) % 3]) - here;
    sum += sign_[corner] / (u.squaredNorm() * v.squaredNorm()) * u.cross(v);
  }
  return sum.norm() > 0 ? Vec3(sum.normalized()) : normals_[around_[sector.begin] / 3];
}

/// The vertices of the sheet near a sector's: its neighbours, and those of these where they are few or on one side.
std::vector<Index> SmoothSurface::neighbours(const Sector& sector) const {
  constexpr std::size_t enough = 6;
  std::vector<Index> found;
  for (std::size_t at = sector.begin; at < sector.end; ++at) {
    const Triangle& face = faces_[around_[at] / 3];
    found.insert(found.end(), face.begin(), face.end());
  }
  sort_unique(found);
  if (sector.closed && found.size() > enough) return found;
  for (std::size_t at = sector.begin; at < sector.end; ++at)
    for (int i = 0; i < 3; ++i) {
      const Sector& next = sectors_[sector_[3 * (around_[at] / 3) + i]];
      for (std::size_t a = next.begin; a < next.end; ++a) {
        const Triangle& face = faces_[around_[a] / 3];
        found.insert(found.end(), face.begin(), face.end());
      }
    }
  sort_unique(found);
  return found;
}

/// Returns the normal of the paraboloid a x + b y + c x^2 + d x y + e y^2 through the vertex that fits its neighbours
/// best, over the plane of the mean normal; where they do not determine it, the one of minimum norm.
///
/// source  F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting of osculating jets, 2005
Vec3 SmoothSurface::fitted_normal(const Sector& sector, const Vec3& mean) const {
  constexpr double steepest = 0.58;  // tan 30 degrees: such a fit is none
  const Index vertex = vertex_of(around_[sector.begin]);
  const Vec3 here = vertex_at(vertices_, vertex);
  const Vec3 u = mean.unitOrthogonal(), v = mean.cross(u);
  const std::vector<Index> near = neighbours(sector);
  if (near.size() < 4) return mean;
  double size = 0;
  for (const Index other : near) size += (vertex_at(vertices_, other) - here).norm();
  size /= static_cast<double>(near.size() - 1);
  Eigen::Matrix<double, Eigen::Dynamic, 5> rows(near.size(), 5);
  Eigen::VectorXd heights(rows.rows());
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Vec3 offset = (vertex_at(vertices_, near[i]) - here) / size;
    const double x = offset.dot(u), y = offset.dot(v), distance2 = offset.squaredNorm();
    const double weight = distance2 > 0 ? 1 / distance2 : 0;
    rows.row(i) << weight * x, weight * y, weight * x * x, weight * x * y, weight * y * y;
    heights[i] = weight * offset.dot(mean);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(0.02);
  const Eigen::VectorXd fit = solver.compute(rows).solve(heights);
  if (!(std::hypot(fit[0], fit[1]) < steepest)) return mean;
  const Vec3 normal = (mean - fit[0] * u - fit[1] * v).normalized();
  for (std::size_t at = sector.begin; at < sector.end; ++at)
    if (sign_[around_[at]] * normals_[around_[at] / 3].dot(normal) < min_turn) return mean;
  return normal;
}

std::vector<SmoothSurface::Side> SmoothSurface::sides(std::size_t edge) const {
  std::vector<Side> sides;
  const auto [low, high] = ends(edge);
  for (std::size_t h = edge_starts_[edge]; h < edge_starts_[edge + 1]; ++h) {
    const Index half = halves_[h].id, other = partner_[half];
    if (other >= 0 && other < half) continue;
    Vec3 face = normals_[half / 3];
    if (other >= 0) face = (face + turned(half, other) * normals_[other / 3]).normalized();
    sides.push_back({face, normal_at(corner_at(half / 3, low)), normal_at(corner_at(half / 3, high))});
  }
  return sides;
}

SmoothSurface::Bulge SmoothSurface::bulge(std::size_t edge) const {
  const auto [low, high] = ends(edge);
  const Vec3 chord = vertex_at(vertices_, high) - vertex_at(vertices_, low);
  if (!(chord.norm() > 0)) return {};
  const std::vector<Side> found = sides(edge);
  if (edge_starts_[edge + 1] == edge_starts_[edge] + 1) return {};  // of one face: it is not determined
  const Side& one = found[0];
  const Side* other = nullptr;  // of several the one that crosses most
  for (std::size_t s = 1; s < found.size(); ++s)
    if (!other || found[s].face.cross(one.face).norm() > other->face.cross(one.face).norm()) other = &found[s];
  if (!other) return sheet_bulge(chord, one.low, one.high);
  const Vec3 along = chord.normalized();
  return arc_bulge(chord, tangent(along, one.low, &other->low), tangent(along, one.high, &other->high), 1);
}

bool SmoothSurface::is_hollow_crease(std::size_t edge) const {
  const std::size_t begin = edge_starts_[edge];
  if (edge_starts_[edge + 1] != begin + 2) return false;
  const Index half = halves_[begin].id, other = halves_[begin + 1].id;
  if (partner_[half] >= 0 || !outer_[half / 3] || !outer_[other / 3]) return false;
  const Index apex = faces_[other / 3][(other % 3 + 2) % 3];
  return (vertex_at(vertices_, apex) - vertex_at(vertices_, vertex_of(half))).dot(normals_[half / 3]) > 0;
}

Vec3 SmoothSurface::inner_bulge(Index a, Index b) const {
  const auto first_of = [&](Index vertex) {
    return std::lower_bound(sectors_of_vertex_.begin(), sectors_of_vertex_.end(), std::pair(vertex, std::size_t{0}));
  };
  const Vec3 chord = vertex_at(vertices_, b) - vertex_at(vertices_, a);
  if (!(chord.norm() > 0)) return Vec3::Zero();
  Vec3 largest = Vec3::Zero();
  for (auto i = first_of(a); i != sectors_of_vertex_.end() && i->first == a; ++i)
    for (auto j = first_of(b); j != sectors_of_vertex_.end() && j->first == b; ++j) {
      const Vec3 &at_a = sectors_[i->second].normal, &at_b = sectors_[j->second].normal;
      if (std::abs(at_a.dot(at_b)) < parallel_sheets) continue;
      const Vec3 bulge = sheet_bulge(chord, at_a, at_b).likely;
      if (bulge.squaredNorm() > largest.squaredNorm()) largest = bulge;
    }
  return largest;
}

}  // namespace softkin
