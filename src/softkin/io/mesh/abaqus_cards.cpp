#include <algorithm>
#include <initializer_list>
#include <limits>
#include <map>
#include <softkin/io/mesh/abaqus_cards.hpp>
#include <softkin/io/mesh/abaqus_lines.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <utility>

namespace softkin {

namespace {

/// Walks an Abaqus input file keyword by keyword; handles comments, letter case, blanks, continued keyword lines and
/// included files.
class AbaqusDeck {
 public:
  explicit AbaqusDeck(const std::filesystem::path& path) : lines_(path) {}

  /// Passes over data lines that are left; false: the file ends
  bool next_keyword() {
    while (peek() && next_.front() != '*') peeked_ = false;
    if (!peek()) return false;
    peeked_ = false;
    line_ = next_line_;
    std::string text(next_.substr(1));
    while (text.ends_with(',') && peek() && next_.front() != '*') {
      text += next_;
      peeked_ = false;
    }
    read_parameters(text);
    return true;
  }

  /// Next data line of this keyword; false: there is none
  bool next_data() {
    if (!peek() || next_.front() == '*') return false;
    peeked_ = false;
    line_ = next_line_;
    fields_ = abaqus_fields(next_);
    continued_ = fields_.back().empty();
    if (continued_) fields_.pop_back();
    return true;
  }

  [[nodiscard]] const std::string& keyword() const { return keyword_; }  // in capitals, single blanks, without '*'
  [[nodiscard]] bool has(const std::string& parameter) const { return parameters_.contains(parameter); }

  /// "" where there is none
  [[nodiscard]] std::string value(const std::string& parameter) const {
    const auto found = parameters_.find(parameter);
    return found == parameters_.end() ? "" : found->second;
  }

  /// Fails where there is none
  [[nodiscard]] std::string required(const std::string& parameter) const {
    const std::string text = value(parameter);
    if (text.empty()) fail("*" + keyword_ + " needs " + parameter + "=");
    return text;
  }

  /// Fails on any other, or one twice
  void allow(std::initializer_list<const char*> parameters) const {
    const std::vector<std::string> known(parameters.begin(), parameters.end());
    for (const auto& [key, value] : parameters_)
      if (std::find(known.begin(), known.end(), key) == known.end())
        fail("parameter '" + key.substr(0, 40) + "' of *" + keyword_ + " is not supported" + suggest_name(key, known));
    if (!repeated_.empty()) fail("parameter " + repeated_ + " stands twice on *" + keyword_);
  }

  [[nodiscard]] const std::vector<std::string_view>& fields() const { return fields_; }  // of the data line
  [[nodiscard]] bool continued() const { return continued_; }  // the data line ends in a comma

  /// From 1 to 2^31 - 1
  [[nodiscard]] std::int64_t integer(std::size_t field, const char* what) const {
    std::int64_t value = 0;
    const std::string text(fields_.at(field).substr(0, 40));
    if (!parse_integer(fields_[field], value) || value < 1 || value > std::numeric_limits<Index>::max())
      fail(std::string(what) + " must be a whole number from 1, not '" + text + "'");
    return value;
  }

  [[nodiscard]] double real(std::size_t field, const char* what) const {
    double value = 0;
    const std::string text(fields_.at(field).substr(0, 40));
    if (!parse_real(fields_[field], value)) fail(std::string(what) + " must be a finite number, not '" + text + "'");
    return value;
  }

  [[nodiscard]] AbaqusLine line() const { return line_; }
  [[nodiscard]] std::vector<std::string> files() const { return lines_.files(); }
  [[nodiscard]] Origin origin(AbaqusLine line) const { return lines_.origin(line); }
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput(origin(line_), message); }

 private:
  /// Is there a line ahead that is neither blank nor a comment?
  bool peek() {
    if (!peeked_) peeked_ = lines_.next(next_, next_line_);
    return peeked_;
  }

  void read_parameters(std::string_view text) {
    const std::vector<std::string_view> parts = abaqus_fields(text);
    keyword_ = abaqus_key(parts.front());
    parameters_.clear();
    repeated_.clear();
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (!parts[i].empty()) add_parameter(parts[i]);
  }

  void add_parameter(std::string_view text) {
    const std::size_t equals = text.find('=');
    const std::string key = abaqus_key(text.substr(0, equals));
    const std::string value = equals == std::string_view::npos ? "" : without_quotes(trimmed(text.substr(equals + 1)));
    if (!parameters_.emplace(key, value).second) repeated_ = key;
  }

