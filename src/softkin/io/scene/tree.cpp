#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>
#include <algorithm>
#include <map>
#include <optional>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/io/scene/yaml_slip.hpp>
#include <sstream>

namespace softkin::scene {

namespace {

/// Builds the tree from the parser's events. YAML::Node would lose the lines of keys and empty values.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& file) : file_(file) {}

  [[nodiscard]] const std::shared_ptr<Node>& root() const { return root_; }
  [[nodiscard]] const Origin& start() const { return start_; }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = origin(mark); }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(Node::Kind::nothing, mark, "?", anchor); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const std::shared_ptr<Node> node = make(Node::Kind::scalar, mark, tag, anchor);
    node->text = value;
    node->plain = tag != "!";
    attach(node);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end() ||
        std::any_of(open_.begin(), open_.end(), [&](const Open& open) { return open.node == found->second; }))
      throw InvalidInput(origin(mark), "an alias stands within its own anchor");
    attach(found->second);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({add(Node::Kind::list, mark, tag, anchor), {}});
  }
  void OnSequenceEnd() override { open_.pop_back(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({add(Node::Kind::map, mark, tag, anchor), {}});
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct Open {
    std::shared_ptr<Node> node;
    std::shared_ptr<const Node> key;  // map: key whose value comes next
  };

  [[nodiscard]] Origin origin(const YAML::Mark& mark) const {
    return {file_, mark.line < 0 ? 0 : static_cast<std::size_t>(mark.line) + 1};
  }

  std::shared_ptr<Node> make(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    auto node = std::make_shared<Node>();
    node->kind = kind;
    node->origin = origin(mark);
    if (!tag.empty() && tag != "?" && tag != "!")
      throw InvalidInput(node->origin, "the YAML tag " + excerpt(tag) + " is not supported");
    if (anchor != 0) anchors_[anchor] = node;
    return node;
  }

  std::shared_ptr<Node> add(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    const std::shared_ptr<Node> node = make(kind, mark, tag, anchor);
    attach(node);
    return node;
  }

  void attach(const std::shared_ptr<Node>& node) {
    if (open_.empty()) {
      root_ = node;
      if (node->name.empty()) node->name = "the scene";
      return;
    }
    Open& parent = open_.back();
    if (parent.node->kind == Node::Kind::list) {
      attach_to_list(*parent.node, node);
    } else if (!parent.key) {
      parent.key = checked_key(*parent.node, node);
    } else {
      attach_to_map(*parent.node, *parent.key, node);
      parent.key.reset();
    }
  }

  static void attach_to_list(Node& list, const std::shared_ptr<Node>& node) {
    if (node->name.empty()) node->name = "entry " + std::to_string(list.items.size() + 1) + " of " + list.name;
    // the parser places an empty entry at whatever follows it
    if (node->kind == Node::Kind::nothing) node->origin = list.origin;
    list.items.push_back(node);
  }

  static void attach_to_map(Node& map, const Node& key, const std::shared_ptr<Node>& node) {
    if (node->name.empty()) node->name = excerpt(key.text);
    if (node->kind == Node::Kind::nothing) node->origin = key.origin;
    map.entries.push_back({key.text, key.origin, node});
  }

  static std::shared_ptr<const Node> checked_key(const Node& map, const std::shared_ptr<Node>& node) {
    if (node->kind != Node::Kind::scalar) throw InvalidInput(node->origin, "a key of " + map.name + " must be a word");
    for (const Node::Entry& entry : map.entries)
      if (entry.key == node->text)
        throw InvalidInput(node->origin, "key " + excerpt(node->text) + " appears twice in " + map.name +
                                             "; first in line " + std::to_string(entry.origin.line));
    return node;
  }

  std::string file_;
  Origin start_;
  std::shared_ptr<Node> root_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::shared_ptr<Node>> anchors_;
};

void check_text(const std::string& text, const std::string& file) {
  const std::size_t bad = find_unprintable(text);
  if (bad == std::string::npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bad), '\n');
  throw InvalidInput({file, static_cast<std::size_t>(line)}, "the text holds a control character or is not UTF-8");
}

std::string shown(const Node& node) {
  switch (node.kind) {
    case Node::Kind::nothing:
      return "empty";
    case Node::Kind::scalar:
      return (node.plain ? "" : "the quoted text ") + excerpt(node.text);
    case Node::Kind::list:
      return "a list";
    case Node::Kind::map:
      return "a map";
  }
  return {};
}

/// The 5 of {nu: 0,5}, which is the key nu with 0 and the key 5 with nothing.
bool is_comma_rest(const Node::Entry& entry) {
  return entry.value->kind == Node::Kind::nothing && !entry.key.empty() &&
         entry.key.find_first_not_of("0123456789") == std::string::npos;
}

[[noreturn]] void fail_type(const Node& node, const std::string& expected) {
  fail(node, node.name + " must be " + expected + ", not " + shown(node));
}

}  // namespace

