#pragma once

#include <memory>
#include <softkin/core/error.hpp>
#include <string>
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

/// The one YAML document of a text. Aliases share their anchor's node.
/// throws  InvalidInput on text that is not UTF-8 or not YAML, an empty text, several documents, a key given twice,
///         keys that are not words, tags, an alias within its own anchor
[[nodiscard]] std::shared_ptr<const Node> parse_yaml(const std::string& text, const std::string& file);

}  // namespace softkin::scene
