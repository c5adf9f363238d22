#include <algorithm>
#include <map>
#include <softkin/io/mesh/abaqus_cards.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <unordered_map>
#include <utility>

namespace softkin {

namespace {

/// Corners of the faces S1, S2, ... from 1, as Abaqus numbers them; 0: none.
constexpr Index tetrahedron_faces[4][4] = {{1, 2, 3, 0}, {1, 4, 2, 0}, {2, 4, 3, 0}, {3, 4, 1, 0}};
constexpr Index prism_faces[5][4] = {{1, 2, 3, 0}, {4, 6, 5, 0}, {1, 4, 5, 2}, {2, 5, 6, 3}, {3, 6, 4, 1}};

using Numbers = std::unordered_map<std::int64_t, Index>;  // from the file's numbers to the order of appearance

struct NamedSet {
  std::string name;
  bool in_assembly = false;
  std::vector<Index> members;
};

/// Sets of one kind in order of first mention; names are found without regard to case.
class SetTable {
 public:
  NamedSet& at(const AbaqusCards& cards, const AbaqusSet& card) {
    const auto [found, added] = by_name_.emplace(upper_case(card.name), sets_.size());
    if (added) sets_.push_back({card.name, card.in_assembly, {}});
    NamedSet& set = sets_[found->second];
    if (set.in_assembly != card.in_assembly)
      throw InvalidInput(cards.origin(card.line),
                         "'" + card.name + "' is defined in the part and in the assembly: rename one of them");
    return set;
  }

  const std::vector<Index>& members(const AbaqusCards& cards, const AbaqusItem& item, const char* kind) const {
    const auto found = by_name_.find(upper_case(item.name));
    if (found != by_name_.end()) return sets_[found->second].members;
    std::vector<std::string> known;
    for (const NamedSet& set : sets_) known.push_back(set.name);
    const std::string name = item.name.substr(0, 40);
    throw InvalidInput(cards.origin(item.line),
                       std::string("unknown ") + kind + " set '" + name + "'" + suggest_name(name, known));
  }

  std::vector<NamedSet>& sets() { return sets_; }

 private:
  std::vector<NamedSet> sets_;
  std::map<std::string, std::size_t> by_name_;
};

class AbaqusMeshBuilder {
 public:
  explicit AbaqusMeshBuilder(const AbaqusCards& cards) : cards_(cards) {}

  Mesh build() {
    add_nodes();
    add_elements();
    for (const AbaqusSet& card : cards_.sets)
      if (card.kind != AbaqusSetKind::surface) resolve(card);
    for (const NamedSet& set : element_sets_.sets()) add_region_of_elements(set);
    for (const AbaqusSet& card : cards_.sets)
      if (card.kind == AbaqusSetKind::surface) resolve_surface(card);
    add_regions(surfaces_, 2, [&](Region& region, Index face) {
      const auto [is_quad, index] = faces_[face];
      (is_quad ? region.quads : region.triangles).push_back(index);
    });
    add_regions(node_sets_, 0, [](Region& region, Index node) { region.vertices.push_back(node); });
    return std::move(mesh_);
  }

 private:
  void add_nodes() {
    mesh_.vertices.resize(cards_.nodes.size(), 3);
    nodes_.reserve(cards_.nodes.size());
    for (const AbaqusNode& node : cards_.nodes) {
      const Index index = nodes_.size();
      if (!nodes_.emplace(node.id, index).second)
        throw InvalidInput(cards_.origin(node.line), "node " + std::to_string(node.id) + " is defined a second time");
      mesh_.vertices.row(index) = node.position.transpose();
    }
  }

  void add_elements() {
    elements_.reserve(cards_.elements.size());
    for (const AbaqusElement& element : cards_.elements) {
      if (!elements_.emplace(element.id, static_cast<Index>(elements_.size())).second)
        throw InvalidInput(cards_.origin(element.line),
                           "element " + std::to_string(element.id) + " is defined a second time");
      add_element(element);
      const std::string refusal = refusal_of_orders(mesh_);
      if (!refusal.empty()) throw InvalidInput(cards_.origin(element.line), refusal);
    }
    if (mesh_.tetrahedra.empty() && mesh_.prisms.empty() && mesh_.triangles.empty())
      throw InvalidInput(cards_.origin(cards_.last_line), missing_volume(mesh_));
  }

