#pragma once

#include <cstdint>
#include <softkin/core/types.hpp>
#include <softkin/io/scene/tree.hpp>
#include <string_view>

namespace softkin::scene {

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

// Each fails, naming key and line, where the value is not of its kind.
[[nodiscard]] double number(const Node& node);
[[nodiscard]] double positive(const Node& node);
[[nodiscard]] std::int64_t integer(const Node& node);
[[nodiscard]] const std::string& text(const Node& node);
[[nodiscard]] Vec3 read_vector(const Node& node);  // three numbers
/// Position of the value among choices.
[[nodiscard]] std::size_t choice(const Node& node, const Keys& choices);
[[nodiscard]] const std::vector<std::shared_ptr<const Node>>& list(const Node& node);
[[nodiscard]] const std::vector<std::shared_ptr<const Node>>& list_of(std::size_t count, const Node& node);

}  // namespace softkin::scene