std::shared_ptr<const Node> parse_yaml(const std::string& text, const std::string& file) {
  check_text(text, file);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder(file);
    if (!parser.HandleNextDocument(builder) || !builder.root() || builder.root()->kind == Node::Kind::nothing)
      throw InvalidInput({file, 1}, "the scene is empty");
    TreeBuilder more(file);
    if (parser.HandleNextDocument(more))
      throw InvalidInput(more.start(), "a second YAML document begins; a scene is one document");
    return builder.root();
  } catch (const YAML::DeepRecursion& error) {
    throw InvalidInput({file, static_cast<std::size_t>(error.mark.line) + 1}, "lists and maps are nested too deeply");
  } catch (const YAML::Exception& error) {
    if (const auto slip = find_slip(text)) throw InvalidInput({file, slip->line}, "not valid YAML: " + slip->what);
    const std::size_t line = error.mark.is_null() ? 0 : static_cast<std::size_t>(error.mark.line) + 1;
    throw InvalidInput({file, line}, "not valid YAML: " + (error.msg.empty() ? "cannot be parsed" : error.msg));
  }
}

void fail(const Node& node, const std::string& message) {
  throw InvalidInput(node.origin, message);
}

std::string joined(const Keys& keys) {
  std::string text;
  for (const std::string& key : keys) text += (text.empty() ? "'" : ", '") + key + "'";
  return text;
}

Map::Map(const Node& node, const Keys& known) : node_(node) {
  if (node.kind != Node::Kind::map) fail_type(node, "a map with keys " + joined(known));
  for (const Node::Entry& each : node.entries)
    if (std::find(known.begin(), known.end(), each.key) == known.end())
      throw InvalidInput(each.origin,
                         "unknown key " + excerpt(each.key) + " in " + node.name +
                             (is_comma_rest(each) ? "; a number is written with a decimal point, not a comma"
                                                  : suggest_name(each.key, known)));
}

const Node::Entry* Map::entry(std::string_view key) const {
  for (const Node::Entry& each : node_.entries)
    if (each.key == key) return &each;
  return nullptr;
}

const Node* Map::find(std::string_view key) const {
  const Node::Entry* found = entry(key);
  return found ? found->value.get() : nullptr;
}

const Node& Map::at(std::string_view key) const {
  const Node* found = find(key);
  if (!found) fail(node_, node_.name + " needs key '" + std::string(key) + "'");
  return *found;
}

const Node::Entry& Map::one_of(Keys keys) const {
  const Node::Entry* found = nullptr;
  for (const Node::Entry& each : node_.entries) {
    if (std::find(keys.begin(), keys.end(), each.key) == keys.end()) continue;
    if (found)
      throw InvalidInput(each.origin,
                         node_.name + " has both '" + found->key + "' and '" + each.key + "'; give only one of them");
    found = &each;
  }
  if (!found) fail(node_, node_.name + " needs " + (keys.size() > 1 ? "one of " : "key ") + joined(keys));
  return *found;
}

void check_version(const Node& root, const std::string& key, const std::string& what, const std::string& no_map,
                   const std::string& missing) {
  if (root.kind != Node::Kind::map) fail(root, no_map);
  const auto version =
      std::find_if(root.entries.begin(), root.entries.end(), [&](const Node::Entry& each) { return each.key == key; });
  if (version == root.entries.end()) fail(root, missing);
  if (integer(*version->value) != 1)
    fail(*version->value, "this version of softkin reads " + what + " of version 1, not " + version->value->text);
}

double number(const Node& node) {
  double value = 0;
  if (node.kind != Node::Kind::scalar || !node.plain || !parse_real(node.text, value))
    fail(node, node.name + " must be a finite number, not " + shown(node) + decimal_comma_hint(node.text));
  return value;
}

double positive(const Node& node) {
  const double value = number(node);
  if (value <= 0) fail(node, node.name + " must be greater than 0, not " + node.text);
  return value;
}

double not_negative(const Node& node) {
  const double value = number(node);
  if (value < 0) fail(node, node.name + " must be 0 or more, not " + node.text);
  return value;
}

std::int64_t integer(const Node& node) {
  std::int64_t value = 0;
  if (node.kind != Node::Kind::scalar || !node.plain || !parse_integer(node.text, value)) fail_type(node, "an integer");
  return value;
}

const std::string& text(const Node& node) {
  if (node.kind != Node::Kind::scalar) fail_type(node, "a word");
  if (node.text.empty()) fail(node, node.name + " is empty");
  if (node.text.find_first_of("\t\r\n") != std::string::npos || find_unprintable(node.text) != std::string::npos)
    fail(node, node.name + " holds a control character: " + excerpt(node.text));
  return node.text;
}

std::size_t choice(const Node& node, const Keys& choices) {
  const std::string& value = text(node);
  const auto found = std::find(choices.begin(), choices.end(), value);
  if (found == choices.end())
    fail(node,
         node.name + " must be " + (choices.size() > 1 ? "one of " : "") + joined(choices) + ", not " + excerpt(value));
  return found - choices.begin();
}

void check_choice(const Node& node, std::string_view key, const Keys& choices) {
  if (node.kind != Node::Kind::map) return;
  for (const Node::Entry& each : node.entries)
    if (each.key == key) (void)choice(*each.value, choices);
}

const std::vector<std::shared_ptr<const Node>>& list(const Node& node) {
  if (node.kind != Node::Kind::list) fail_type(node, "a list");
  return node.items;
}

const std::vector<std::shared_ptr<const Node>>& list_of(std::size_t count, const Node& node) {
  if (list(node).size() != count)
    fail(node,
         node.name + " must be a list of " + std::to_string(count) + ", not of " + std::to_string(node.items.size()));
  return node.items;
}

Vec3 read_vector(const Node& node) {
  const auto& items = list_of(3, node);
  return {number(*items[0]), number(*items[1]), number(*items[2])};
}

}  // namespace softkin::scene
