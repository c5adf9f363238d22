#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <softkin/model/mesh/edge_bulges.hpp>
#include <softkin/model/mesh/given_surface.hpp>
#include <softkin/model/mesh/mesh_order.hpp>

namespace softkin {

namespace {

constexpr double on_surface = 0.02;  // of an edge's length: as near its ends lie on a given surface
constexpr double rounding = 1e-9;    // of an edge's length: a bulge below is none
constexpr double much_doubt = 0.05;  // of an edge's length, between the likely bulge and the largest

/// A given surface that an edge is to lie on, and which of the edge's sides is its.
struct Claim {
  std::size_t surface;
  std::size_t side;
};

class Curving {
 public:
  Curving(Mesh& mesh, const std::vector<Index>& labels, const CurveSpec& spec)
      : mesh_(mesh), spec_(spec), surface_(mesh.vertices, mesh.tetrahedra, labels, spec.crease_degrees) {
    for (const GivenSurface& given : spec.surfaces) projections_.emplace_back(given);
    result_.taken.assign(projections_.size(), 0);
  }

  CurvedEdges run() {
    EdgeBulges bulges(mesh_);
    const EdgeTable nodes(mesh_);
    result_.edges = surface_.edges();
    for (std::size_t e = 0; e < surface_.edges(); ++e) {
      const auto [low, high] = surface_.ends(e);
      const double length = (mesh_.vertices.row(low) - mesh_.vertices.row(high)).norm();
      const Vec3 bulge = bulge_of(e, length);
      if (bulge.norm() > rounding * length)
        bulges.aim(nodes.find(low, high), bulge, Vec3::Zero());
      else
        bulges.aim(nodes.find(low, high), Vec3::Zero(), plane_of(e));
    }
    bulges.go(surface_);
    bulges.describe(result_);
    return result_;
  }

 private:
  /// The normal of the one flat side that an edge lies in; of others 0.
  Vec3 plane_of(std::size_t edge) const {
    const std::vector<SmoothSurface::Side> sides = surface_.sides(edge);
    return sides.size() == 1 && is_flat(sides[0]) ? sides[0].face : Vec3(Vec3::Zero());
  }

  static bool is_flat(const SmoothSurface::Side& side) {
    constexpr double flat = 0.9999;
    return side.low.dot(side.face) >= flat && side.high.dot(side.face) >= flat;
  }

  Vec3 bulge_of(std::size_t edge, double length) {
    const std::vector<SmoothSurface::Side> sides = surface_.sides(edge);
    const std::vector<Claim> claims = claims_on(edge, sides, length);
    if (claims.empty()) return spec_.smooth ? smooth_bulge(edge, length) : Vec3(Vec3::Zero());
    for (const Claim& claim : claims) ++result_.taken[claim.surface];
    return projected(edge, sides, claims, length);
  }

  Vec3 smooth_bulge(std::size_t edge, double length) {
    const SmoothSurface::Bulge bulge = surface_.bulge(edge);
    if ((bulge.most - bulge.likely).norm() > much_doubt * length) {
      const auto [low, high] = surface_.ends(edge);
      result_.undetermined_at = 0.5 * (vertex_at(mesh_.vertices, low) + vertex_at(mesh_.vertices, high));
      ++result_.undetermined;
    }
    return bulge.likely;
  }

  /// Of each side the first given surface that both ends lie on and that is as the side is.
  std::vector<Claim> claims_on(std::size_t edge, const std::vector<SmoothSurface::Side>& sides, double length) const {
    const auto [low, high] = surface_.ends(edge);
    const Vec3 start = vertex_at(mesh_.vertices, low), end = vertex_at(mesh_.vertices, high);
    std::vector<Claim> claims;
    for (std::size_t s = 0; s < sides.size(); ++s)
      for (std::size_t g = 0; g < projections_.size(); ++g) {
        const Projection& given = projections_[g];
        if (!given.foot(start, on_surface * length) || !given.foot(end, on_surface * length)) continue;
        const auto foot = given.foot(0.5 * (start + end), 0.25 * length);
        if (!foot || std::abs(foot->normal.dot(sides[s].face)) < 0.7) continue;
        claims.push_back({g, s});
        break;
      }
    return claims;
  }

  /// The point on all of the surfaces, and in the plane of a side that is flat at both ends.
  Vec3 projected(std::size_t edge, const std::vector<SmoothSurface::Side>& sides, const std::vector<Claim>& claims,
                 double length) const {
    constexpr int most = 100;
    const auto [low, high] = surface_.ends(edge);
    const Vec3 middle = 0.5 * (vertex_at(mesh_.vertices, low) + vertex_at(mesh_.vertices, high));
    Vec3 at = middle, before = at;
    for (int i = 0; i < most; ++i) {
      for (std::size_t s = 0; s < sides.size(); ++s) {
        const bool claimed = std::any_of(claims.begin(), claims.end(), [&](const Claim& c) { return c.side == s; });
        if (claimed || !is_flat(sides[s])) continue;
        at -= (at - middle).dot(sides[s].face) * sides[s].face;
      }
      for (const Claim& claim : claims)
        if (const auto foot = projections_[claim.surface].foot(at, length)) at = foot->point;
      if ((at - before).norm() <= 1e-14 * length) break;
      before = at;
    }
    return at - middle;
  }

  Mesh& mesh_;
  const CurveSpec& spec_;
  SmoothSurface surface_;
  std::vector<Projection> projections_;
  CurvedEdges result_;
};

}  // namespace

std::vector<Index> labels_of(const Mesh& mesh, const std::vector<Region>& regions) {
  std::vector<std::vector<Index>> of(mesh.tetrahedra.size());
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r].dimension != 3) continue;
    for (const Index t : regions[r].tetrahedra) of[t].push_back(r);
  }
  std::map<std::vector<Index>, Index> numbers;
  std::vector<Index> labels;
  labels.reserve(of.size());
  for (auto& regions_of : of) {
    sort_unique(regions_of);
    labels.push_back(numbers.emplace(regions_of, static_cast<Index>(numbers.size())).first->second);
  }
  return labels;
}

CurvedEdges curve_edges(Mesh& mesh, const std::vector<Index>& labels, const CurveSpec& spec) {
  return Curving(mesh, labels, spec).run();
}

SmoothBulges smooth_bulges(const Mesh& mesh, const std::vector<Index>& labels, double crease_degrees) {
  const SmoothSurface surface(mesh.vertices, mesh.tetrahedra, labels, crease_degrees);
  const EdgeTable nodes(mesh);
  const Points none = Points::Zero(mesh.vertices.rows(), 3);
  SmoothBulges bulges{none, none, false};
  for (std::size_t e = 0; e < surface.edges(); ++e) {
    const auto [low, high] = surface.ends(e);
    const Index node = nodes.find(low, high);
    const SmoothSurface::Bulge bulge = surface.bulge(e);
    bulges.likely.row(node) = bulge.likely.transpose();
    bulges.most.row(node) = bulge.most.transpose();
    bulges.hollow_crease = bulges.hollow_crease || surface.is_hollow_crease(e);
  }
  return bulges;
}

double largest_bulge(const Mesh& mesh) {
  double largest = 0;
  for (const auto& [low, high, node] : edges_with_nodes(mesh)) {
    const Eigen::RowVector3d start = mesh.vertices.row(low), end = mesh.vertices.row(high);
    const double length = (end - start).norm();
    if (length > 0) largest = std::max(largest, (mesh.vertices.row(node) - 0.5 * (start + end)).norm() / length);
  }
  return largest;
}

}  // namespace softkin
