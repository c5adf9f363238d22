#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/compile/closing.hpp>
#include <unordered_map>
#include <utility>

namespace softkin {

namespace {

using Cycle = std::vector<std::size_t>;  // indices of edges, each begins where the one before it ends

/// The cycles without a vertex twice that the edges are made of; of each vertex as many edges end as begin there.
std::vector<Cycle> cycles_of(const std::vector<RimEdge>& edges) {
  std::unordered_map<Index, std::vector<std::size_t>> leaving;
  for (std::size_t e = edges.size(); e-- > 0;) leaving[edges[e].from].push_back(e);
  std::vector<Cycle> cycles;
  for (const RimEdge& first : edges) {
    Cycle path;
    std::unordered_map<Index, std::size_t> place{{first.from, 0}};  // of the vertices on the path
    for (Index v = first.from; !leaving[v].empty();) {
      const std::size_t e = leaving[v].back();
      leaving[v].pop_back();
      path.push_back(e);
      v = edges[e].to;
      const auto [known, is_new] = place.try_emplace(v, path.size());
      if (is_new) continue;
      const auto begin = path.begin() + static_cast<std::ptrdiff_t>(known->second);
      cycles.emplace_back(begin, path.end());
      for (auto edge = begin; edge != path.end(); ++edge)
        if (edges[*edge].to != v) place.erase(edges[*edge].to);
      path.erase(begin, path.end());
    }
  }
  return cycles;
}

ClosingPolygon polygon_of(const std::vector<RimEdge>& edges, const Cycle& cycle) {
  ClosingPolygon polygon;
  for (const std::size_t e : cycle) {
    polygon.vertices.push_back(edges[e].from);
    polygon.nodes.push_back(edges[e].node);
  }
  return polygon;
}

struct Plane {
  int axis = 0;
  double value = 0;
};

class RimCloser {
 public:
  RimCloser(const Points& vertices, const std::vector<RimEdge>& rim, const std::vector<std::array<bool, 3>>& held,
            double tolerance)
      : vertices_(vertices), rim_(rim), held_(held), tolerance_(tolerance) {}

  ClosedRim close() {
    std::vector<Cycle> plain;                 // in one plane normal to an axis
    std::vector<std::size_t> others, of_all;  // edges of cycles that leave every plane; those of `plain`, too
    const auto append = [](const Cycle& cycle, std::vector<std::size_t>& edges) {
      edges.insert(edges.end(), cycle.begin(), cycle.end());
    };
    for (Cycle& cycle : cycles_of(rim_)) {
      if (stays_in_held_plane(cycle)) {
        result_.polygons.push_back(polygon_of(rim_, cycle));
        continue;
      }
      append(cycle, of_all);
      if (stays_in_plane(cycle))
        plain.push_back(std::move(cycle));
      else
        append(cycle, others);
    }
    if (const std::size_t stray = find_planes(others); stray < rim_.size()) return {{}, {}, stray};
    if (join_planes()) {
      for (const Cycle& cycle : plain) result_.polygons.push_back(polygon_of(rim_, cycle));
    } else {  // a plane may close the others that has but an opening of its own
      planes_.clear(), edges_in_.clear(), turns_.clear(), corners_.clear();
      if (find_planes(of_all) < rim_.size() || !join_planes()) return {{}, {}, others.front()};
    }
    add_polygons();
    return std::move(result_);
  }

 private:
  void add_polygons() {
    for (const std::vector<RimEdge>& edges : edges_in_)
      for (const Cycle& cycle : cycles_of(edges)) {
        ClosingPolygon polygon = polygon_of(edges, cycle);
        const bool nothing = polygon.vertices.size() == 2 && polygon.nodes[0] < 0 && polygon.nodes[1] < 0;
        if (!nothing) result_.polygons.push_back(std::move(polygon));
      }
  }

  [[nodiscard]] std::vector<Index> nodes_of(const RimEdge& edge) const {
    return edge.node < 0 ? std::vector{edge.from, edge.to} : std::vector{edge.from, edge.to, edge.node};
  }

  /// May a plane normal to the axis close the surface along this edge?
  [[nodiscard]] bool is_in_plane(const RimEdge& edge, Plane plane) const {
    const std::vector<Index> nodes = nodes_of(edge);
    return std::all_of(nodes.begin(), nodes.end(), [&](Index v) {
      return held_[v][plane.axis] && std::abs(vertices_(v, plane.axis) - plane.value) <= tolerance_;
    });
  }