  void add_element(const AbaqusElement& element) {
    switch (element.shape) {
      case AbaqusShape::tetrahedron:
        add_cell(nodes_of<4>(element, 0), mesh_.tetrahedra);
        if (element.count == 10) mesh_.edge_nodes.push_back(nodes_of<6>(element, 4));  // edges in softkin's order
        break;
      case AbaqusShape::prism:
        add_cell(nodes_of<6>(element, 0), mesh_.prisms);
        break;
      case AbaqusShape::triangle:
        add_cell(nodes_of<3>(element, 0), mesh_.triangles);
        break;
      case AbaqusShape::quad:
        add_cell(nodes_of<4>(element, 0), mesh_.quads);
        break;
      case AbaqusShape::line: {
        std::vector<Index> nodes;  // where the middle one stands differs between types
        for (std::size_t i = 0; i < element.count; ++i) nodes.push_back(node_of(element, element.nodes[i]));
        add_cell(nodes, lines_);
        break;
      }
    }
  }

  template <class Cell>
  void add_cell(const Cell& cell, std::vector<Cell>& cells) {
    place_.push_back(cells.size());
    cells.push_back(cell);
  }

  static int dimension_of(AbaqusShape shape) {
    if (shape == AbaqusShape::line) return 1;
    return shape == AbaqusShape::triangle || shape == AbaqusShape::quad ? 2 : 3;
  }

  /// Of a set's elements those of the highest dimension.
  void add_region_of_elements(const NamedSet& set) {
    Region region;
    region.name = set.name;
    region.dimension = 1;
    const auto shape_of = [&](Index element) { return cards_.elements[element].shape; };
    for (const Index element : set.members)
      region.dimension = std::max(region.dimension, dimension_of(shape_of(element)));
    for (const Index element : set.members) {
      const AbaqusShape shape = shape_of(element);
      if (dimension_of(shape) != region.dimension) continue;
      const std::size_t place = place_[element];
      if (shape == AbaqusShape::line) {
        region.vertices.insert(region.vertices.end(), lines_[place].begin(), lines_[place].end());
        continue;
      }
      auto& members = shape == AbaqusShape::tetrahedron ? region.tetrahedra
                      : shape == AbaqusShape::prism     ? region.prisms
                      : shape == AbaqusShape::triangle  ? region.triangles
                                                        : region.quads;
      members.push_back(place);
    }
    sort_unique(region.vertices);
    mesh_.regions.push_back(std::move(region));
  }

  template <std::size_t N>
  std::array<Index, N> nodes_of(const AbaqusElement& element, std::size_t first) const {
    std::array<Index, N> nodes;
    for (std::size_t i = 0; i < N; ++i) nodes[i] = node_of(element, element.nodes[first + i]);
    return nodes;
  }

  Index node_of(const AbaqusElement& element, std::int64_t id) const {
    const auto found = nodes_.find(id);
    if (found == nodes_.end())
      throw InvalidInput(cards_.origin(element.line),
                         "element " + std::to_string(element.id) + " refers to the unknown node " + std::to_string(id));
    return found->second;
  }

  /// Appends what an item stands for: numbers, or the members of the set that it names.
  void append_item(const AbaqusItem& item, const Numbers& numbers, const SetTable& table, const char* kind,
                   std::vector<Index>& members) const {
    if (!item.name.empty()) return append(members, table.members(cards_, item, kind));
    for (std::int64_t id = item.first; id <= item.last; id += item.step) {
      const auto found = numbers.find(id);
      if (found == numbers.end())
        throw InvalidInput(cards_.origin(item.line), std::string("unknown ") + kind + " " + std::to_string(id));
      members.push_back(found->second);
    }
  }

  void resolve(const AbaqusSet& card) {
    const bool of_nodes = card.kind == AbaqusSetKind::nodes;
    SetTable& table = of_nodes ? node_sets_ : element_sets_;
    const Numbers& numbers = of_nodes ? nodes_ : elements_;
    const char* kind = of_nodes ? "node" : "element";
    std::vector<Index> members;
    for (const AbaqusItem& item : card.items) {
      if (item.element_nodes)
        append_nodes_of(element_sets_.members(cards_, item, "element"), members);
      else
        append_item(item, numbers, table, kind, members);
      if (members.size() > 2 * numbers.size()) sort_unique(members);  // sets of sets must not grow without bound
    }
    std::vector<Index>& all = table.at(cards_, card).members;
    append(all, members);
    sort_unique(all);
  }

  static void append(std::vector<Index>& members, const std::vector<Index>& more) {
    members.insert(members.end(), more.begin(), more.end());
  }

