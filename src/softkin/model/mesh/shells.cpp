#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/disjoint_sets.hpp>
#include <softkin/model/mesh/shells.hpp>

namespace softkin {

namespace {

/// An edge of a triangle: its ends, ascending, and whether the triangle passes it in that sense.
struct Side {
  Index low, high, triangle;
  bool ascending;
};

std::vector<Side> sides_of(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const Index a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t), a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

/// Calls visit(begin, end) for the sides at each edge.
template <class Visit>
void visit_edges(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    visit(sides.data() + i, sides.data() + j);
  }
}

bool is_flat(const Shell& shell) {
  return !(std::abs(shell.volume) > 1e-12 * std::pow(shell.bounds.diagonal().norm(), 3));
}

void measure(const Points& vertices, const std::vector<Triangle>& triangles, Shell& shell) {
  const Vec3 origin = vertex_at(vertices, triangles[shell.triangles[0]][0]);
  Vec3 moment = Vec3::Zero(), sum = Vec3::Zero();
  for (const Index t : shell.triangles) {
    Vec3 p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = vertex_at(vertices, triangles[t][i]);
      shell.bounds.extend(p[i]);
      p[i] -= origin;
      sum += p[i] / 3;
    }
    const double volume = p[0].dot(p[1].cross(p[2])) / 6;
    shell.volume += volume;
    moment += volume / 4 * (p[0] + p[1] + p[2]);
  }
  shell.center = origin + (shell.closed && !is_flat(shell) ? Vec3(moment / shell.volume)
                                                           : Vec3(sum / double(shell.triangles.size())));
}

std::string place(const Vec3& point) {
  return "at " + point_text(point) + " mm";
}

/// For each triangle whether it must be turned to agree with the first of its piece.
std::vector<bool> to_turn(const Points& vertices, const std::vector<Triangle>& triangles,
                          const std::vector<Side>& sides) {
  std::vector<std::array<std::pair<Index, bool>, 3>> neighbours(triangles.size());  // and whether it disagrees
  std::vector<int> count(triangles.size());
  visit_edges(sides, [&](const Side* begin, const Side* end) {
    if (end != begin + 2) return;  // a rim
    const bool disagree = begin[0].ascending == begin[1].ascending;
    for (int i = 0; i < 2; ++i)
      neighbours[begin[i].triangle][count[begin[i].triangle]++] = {begin[1 - i].triangle, disagree};
  });
  std::vector<bool> turn(triangles.size()), seen(triangles.size());
  std::vector<Index> next;
  for (std::size_t first = 0; first < triangles.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = true;
    next.push_back(first);
    while (!next.empty()) {
      const Index t = next.back();
      next.pop_back();
      for (int i = 0; i < count[t]; ++i) {
        const auto [other, disagree] = neighbours[t][i];
        const bool wanted = turn[t] != disagree;
        if (seen[other] && turn[other] != wanted)
          throw InvalidInput("the surface has one side only, " + place(vertex_at(vertices, triangles[t][0])));
        if (seen[other]) continue;
        seen[other] = true;
        turn[other] = wanted;
        next.push_back(other);
      }
    }
  }
  return turn;
}

void refuse_rims(const Points& vertices, const std::vector<Side>& sides, bool may_be_open) {
  std::size_t rim = 0;
  Vec3 middle = Vec3::Zero();
  visit_edges(sides, [&](const Side* begin, const Side* end) {
    const Vec3 at = 0.5 * (vertex_at(vertices, begin->low) + vertex_at(vertices, begin->high));
    if (end == begin + 1) {
      ++rim;
      middle += at;
    } else if (end > begin + 2) {
      throw InvalidInput("the surface has an edge of " + std::to_string(end - begin) + " faces " + place(at));
    }
  });
  if (rim > 0 && !may_be_open)
    throw InvalidInput("the surface is not closed: its rim of " + counted(rim, "edge") + " has its middle " +
                       place(middle / static_cast<double>(rim)));
}

}  // namespace