  AbaqusLines lines_;
  bool peeked_ = false;
  std::string_view next_;  // the line ahead, valid where peeked_
  AbaqusLine next_line_;
  AbaqusLine line_;
  std::string keyword_;
  std::map<std::string, std::string> parameters_;
  std::string repeated_;  // a parameter that stands twice
  std::vector<std::string_view> fields_;
  bool continued_ = false;
};

struct ElementType {
  std::string_view name;  // without its formulation
  AbaqusShape shape;
  std::size_t nodes;
};

constexpr ElementType element_types[] = {
    {"C3D4", AbaqusShape::tetrahedron, 4}, {"C3D10", AbaqusShape::tetrahedron, 10}, {"C3D6", AbaqusShape::prism, 6},
    {"CPS3", AbaqusShape::triangle, 3},    {"CPE3", AbaqusShape::triangle, 3},      {"CAX3", AbaqusShape::triangle, 3},
    {"S3", AbaqusShape::triangle, 3},      {"STRI3", AbaqusShape::triangle, 3},     {"R3D3", AbaqusShape::triangle, 3},
    {"M3D3", AbaqusShape::triangle, 3},    {"SFM3D3", AbaqusShape::triangle, 3},    {"CPS6", AbaqusShape::triangle, 6},
    {"CPE6", AbaqusShape::triangle, 6},    {"CAX6", AbaqusShape::triangle, 6},      {"S6", AbaqusShape::triangle, 6},
    {"STRI65", AbaqusShape::triangle, 6},  {"M3D6", AbaqusShape::triangle, 6},      {"CPS4", AbaqusShape::quad, 4},
    {"CPE4", AbaqusShape::quad, 4},        {"CAX4", AbaqusShape::quad, 4},          {"S4", AbaqusShape::quad, 4},
    {"R3D4", AbaqusShape::quad, 4},        {"M3D4", AbaqusShape::quad, 4},          {"SFM3D4", AbaqusShape::quad, 4},
    {"CPS8", AbaqusShape::quad, 8},        {"CPE8", AbaqusShape::quad, 8},          {"CAX8", AbaqusShape::quad, 8},
    {"S8", AbaqusShape::quad, 8},          {"M3D8", AbaqusShape::quad, 8},          {"T3D2", AbaqusShape::line, 2},
    {"T3D3", AbaqusShape::line, 3},        {"T2D2", AbaqusShape::line, 2},          {"B31", AbaqusShape::line, 2},
    {"B32", AbaqusShape::line, 3},         {"B21", AbaqusShape::line, 2},           {"B22", AbaqusShape::line, 3}};

class CardReader {
 public:
  explicit CardReader(const std::filesystem::path& path) : deck_(path) {}

  AbaqusCards read() {
    if (deck_.next_data()) deck_.fail("data before the first keyword");
    while (deck_.next_keyword()) read_keyword(deck_.keyword());
    cards_.last_line = deck_.line();
    cards_.files = deck_.files();
    return std::move(cards_);
  }

 private:
  void read_keyword(const std::string& keyword) {
    if (keyword == "NODE") return read_nodes();
    if (keyword == "ELEMENT") return read_elements();
    if (keyword == "NSET") return read_set(AbaqusSetKind::nodes);
    if (keyword == "ELSET") return read_set(AbaqusSetKind::elements);
    if (keyword == "SURFACE") return read_surface();
    if (keyword == "PART") return begin_part();
    if (keyword == "ASSEMBLY") in_assembly_ = true;
    if (keyword == "END ASSEMBLY") in_assembly_ = false;
    if (keyword == "INSTANCE") return begin_instance();
    if (keyword == "END INSTANCE") in_instance_ = false;
    if (keyword == "SYSTEM") deck_.fail("*SYSTEM is not supported: write global Cartesian coordinates");
    static constexpr std::string_view generators[] = {"NCOPY", "NFILL",  "NGEN",   "NMAP",
                                                      "ELGEN", "ELCOPY", "IMPORT", "PARAMETER"};
    if (std::find(std::begin(generators), std::end(generators), keyword) != std::end(generators))
      deck_.fail("*" + keyword + " is not supported: write every node and element");
  }

