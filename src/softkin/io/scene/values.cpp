#include <algorithm>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/values.hpp>

namespace softkin::scene {

namespace {

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

[[noreturn]] void fail_type(const Node& node, const std::string& expected) {
  fail(node, node.name + " must be " + expected + ", not " + shown(node));
}

}  // namespace

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
                         "unknown key " + excerpt(each.key) + " in " + node.name + suggest_name(each.key, known));
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

double number(const Node& node) {
  double value = 0;
  if (node.kind != Node::Kind::scalar || !node.plain || !parse_real(node.text, value))
    fail_type(node, "a finite number");
  return value;
}

double positive(const Node& node) {
  const double value = number(node);
  if (value <= 0) fail(node, node.name + " must be greater than 0, not " + node.text);
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
  return static_cast<std::size_t>(found - choices.begin());
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
