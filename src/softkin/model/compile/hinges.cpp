#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <softkin/core/dense.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/disjoint_sets.hpp>

namespace softkin {

namespace {

/// Elements with common faces, and rigid regions, move as blocks; blocks with only a common vertex or edge turn about
/// it.
class Blocks {
 public:
  explicit Blocks(const Model& model)
      : model_(model),
        elements_(model.elements.tetrahedra.size() + model.elements.prisms.size()),
        sets_(elements_ + model.rigid.size()) {
    join_by_faces();
    join_rigid();
    for (std::size_t e = 0; e < sets_count(); ++e) blocks_.insert(sets_.find(e));
  }

  [[nodiscard]] std::size_t count() const { return blocks_.size(); }

  /// Returns, for each vertex of several blocks, these blocks.
  [[nodiscard]] std::map<Index, std::set<Index>> hinges() {
    std::vector<Index> first(model_.rest.rows(), -1);
    std::map<Index, std::set<Index>> all;
    each_vertex([&](Index v, Index block) {
      Index& known = first[v];
      if (known < 0) known = block;
      if (known != block) all[v].insert({known, block});
    });
    return all;
  }

  /// visit(vertex, block), a vertex more than once.
  template <class Visit>
  void each_vertex(const Visit& visit) {
    for (std::size_t e = 0; e < model_.elements.tetrahedra.size(); ++e)
      for (const Index v : model_.elements.tetrahedra[e]) visit(v, sets_.find(e));
    for (std::size_t e = 0; e < model_.elements.prisms.size(); ++e)
      for (const Index v : model_.elements.prisms[e]) visit(v, sets_.find(model_.elements.tetrahedra.size() + e));
    for (std::size_t r = 0; r < model_.rigid.size(); ++r)
      for (const Index v : model_.rigid[r].vertices) visit(v, sets_.find(elements_ + r));
  }

 private:
  [[nodiscard]] std::size_t sets_count() const { return elements_ + model_.rigid.size(); }

  /// visit(corners ascending, element): of every face; of a quad the three least.
  template <class Visit>
  void each_face(const Visit& visit) const {
    const auto describe = [&](auto corners, std::size_t element) {
      std::sort(corners.begin(), corners.end());
      visit(corners[0], corners[1], corners[2], element);
    };
    for (std::size_t e = 0; e < model_.elements.tetrahedra.size(); ++e) {
      const Tetrahedron& t = model_.elements.tetrahedra[e];
      for (int i = 0; i < 4; ++i) describe(std::array{t[(i + 1) % 4], t[(i + 2) % 4], t[(i + 3) % 4]}, e);
    }
    for (std::size_t e = 0; e < model_.elements.prisms.size(); ++e) {
      const Prism& p = model_.elements.prisms[e];
      const std::size_t element = model_.elements.tetrahedra.size() + e;
      for (const int i : {0, 3}) describe(std::array{p[i], p[i + 1], p[i + 2]}, element);
      for (int i = 0; i < 3; ++i) describe(std::array{p[i], p[(i + 1) % 3], p[i + 3], p[(i + 1) % 3 + 3]}, element);
    }
  }

  /// Faces by their least vertex, so that only a handful has to be compared.
  void join_by_faces() {
    struct Face {
      Index second, third, element;
    };
    std::vector<std::size_t> starts(static_cast<std::size_t>(model_.rest.rows()) + 1, 0);
    each_face([&](Index least, Index, Index, Index) { ++starts[least + 1]; });
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<Face> faces(starts.back());
    std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
    each_face([&](Index least, Index second, Index third, Index element) {
      const std::size_t begin = starts[least];
      std::size_t& end = next[least];
      for (std::size_t i = begin; i < end; ++i)
        if (faces[i].second == second && faces[i].third == third) return sets_.join(element, faces[i].element);
      faces[end++] = {second, third, element};
    });
  }

  /// An element with three vertices in a rigid region moves with it.
  void join_rigid() {
    std::vector<Index> owner(model_.rest.rows(), -1);
    for (std::size_t r = 0; r < model_.rigid.size(); ++r)
      for (const Index v : model_.rigid[r].vertices) owner[v] = r;
    const auto look = [&](const auto& vertices, std::size_t element) {
      for (const Index v : vertices) {
        const Index rigid = owner[v];
        const auto same = [&](Index w) { return owner[w] == rigid; };
        if (rigid < 0 || std::count_if(vertices.begin(), vertices.end(), same) < 3) continue;
        sets_.join(element, static_cast<Index>(elements_) + rigid);
        return;
      }
    };
    for (std::size_t e = 0; e < model_.elements.tetrahedra.size(); ++e) look(model_.elements.tetrahedra[e], e);
    for (std::size_t e = 0; e < model_.elements.prisms.size(); ++e)
      look(model_.elements.prisms[e], model_.elements.tetrahedra.size() + e);
  }