std::vector<Shell> shells_of(const Points& vertices, const std::vector<Triangle>& triangles) {
  const std::vector<Side> sides = sides_of(triangles);
  DisjointSets sets(triangles.size());
  visit_edges(sides, [&](const Side* begin, const Side* end) {
    if (end == begin + 2) sets.join(begin[0].triangle, begin[1].triangle);
  });
  std::vector<Index> shell_at(triangles.size(), -1);
  std::vector<Shell> shells;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Index& shell = shell_at[sets.find(t)];
    if (shell < 0) {
      shell = shells.size();
      shells.emplace_back();
    }
    shells[shell].triangles.push_back(t);
  }
  visit_edges(sides, [&](const Side* begin, const Side* end) {
    for (const Side* side = begin; side != end; ++side) {
      const Index root = sets.find(side->triangle);
      int balance = 0;
      for (const Side* other = begin; other != end; ++other)
        if (sets.find(other->triangle) == root) balance += other->ascending ? 1 : -1;
      if (balance != 0) shells[shell_at[root]].closed = false;
    }
  });
  for (Shell& shell : shells) measure(vertices, triangles, shell);
  return shells;
}

namespace {

std::vector<Triangle> alike(const Points& vertices, std::vector<Triangle> triangles, bool may_be_open) {
  if (triangles.empty()) throw InvalidInput("the surface has no triangle");
  for (const Triangle& t : triangles)
    for (const Index v : t)
      if (v < 0 || v >= vertices.rows()) throw InvalidInput("the surface names a vertex that is not there");
  const std::vector<Side> sides = sides_of(triangles);
  refuse_rims(vertices, sides, may_be_open);
  const std::vector<bool> turn = to_turn(vertices, triangles, sides);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (turn[t]) std::swap(triangles[t][1], triangles[t][2]);
  return triangles;
}

std::vector<Triangle> turned(const Points& vertices, std::vector<Triangle> given, bool flat_too) {
  std::vector<Triangle> triangles = alike(vertices, std::move(given), false);
  for (const Shell& shell : shells_of(vertices, triangles)) {
    if (is_flat(shell) && !flat_too) throw InvalidInput("the surface encloses no volume, " + place(shell.center));
    if (is_flat(shell) || shell.volume > 0) continue;
    for (const Index t : shell.triangles) std::swap(triangles[t][1], triangles[t][2]);
  }
  return triangles;
}

}  // namespace

std::vector<Triangle> turned_outwards(const Points& vertices, std::vector<Triangle> triangles) {
  return turned(vertices, std::move(triangles), false);
}

std::vector<Triangle> turned_outwards_or_flat(const Points& vertices, std::vector<Triangle> triangles) {
  return turned(vertices, std::move(triangles), true);
}

std::vector<Triangle> turned_alike(const Points& vertices, std::vector<Triangle> triangles) {
  return alike(vertices, std::move(triangles), true);
}

std::vector<std::array<Index, 2>> rim_of(const std::vector<Triangle>& triangles) {
  std::vector<std::array<Index, 2>> rim;
  visit_edges(sides_of(triangles), [&](const Side* begin, const Side* end) {
    if (end != begin + 1) return;
    if (begin->ascending)
      rim.push_back({begin->low, begin->high});
    else
      rim.push_back({begin->high, begin->low});
  });
  return rim;
}

std::vector<EmptySpace> empty_spaces_in(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                                        const std::vector<Prism>& prisms) {
  std::vector<Index> owners;
  std::vector<Triangle> triangles = triangulated(boundary_of(tetrahedra, prisms), &owners);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::size_t owner = owners[t];
    const double volume = owner < tetrahedra.size() ? signed_volume(vertices, tetrahedra[owner])
                                                    : signed_volume(vertices, prisms[owner - tetrahedra.size()]);
    if (volume > 0) std::swap(triangles[t][1], triangles[t][2]);  // into the body, out of what is empty
  }
  std::vector<EmptySpace> spaces;
  for (const Shell& shell : shells_of(vertices, triangles)) {
    if (!shell.closed || !(shell.volume > 0)) continue;
    EmptySpace space{{}, shell.volume, shell.center, shell.bounds};
    for (const Index t : shell.triangles) space.triangles.push_back(triangles[t]);
    spaces.push_back(std::move(space));
  }
  std::stable_sort(spaces.begin(), spaces.end(),
                   [](const EmptySpace& a, const EmptySpace& b) { return a.volume > b.volume; });
  return spaces;
}

std::string text_of(const EmptySpace& space) {
  return number(space.volume) + " mm^3 (" + counted(space.triangles.size(), "face") + ") around " +
         point_text(space.center) + " mm";
}

}  // namespace softkin