  [[nodiscard]] bool stays_in_plane(const Cycle& cycle) const {
    for (int axis = 0; axis < 3; ++axis) {
      const Plane plane{axis, vertices_(rim_[cycle[0]].from, axis)};
      if (std::all_of(cycle.begin(), cycle.end(), [&](std::size_t e) { return is_in_plane(rim_[e], plane); }))
        return true;
    }
    return false;
  }

  [[nodiscard]] bool stays_in_held_plane(const Cycle& cycle) const {
    const Vec3 origin = vertex_at(vertices_, rim_[cycle[0]].from);
    Vec3 normal = Vec3::Zero();  // twice the area
    for (const std::size_t e : cycle)
      normal += (vertex_at(vertices_, rim_[e].from) - origin).cross(vertex_at(vertices_, rim_[e].to) - origin);
    if (!(normal.norm() > tolerance_ * tolerance_)) return false;
    normal.normalize();
    return std::all_of(cycle.begin(), cycle.end(), [&](std::size_t e) {
      const std::vector<Index> nodes = nodes_of(rim_[e]);
      return std::all_of(nodes.begin(), nodes.end(), [&](Index v) {
        return held_[v][0] && held_[v][1] && held_[v][2] &&
               std::abs(normal.dot(vertex_at(vertices_, v) - origin)) <= tolerance_;
      });
    });
  }

  /// Gives each of the edges a plane, the one first that has most of them; the first edge without one, or their number.
  std::size_t find_planes(std::vector<std::size_t> edges) {
    while (!edges.empty()) {
      std::vector<Plane> candidates;
      for (const std::size_t e : edges)
        for (int axis = 0; axis < 3; ++axis) {
          const Plane plane{axis, vertices_(rim_[e].from, axis)};
          if (is_in_plane(rim_[e], plane)) candidates.push_back(plane);
        }
      if (candidates.empty()) return edges.front();
      const Plane plane = commonest(candidates);
      planes_.push_back(plane);
      std::vector<RimEdge>& taken = edges_in_.emplace_back();
      std::vector<std::size_t> left;
      for (const std::size_t e : edges) {
        if (is_in_plane(rim_[e], plane))
          taken.push_back(rim_[e]);
        else
          left.push_back(e);
      }
      edges = std::move(left);
    }
    return rim_.size();
  }

  [[nodiscard]] Plane commonest(std::vector<Plane>& planes) const {
    std::sort(planes.begin(), planes.end(),
              [](const Plane& a, const Plane& b) { return std::pair(a.axis, a.value) < std::pair(b.axis, b.value); });
    std::size_t best = 0, most = 0;
    for (std::size_t i = 0, j = 0; i < planes.size(); i = j) {
      for (j = i + 1;
           j < planes.size() && planes[j].axis == planes[i].axis && planes[j].value - planes[i].value <= tolerance_;)
        ++j;
      if (j - i <= most) continue;
      most = j - i;
      best = i;
    }
    return planes[best];
  }

  // Where the rim passes from one plane into another, the polygons of both continue along the line in which the planes
  // intersect: from there to where the rim comes back, or to the corner in which three planes meet.

  using Line = std::pair<std::size_t, std::size_t>;  // two planes, the first one first
  struct Corner {
    std::array<std::size_t, 3> planes;  // ascending
    std::optional<int> passes{};        // how often the polygon of the first plane comes from the second to here
  };

  bool join_planes() {
    for (std::size_t p = 0; p < planes_.size(); ++p)
      for (std::size_t q = p + 1; q < planes_.size(); ++q)
        if (planes_[p].axis != planes_[q].axis) turns_[{p, q}];
    if (!find_turns()) return false;
    find_corners();
    if (!count_passes()) return false;
    add_chords();
    return true;
  }

  /// By line and vertex how often the rim goes from the first plane into the second there, less how often back.
  bool find_turns() {
    std::map<Index, std::map<std::size_t, int>> ends;
    for (std::size_t p = 0; p < planes_.size(); ++p)
      for (const RimEdge& edge : edges_in_[p]) {
        ++ends[edge.to][p];
        --ends[edge.from][p];
      }
    for (auto& [vertex, counts] : ends)
      while (true) {
        const auto ending = std::find_if(counts.begin(), counts.end(), [](const auto& c) { return c.second > 0; });
        const auto beginning = std::find_if(counts.begin(), counts.end(), [](const auto& c) { return c.second < 0; });
        if (ending == counts.end() || beginning == counts.end()) break;
        const std::size_t from = ending->first, into = beginning->first;
        const auto line = turns_.find(std::minmax(from, into));
        if (line == turns_.end()) return false;  // planes that do not intersect
        line->second[vertex] += from < into ? 1 : -1;
        --ending->second;
        ++beginning->second;
      }
    return true;
  }

