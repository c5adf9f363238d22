#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/smooth_bulges.hpp>

namespace softkin {

namespace {

constexpr double least_section = 0.03;   // of the volume of a part: of a section that counts
constexpr double no_change = 0.005;      // of a section
constexpr double small_change = 0.02;    // of a section, whose nodes are held back
constexpr double most_held = 0.1;        // of the edges that curve: more are held back where elements become stiff
constexpr double farthest_bulge = 0.24;  // of an edge's length, as curve_edges() moves a node

/// Whether a true change between both limits may be nearer to none than to the change that was found.
bool may_be_nearer_to_none(double found, double least, double most, double direction, double small) {
  const double sign = std::abs(found) > small ? found : direction;
  return sign > 0 ? least < 0.5 * found - small : most > 0.5 * found + small;
}

}  // namespace

SectionChange section_change(const std::vector<double>& before, const std::vector<double>& after) {
  SectionChange change;
  for (std::size_t first = 0; first < before.size(); first += MeshSections::per_part) {
    double whole = 0;
    for (std::size_t s = first; s < first + MeshSections::per_part; ++s) whole += before[s];
    for (std::size_t s = first; s < first + MeshSections::per_part; ++s) {
      if (!(before[s] > least_section * whole)) continue;
      change.least = std::min(change.least, after[s] / before[s] - 1);
      change.most = std::max(change.most, after[s] / before[s] - 1);
    }
  }
  return change;
}

SmoothBulges::SmoothBulges(const Mesh& mesh, const std::vector<Index>& labels, double crease)
    : mesh_(mesh),
      surface_(mesh.vertices, mesh.tetrahedra, labels, crease),
      revolved_(mesh.vertices, surface_, crease),
      sections_(mesh) {
  find_hollow_creases(crease);
  ranges_.reserve(surface_.edges());
  has_profile_.assign(sections_.parts(), 0);
  for (std::size_t e = 0; e < surface_.edges(); ++e) {
    BulgeRange range = range_of(e);
    if (range.determined) range.inward = range.outward = range.bulge;
    const auto [low, high] = surface_.ends(e);
    if (!range.determined || revolved_.bulge(e) || ends_in_hollow_crease(e)) has_profile_[sections_.part_of(low)] = 1;
    const double most = farthest_bulge * (mesh.vertices.row(high) - mesh.vertices.row(low)).norm();
    for (Vec3 BulgeRange::*bulge : {&BulgeRange::bulge, &BulgeRange::inward, &BulgeRange::outward})
      if (Vec3& one = range.*bulge; one.norm() > most) one *= most / one.norm();
    ranges_.push_back(range);
  }
  judge();
}

void SmoothBulges::find_hollow_creases(double crease) {
  constexpr double sharpest = 100;  // degrees: at a larger angle there is a corner, whatever is beside it
  const double most = std::cos(crease * std::numbers::pi / 180), least = std::cos(sharpest * std::numbers::pi / 180);
  for (std::size_t e = 0; e < surface_.edges(); ++e) {
    const auto turns = surface_.turns_at(e);
    if (turns.size() != 1 || turns[0].cosine > most || turns[0].cosine < least) continue;
    const auto [low, high] = surface_.ends(e);
    const Vec3 start = vertex_at(mesh_.vertices, low);
    double height = 0;  // of the other face over the plane of the one
    for (const Index v : surface_.faces()[turns[0].other])
      height += (vertex_at(mesh_.vertices, v) - start).dot(surface_.face_normal(turns[0].face));
    if (!(height > 0)) continue;
    const Vec3 along = (vertex_at(mesh_.vertices, high) - start).normalized();
    hollow_.emplace_back(low, along);
    hollow_.emplace_back(high, along);
  }
  std::sort(hollow_.begin(), hollow_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

/// Whether an edge leads to a crease of a hollow angle that runs across it.
bool SmoothBulges::ends_in_hollow_crease(std::size_t edge) const {
  constexpr double across = 0.7;
  const auto [low, high] = surface_.ends(edge);
  const Vec3 along = (vertex_at(mesh_.vertices, high) - vertex_at(mesh_.vertices, low)).normalized();
  for (const Index v : {low, high})
    for (auto at = std::lower_bound(hollow_.begin(), hollow_.end(), v,
                                    [](const auto&crease, Index vertex) { return crease.first < vertex; });
         at != hollow_.end() && at->first == v; ++at)
      if (std::abs(at->second.dot(along)) < across) return true;
  return false;
}

/// A surface that seems full between a hollow crease and its other neighbour may as well be the wall of a notch, or the
/// half of a hollow groove.
BulgeRange SmoothBulges::range_of(std::size_t edge) const {
  if (auto range = revolved_.bulge(edge)) return *range;
  const Vec3 bulge = surface_.bulge(edge);
  Vec3 normal = Vec3::Zero();
  for (const Index f : surface_.faces_at(edge)) normal += surface_.face_normal(f);
  if (bulge.isZero(0) || normal.dot(bulge) <= 0 || !ends_in_hollow_crease(edge))
    return {bulge, true, Vec3::Zero(), Vec3::Zero()};
  return {Vec3::Zero(), false, -bulge, bulge};
}

/// Volumes of the sections where each edge of the surface has this bulge and the others are straight; without: all.
std::vector<double> SmoothBulges::volumes(Vec3 BulgeRange::*bulge) const {
  Points positions = mesh_.vertices;
  const EdgeTable nodes(mesh_);
  for (const auto& [low, high, node] : edges_with_nodes(mesh_))
    positions.row(node) = 0.5 * (mesh_.vertices.row(low) + mesh_.vertices.row(high));
  if (bulge)
    for (std::size_t e = 0; e < surface_.edges(); ++e) {
      const auto [low, high] = surface_.ends(e);
      positions.row(nodes.find(low, high)) += (ranges_[e].*bulge).transpose();
    }
  return sections_.volumes(positions);
}

bool SmoothBulges::may_be_worse(std::size_t part, const std::vector<double>& least,
                                const std::vector<double>& most) const {
  double whole = 0, found = 0, lowest = 0, highest = 0;
  const std::size_t first = part * MeshSections::per_part, last = first + MeshSections::per_part;
  for (std::size_t s = first; s < last; ++s) {
    whole += straight_[s];
    found += curved_[s] - straight_[s];
    lowest += least[s] - straight_[s];
    highest += most[s] - straight_[s];
  }
  if (may_be_nearer_to_none(found, lowest, highest, found, 0.1 * no_change * whole)) return true;
  for (std::size_t s = first; s < last; ++s) {
    const double own = straight_[s];
    if (own > least_section * whole &&
        may_be_nearer_to_none(curved_[s] - own, least[s] - own, most[s] - own, found, no_change * own))
      return true;
  }
  return false;
}

void SmoothBulges::judge() {
  straight_ = volumes(nullptr);
  curved_ = volumes(&BulgeRange::bulge);
  in_doubt_.assign(sections_.parts(), 0);
  if (std::all_of(ranges_.begin(), ranges_.end(), [](const BulgeRange& range) { return range.determined; })) return;
  std::vector<double> least = volumes(&BulgeRange::inward), most = volumes(&BulgeRange::outward);
  for (std::size_t s = 0; s < least.size(); ++s) {
    least[s] = std::min(least[s], curved_[s]);
    most[s] = std::max(most[s], curved_[s]);
  }
  for (std::size_t part = 0; part < in_doubt_.size(); ++part) in_doubt_[part] = may_be_worse(part, least, most);
}

bool SmoothBulges::doubt_failed(const Points& positions) {
  const std::vector<double> reached = sections_.volumes(positions);
  std::vector<std::size_t> curved(in_doubt_.size(), 0), held(in_doubt_.size(), 0);  // edges
  const EdgeTable nodes(mesh_);
  for (std::size_t e = 0; e < ranges_.size(); ++e) {
    const Vec3& bulge = ranges_[e].bulge;
    const auto [low, high] = surface_.ends(e);
    const Vec3 middle = 0.5 * (vertex_at(positions, low) + vertex_at(positions, high));
    if (bulge.norm() <= 1e-9 * (mesh_.vertices.row(low) - mesh_.vertices.row(high)).norm()) continue;
    const std::size_t part = sections_.part_of(low);
    ++curved[part];
    if ((vertex_at(positions, nodes.find(low, high)) - middle - bulge).norm() > 1e-6 * bulge.norm()) ++held[part];
  }
  bool any = false;
  for (std::size_t part = 0; part < in_doubt_.size(); ++part) {
    if (in_doubt_[part] || !has_profile_[part]) continue;
    double whole = 0, missing = 0, wanted = 0;
    bool failed = static_cast<double>(held[part]) > most_held * static_cast<double>(curved[part]);
    const std::size_t first = part * MeshSections::per_part, last = first + MeshSections::per_part;
    for (std::size_t s = first; s < last; ++s) whole += straight_[s];
    for (std::size_t s = first; s < last; ++s) {
      const double left = curved_[s] - reached[s], change = curved_[s] - straight_[s];
      missing += left;
      wanted += change;
      if (straight_[s] > least_section * whole && std::abs(left) > std::abs(change) + small_change * straight_[s])
        failed = true;
    }
    if (std::abs(missing) > 0.7 * std::abs(wanted) + 1e-6 * whole) failed = true;
    in_doubt_[part] = failed;
    any = any || failed;
  }
  return any;
}

bool SmoothBulges::is_in_doubt(std::size_t edge) const {
  return in_doubt_[sections_.part_of(surface_.ends(edge)[0])];
}

Vec3 SmoothBulges::doubtful_place() const {
  std::pair<double, double> largest(-1, -1);
  Vec3 place = Vec3::Zero();
  for (std::size_t e = 0; e < ranges_.size(); ++e) {
    const std::pair size((ranges_[e].outward - ranges_[e].inward).norm(), ranges_[e].bulge.norm());
    if (!is_in_doubt(e) || size <= largest) continue;
    const auto [low, high] = surface_.ends(e);
    largest = size;
    place = 0.5 * (vertex_at(mesh_.vertices, low) + vertex_at(mesh_.vertices, high));
  }
  return place;
}

}  // namespace softkin