  void read_nodes() {
    deck_.allow({"NSET"});
    refuse_in_assembly();
    std::vector<AbaqusItem> numbers;
    const AbaqusLine line = deck_.line();
    const std::string set = deck_.has("NSET") ? deck_.required("NSET") : "";
    while (deck_.next_data()) {
      if (deck_.fields().size() != 4)
        deck_.fail("a node is its number and 3 coordinates, here are " + std::to_string(deck_.fields().size()) +
                   " values");
      AbaqusNode node{deck_.integer(0, "node number"), Vec3::Zero(), deck_.line()};
      for (std::size_t axis = 0; axis < 3; ++axis) node.position[axis] = deck_.real(axis + 1, "coordinate");
      cards_.nodes.push_back(node);
      append_number(numbers, node.id);
    }
    if (!set.empty()) add_set(set, AbaqusSetKind::nodes, std::move(numbers), line);
  }

  void read_elements() {
    deck_.allow({"TYPE", "ELSET"});
    refuse_in_assembly();
    const ElementType type = type_of(upper_case(deck_.required("TYPE")));
    const AbaqusLine line = deck_.line();
    const std::string set = deck_.has("ELSET") ? deck_.required("ELSET") : "";
    std::vector<AbaqusItem> numbers;
    while (deck_.next_data()) {
      cards_.elements.push_back(read_element(type));
      append_number(numbers, cards_.elements.back().id);
    }
    if (!set.empty()) add_set(set, AbaqusSetKind::elements, std::move(numbers), line);
  }

  /// The rest of the name after the shape is its formulation (H, R, M, ...), which is irrelevant to a mesh.
  ElementType type_of(const std::string& type) const {
    for (const ElementType& known : element_types) {
      if (!type.starts_with(known.name)) continue;
      const char next = type.size() > known.name.size() ? type[known.name.size()] : 'X';
      if (next >= 'A' && next <= 'Z') return known;
    }
    deck_.fail("element type " + type.substr(0, 40) +
               " is not supported; read are the solids C3D4, C3D10 and C3D6, shells and flat elements of 3, 4, 6 or 8 "
               "nodes, and trusses and beams");
  }

  AbaqusElement read_element(const ElementType& type) {
    const std::size_t nodes = type.nodes;
    AbaqusElement element;
    element.shape = type.shape;
    element.count = nodes;
    element.line = deck_.line();
    element.id = deck_.integer(0, "element number");
    std::size_t count = 0;
    for (std::size_t field = 1;;) {
      for (; field < deck_.fields().size(); ++field) {
        if (count == nodes) deck_.fail("element has more than " + std::to_string(nodes) + " nodes");
        element.nodes[count++] = deck_.integer(field, "node number");
      }
      if (count == nodes) return element;
      if (!deck_.continued() || !deck_.next_data())
        deck_.fail("element has " + std::to_string(count) + " nodes, needs " + std::to_string(nodes));
      field = 0;
    }
  }

  void read_set(AbaqusSetKind kind) {
    const bool nodes = kind == AbaqusSetKind::nodes;
    if (nodes)
      deck_.allow({"NSET", "ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"});
    else
      deck_.allow({"ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"});
    const std::string name = deck_.required(nodes ? "NSET" : "ELSET");
    const AbaqusLine line = deck_.line();
    check_instance_parameter();
    std::vector<AbaqusItem> items;
    if (nodes && deck_.has("ELSET")) {
      AbaqusItem item = make_item(deck_.required("ELSET"));
      item.element_nodes = true;
      items.push_back(std::move(item));
    }
    const bool generate = deck_.has("GENERATE");
    while (deck_.next_data()) {
      if (generate)
        items.push_back(read_range());
      else
        for (std::size_t i = 0; i < deck_.fields().size(); ++i) items.push_back(make_item(deck_.fields()[i]));
    }
    add_set(name, kind, std::move(items), line);
  }

  AbaqusItem read_range() {
    const std::size_t count = deck_.fields().size();
    if (count != 2 && count != 3) deck_.fail("GENERATE needs first, last and step");
    AbaqusItem item;
    item.line = deck_.line();
    item.first = deck_.integer(0, "first number");
    item.last = deck_.integer(1, "last number");
    item.step = count == 3 ? deck_.integer(2, "step") : 1;
    if (item.last < item.first) deck_.fail("the last number is below the first");
    if ((item.last - item.first) % item.step != 0) deck_.fail("the step does not lead from first to last");
    return item;
  }