  void find_corners() {
    for (std::size_t p = 0; p < planes_.size(); ++p)
      for (std::size_t q = p + 1; q < planes_.size(); ++q)
        for (std::size_t r = q + 1; r < planes_.size(); ++r)
          if ((1 << planes_[p].axis | 1 << planes_[q].axis | 1 << planes_[r].axis) == 7)
            corners_.push_back({{p, q, r}});
  }

  /// Returns 1 or -1 where the line passes through the corner, the sense in which a polygon that passes the corner once
  /// runs along the line; else 0.
  static int sign_at(const Corner& corner, const Line& line) {
    const auto& [p, q, r] = corner.planes;
    if (line == Line(p, q) || line == Line(q, r)) return 1;
    return line == Line(p, r) ? -1 : 0;
  }

  /// Counts how often the polygon passes each corner: the passes along a line must balance the turns into it.
  bool count_passes() {
    for (std::size_t round = 0; round <= 2 * corners_.size(); ++round) {
      bool found = false;
      for (const auto& [line, turns] : turns_) {
        int missing = 0;
        for (const auto& [vertex, count] : turns) missing += count;
        Corner* open = nullptr;
        int unknown = 0;
        for (Corner& corner : corners_) {
          const int sign = sign_at(corner, line);
          if (sign == 0) continue;
          if (corner.passes)
            missing -= sign * *corner.passes;
          else if (++unknown == 1)
            open = &corner;
        }
        if (unknown == 0 && missing != 0) return false;
        if (unknown != 1) continue;
        open->passes = sign_at(*open, line) * missing;
        found = true;
      }
      if (found) continue;
      const auto open = std::find_if(corners_.begin(), corners_.end(), [](const Corner& c) { return !c.passes; });
      if (open == corners_.end()) return true;
      open->passes = 0;
    }
    return std::all_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.passes.has_value(); });
  }

  void add_chords() {
    std::vector<Index> numbers;
    for (const Corner& corner : corners_) {
      numbers.push_back(static_cast<Index>(vertices_.rows() + std::ssize(result_.corners)));
      if (*corner.passes == 0) continue;
      Vec3 point = Vec3::Zero();
      for (const std::size_t p : corner.planes) point[planes_[p].axis] = planes_[p].value;
      result_.corners.push_back(point);
    }
    for (const auto& [line, turns] : turns_) {
      std::vector<Index> starts, ends;
      const auto add = [&](Index vertex, int count) {
        (count < 0 ? starts : ends).insert((count < 0 ? starts : ends).end(), std::abs(count), vertex);
      };
      for (const auto& [vertex, count] : turns) add(vertex, -count);
      for (std::size_t i = 0; i < corners_.size(); ++i)
        add(numbers[i], sign_at(corners_[i], line) * *corners_[i].passes);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        edges_in_[line.first].push_back({starts[i], ends[i]});
        edges_in_[line.second].push_back({ends[i], starts[i]});
      }
    }
  }

  const Points& vertices_;
  const std::vector<RimEdge>& rim_;
  const std::vector<std::array<bool, 3>>& held_;
  double tolerance_;
  ClosedRim result_;
  std::vector<Plane> planes_;
  std::vector<std::vector<RimEdge>> edges_in_;  // of each plane, with the chords along its lines
  std::map<Line, std::map<Index, int>> turns_;
  std::vector<Corner> corners_;
};

}  // namespace

ClosedRim close_rim(const Points& vertices, const std::vector<RimEdge>& rim,
                    const std::vector<std::array<bool, 3>>& held, double tolerance) {
  return RimCloser(vertices, rim, held, tolerance).close();
}

std::vector<CavityFace> faces_of(const ClosingPolygon& polygon, bool quadratic) {
  const std::vector<Index>& v = polygon.vertices;
  const std::size_t count = v.size();
  // A straight edge has no node of its own: one of its ends stands for it, the same one in both faces at the edge.
  const auto on_edge = [&](std::size_t i) {
    return polygon.nodes[i] >= 0 ? polygon.nodes[i] : std::min(v[i], v[(i + 1) % count]);
  };
  if (count == 2) {  // between a curved edge and the chord
    if (!quadratic) return {};
    return {CavityFace{{v[0], v[1], v[0]}, {on_edge(1), on_edge(0), v[0]}}};
  }
  std::vector<CavityFace> faces;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    CavityFace& face = faces.emplace_back(CavityFace{{v[0], v[i + 1], v[i]}});
    if (quadratic) face.edges = {i + 2 == count ? on_edge(count - 1) : v[0], on_edge(i), i == 1 ? on_edge(0) : v[0]};
  }
  return faces;
}

}  // namespace softkin