  const Model& model_;
  std::size_t elements_;
  DisjointSets sets_;
  std::set<Index> blocks_;
};

struct Place {
  std::vector<Index> vertices;
  Vec3 centroid = Vec3::Zero();
  double size = 1;  // [mm]
};

std::map<Index, Place> places_of(const Model& model, Blocks& blocks) {
  std::map<Index, Place> places;
  blocks.each_vertex([&](Index v, Index block) { places[block].vertices.push_back(v); });
  for (auto& [block, place] : places) {
    sort_unique(place.vertices);
    for (const Index v : place.vertices)
      place.centroid += vertex_at(model.rest, v) / static_cast<double>(place.vertices.size());
    double farthest = 0;
    for (const Index v : place.vertices)
      farthest = std::max(farthest, (vertex_at(model.rest, v) - place.centroid).norm());
    if (farthest > 0) place.size = farthest;
  }
  return places;
}

/// Motions of blocks (6 unknowns each: move, turn in units of the size) that leave shared vertices together and held
/// ones where they are, to first order.
Eigen::MatrixXd free_motions(const Model& model, const std::map<Index, Place>& places,
                             const std::map<Index, std::set<Index>>& hinges) {
  std::map<Index, Index> column;
  for (const auto& [block, place] : places) column.emplace(block, 6 * static_cast<Index>(column.size()));
  std::vector<Eigen::RowVectorXd> rows;
  const auto add = [&](Eigen::RowVectorXd& row, Index v, Index block, int axis, double sign) {
    const Place& place = places.at(block);
    const Vec3 unit = Vec3::Unit(axis), arm = (vertex_at(model.rest, v) - place.centroid) / place.size;
    row.segment<3>(column.at(block)) += sign * unit;
    row.segment<3>(column.at(block) + 3) += sign * arm.cross(unit);
  };
  const auto row = [&] { return Eigen::RowVectorXd::Zero(6 * std::ssize(places)).eval(); };
  for (const auto& [v, all] : hinges)
    for (auto other = std::next(all.begin()); other != all.end(); ++other)
      for (int axis = 0; axis < 3; ++axis) {
        rows.push_back(row());
        add(rows.back(), v, *all.begin(), axis, 1);
        add(rows.back(), v, *other, axis, -1);
      }
  for (const auto& [block, place] : places)
    for (int axis = 0; axis < 3; ++axis) {
      std::size_t held = 0;
      for (const Index v : place.vertices)
        if (model.held.fixed[v][axis]) {
          rows.push_back(row());
          add(rows.back(), v, block, axis, 1);
          if (++held == 200) break;  // of a face, far more than it takes
        }
    }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(
      std::max<Eigen::Index>(static_cast<Eigen::Index>(rows.size()), 6 * static_cast<Eigen::Index>(places.size())),
      6 * std::ssize(places));
  for (std::size_t i = 0; i < rows.size(); ++i) matrix.row(i) = rows[i];
  const SingularValues singular = singular_values(matrix);
  constexpr double tolerance = 1e-9;
  const Eigen::Index rank = (singular.values.array() > tolerance * singular.values[0]).count();
  return singular.right.rightCols(matrix.cols() - rank);
}

std::string hinge_text(const std::vector<Index>& shared) {
  if (shared.size() == 1) return "vertex " + std::to_string(shared[0]);
  if (shared.size() == 2)
    return "the edge of vertices " + std::to_string(shared[0]) + " and " + std::to_string(shared[1]);
  return std::to_string(shared.size()) + " vertices, the first of them " + std::to_string(shared[0]);
}

}  // namespace

void check_hinges(const Model& model, const Origin& origin) {
  constexpr std::size_t max_blocks = 200;
  if (model.formulation != Formulation::physical) return;
  Blocks blocks(model);
  if (blocks.count() <= 1) return;
  const std::map<Index, std::set<Index>> hinges = blocks.hinges();
  if (hinges.empty()) return;  // parts apart, each held
  const std::map<Index, Place> places = places_of(model, blocks);
  if (places.size() > max_blocks)
    throw InvalidInput(origin, "the body falls into " + std::to_string(places.size()) +
                                   " pieces that hang together by single vertices or edges, the first of them " +
                                   std::to_string(hinges.begin()->first) + " (from 0): mend the mesh there");
  const Eigen::MatrixXd motions = free_motions(model, places, hinges);
  if (motions.cols() == 0) return;
  Index loosest = 0, at = 0;
  double most = 0;
  for (const auto& [block, place] : places) {
    const double motion = motions.middleRows<6>(at).norm();
    if (motion > (1 + 1e-6) * most) {
      most = motion;
      loosest = block;
    }
    at += 6;
  }
  std::vector<Index> shared;
  for (const auto& [v, all] : hinges)
    if (all.count(loosest) > 0) shared.push_back(v);
  const Place& place = places.at(loosest);
  throw InvalidInput(origin, "a part of " + counted(place.vertices.size(), "vertex", "vertices") + " around (" +
                                 number(place.centroid.x()) + ", " + number(place.centroid.y()) + ", " +
                                 number(place.centroid.z()) + ") mm hangs on " + hinge_text(shared) +
                                 " (from 0) and can turn there: join it by faces, or make it void");
}

}  // namespace softkin