  void read_surface() {
    deck_.allow({"NAME", "TYPE", "INTERNAL"});
    const std::string name = deck_.required("NAME");
    const AbaqusLine line = deck_.line();
    const std::string type = deck_.has("TYPE") ? upper_case(deck_.value("TYPE")) : "ELEMENT";
    if (type != "ELEMENT" && type != "NODE")
      deck_.fail("surface '" + name + "' has TYPE=" + deck_.value("TYPE") +
                 "; only TYPE=ELEMENT and TYPE=NODE are read");
    const bool of_nodes = type == "NODE";
    std::vector<AbaqusItem> items;
    while (deck_.next_data()) {
      if (deck_.fields().size() > 2) deck_.fail("a line of *SURFACE is an element or element set and a face S1 to S5");
      AbaqusItem item = make_item(deck_.fields()[0]);
      if (!of_nodes) item.face = face_in(deck_.fields().size() == 2 ? upper_case(deck_.fields()[1]) : "");
      items.push_back(std::move(item));
    }
    add_set(name, of_nodes ? AbaqusSetKind::nodes : AbaqusSetKind::surface, std::move(items), line);
  }

  [[nodiscard]] int face_in(const std::string& face) const {
    if (face.empty() || face == "SPOS" || face == "SNEG") return 0;
    if (face.size() != 2 || face[0] != 'S' || face[1] < '1' || face[1] > '5')
      deck_.fail("face must be S1 to S5, or SPOS or SNEG of a shell, not '" + face.substr(0, 40) + "'");
    return face[1] - '0';
  }

  /// A number, or the name of a set; an assembly may write INSTANCE.NUMBER and INSTANCE.NAME.
  AbaqusItem make_item(std::string_view text) const {
    if (!instance_.empty() && upper_case(text).starts_with(upper_case(instance_) + "."))
      text.remove_prefix(instance_.size() + 1);
    AbaqusItem item;
    item.line = deck_.line();
    if (text.empty()) deck_.fail("an entry of the list is empty");
    if (parse_integer(text, item.first))
      item.last = item.first;
    else
      item.name = text;
    return item;
  }

  void begin_part() {
    if (++parts_ > 1) deck_.fail("several parts are not supported: merge them into one mesh");
    part_ = deck_.value("NAME");
  }

  void begin_instance() {
    if (!instance_.empty()) deck_.fail("several instances are not supported: merge them into one mesh");
    deck_.allow({"NAME", "PART"});
    instance_ = deck_.required("NAME");
    in_instance_ = true;
    if (upper_case(deck_.required("PART")) != upper_case(part_))
      deck_.fail("instance of the unknown part '" + deck_.value("PART") + "'");
    for (bool translation = true; deck_.next_data(); translation = false)
      for (std::size_t i = 0; i < deck_.fields().size(); ++i)
        if (!translation || deck_.real(i, "translation") != 0)
          deck_.fail("an instance that is moved is not supported: write the part where it belongs");
  }

  void refuse_in_assembly() const {
    if (in_assembly_ && !in_instance_)
      deck_.fail("*" + deck_.keyword() + " of the assembly itself (a reference point, say) is not supported");
  }

  void check_instance_parameter() const {
    if (deck_.has("INSTANCE") && upper_case(deck_.value("INSTANCE")) != upper_case(instance_))
      deck_.fail("unknown instance '" + deck_.value("INSTANCE") + "'");
  }

  /// Consecutive numbers are merged into one item.
  void append_number(std::vector<AbaqusItem>& items, std::int64_t id) const {
    if (!items.empty() && items.back().last + 1 == id) {
      items.back().last = id;
      return;
    }
    AbaqusItem item;
    item.first = item.last = id;
    item.line = deck_.line();
    items.push_back(std::move(item));
  }

  void add_set(const std::string& name, AbaqusSetKind kind, std::vector<AbaqusItem> items, AbaqusLine line) {
    if (items.empty()) throw InvalidInput(deck_.origin(line), "'" + name + "' has no members");
    cards_.sets.push_back({name, kind, in_assembly_ && !in_instance_, std::move(items), line});
  }

  AbaqusDeck deck_;
  AbaqusCards cards_;
  int parts_ = 0;
  std::string part_, instance_;
  bool in_assembly_ = false, in_instance_ = false;
};

}  // namespace

AbaqusCards read_abaqus_cards(const std::filesystem::path& path) {
  return CardReader(path).read();
}

}  // namespace softkin