  /// The corners of an element, from 0.
  std::pair<const Index*, std::size_t> corners_of(Index element) const {
    const std::size_t i = element, place = place_[i];
    switch (cards_.elements[i].shape) {
      case AbaqusShape::tetrahedron:
        return {mesh_.tetrahedra[place].data(), 4};
      case AbaqusShape::prism:
        return {mesh_.prisms[place].data(), 6};
      case AbaqusShape::triangle:
        return {mesh_.triangles[place].data(), 3};
      case AbaqusShape::quad:
        return {mesh_.quads[place].data(), 4};
      case AbaqusShape::line:
        break;
    }
    return {lines_[place].data(), lines_[place].size()};
  }

  void append_nodes_of(const std::vector<Index>& elements, std::vector<Index>& members) const {
    for (const Index element : elements) {
      const auto [corners, count] = corners_of(element);
      members.insert(members.end(), corners, corners + count);
      if (mesh_.edge_nodes.empty() || !is_solid(element)) continue;
      const EdgeNodes& nodes = mesh_.edge_nodes[place_[element]];
      members.insert(members.end(), nodes.begin(), nodes.end());
    }
    sort_unique(members);
  }

  void resolve_surface(const AbaqusSet& card) {
    std::vector<Index> members;
    for (const AbaqusItem& item : card.items) {
      std::vector<Index> elements;
      append_item(item, elements_, element_sets_, "element", elements);
      for (const Index element : elements) members.push_back(face_of(element, item));
      if (members.size() > 2 * faces_.size()) sort_unique(members);
    }
    std::vector<Index>& all = surfaces_.at(cards_, card).members;
    append(all, members);
    sort_unique(all);
  }

  /// The number of an element's face among the surface cells; new ones are added to the mesh.
  Index face_of(Index element, const AbaqusItem& item) {
    if (!is_solid(element)) return own_face_of(element, item);
    const auto [corners, count] = corners_of(element);
    if (item.face == 0) throw InvalidInput(cards_.origin(item.line), "a solid's face must be S1 to S5");
    if (item.face > (count == 4 ? 4 : 5))
      throw InvalidInput(cards_.origin(item.line), "a tetrahedron has no face S" + std::to_string(item.face));
    const auto key = std::int64_t{element} * 8 + item.face;
    const auto [found, added] = face_numbers_.emplace(key, static_cast<Index>(faces_.size()));
    if (!added) return found->second;
    const Index(&face)[4] = (count == 4 ? tetrahedron_faces : prism_faces)[item.face - 1];
    if (face[3] == 0) {
      faces_.emplace_back(false, static_cast<Index>(mesh_.triangles.size()));
      mesh_.triangles.push_back({corners[face[0] - 1], corners[face[1] - 1], corners[face[2] - 1]});
    } else {
      faces_.emplace_back(true, static_cast<Index>(mesh_.quads.size()));
      mesh_.quads.push_back({corners[face[0] - 1], corners[face[1] - 1], corners[face[2] - 1], corners[face[3] - 1]});
    }
    return found->second;
  }

  [[nodiscard]] bool is_solid(Index element) const { return dimension_of(cards_.elements[element].shape) == 3; }

  /// The cell that a shell is, seen from either side.
  Index own_face_of(Index element, const AbaqusItem& item) {
    const std::size_t i = element;
    if (cards_.elements[i].shape == AbaqusShape::line)
      throw InvalidInput(cards_.origin(item.line), "a truss or beam has no face");
    const auto [found, added] = face_numbers_.emplace(std::int64_t{element} * 8, static_cast<Index>(faces_.size()));
    if (added) faces_.emplace_back(cards_.elements[i].shape == AbaqusShape::quad, static_cast<Index>(place_[i]));
    return found->second;
  }

  template <class Add>
  void add_regions(SetTable& table, int dimension, const Add& add) {
    for (const NamedSet& set : table.sets()) {
      Region region;
      region.name = set.name;
      region.dimension = dimension;
      for (const Index member : set.members) add(region, member);
      mesh_.regions.push_back(std::move(region));
    }
  }

  const AbaqusCards& cards_;
  Mesh mesh_;
  Numbers nodes_, elements_;
  std::vector<std::size_t> place_;         // of each element among those of its shape
  std::vector<std::vector<Index>> lines_;  // their nodes
  SetTable node_sets_, element_sets_, surfaces_;
  Numbers face_numbers_;                       // from 8 * element + face to the index into faces_
  std::vector<std::pair<bool, Index>> faces_;  // is it a quad, and which
};

}  // namespace

Mesh read_abaqus(const std::filesystem::path& path) {
  const AbaqusCards cards = read_abaqus_cards(path);
  return AbaqusMeshBuilder(cards).build();
}

}  // namespace softkin
