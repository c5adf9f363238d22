#pragma once

#include <cstdint>
#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin::scene {

/// A YAML value with its place in the scene.
struct Node {
  enum class Kind { nothing, scalar, list, map };
  struct Entry {
    std::string key;
    Origin origin;
    std::shared_ptr<const Node> value;
  };

  Kind kind = Kind::nothing;
  Origin origin;
  std::string name;                                // for messages: "'range'", "entry 2 of 'range'"
  std::string text;                                // scalar
  bool plain = true;                               // scalar without quotes
  std::vector<std::shared_ptr<const Node>> items;  // list
  std::vector<Entry> entries;                      // map, in order, keys unique
};

/// The one YAML document of a text. Aliases refer to the node of their anchor.
/// throws  InvalidInput on text that is not UTF-8 or not YAML, an empty text, several documents, a key given twice,
///         keys that are not words, tags, an alias within its own anchor
[[nodiscard]] std::shared_ptr<const Node> parse_yaml(const std::string& text, const std::string& file);

using Keys = std::vector<std::string>;

/// A map of which every key is known.
class Map {
 public:
  Map(const Node& node, const Keys& known);

  [[nodiscard]] const Node& node() const { return node_; }
  [[nodiscard]] const Node::Entry* entry(std::string_view key) const;
  [[nodiscard]] const Node* find(std::string_view key) const;  // nullptr: absent
  [[nodiscard]] const Node& at(std::string_view key) const;    // fails where absent
  [[nodiscard]] const Node::Entry& one_of(Keys keys) const;    // fails unless exactly one is there

 private:
  const Node& node_;
};

[[noreturn]] void fail(const Node& node, const std::string& message);

/// "'a', 'b'"
[[nodiscard]] std::string joined(const Keys& keys);

/// Fails unless the file is a map with this key, whose value is 1.
///
/// what      "scenes"; of the message where it is of another version
/// no_map, missing   messages where it is no map, or the key is not there
void check_version(const Node& root, const std::string& key, const std::string& what, const std::string& no_map,
                   const std::string& missing);

// Each fails, naming key and line, where the value is not of its kind.
[[nodiscard]] double number(const Node& node);
[[nodiscard]] double positive(const Node& node);
[[nodiscard]] double not_negative(const Node& node);
[[nodiscard]] std::int64_t integer(const Node& node);
[[nodiscard]] const std::string& text(const Node& node);
[[nodiscard]] Vec3 read_vector(const Node& node);  // three numbers
/// Fails where a map has a key, on which depends which other keys it takes, with a value that is none of the choices:
/// so that a wrong value is reported before the keys that would go with it.
void check_choice(const Node& node, std::string_view key, const Keys& choices);
/// Position of the value among choices.
[[nodiscard]] std::size_t choice(const Node& node, const Keys& choices);
[[nodiscard]] const std::vector<std::shared_ptr<const Node>>& list(const Node& node);
[[nodiscard]] const std::vector<std::shared_ptr<const Node>>& list_of(std::size_t count, const Node& node);

}  // namespace softkin::scene
