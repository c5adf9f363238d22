#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/changes.hpp>
#include <utility>

namespace softkin::scene {

namespace {

using Shared = std::shared_ptr<const Node>;

/// What an entry of a list is called: its name, its region, or itself; of a material without a region "all".
/// Words are their own names; numbers have none but their place.
std::string name_of_item(const Node& list, const Node& item) {
  double value = 0;
  if (item.kind == Node::Kind::scalar) return parse_real(item.text, value) ? "" : item.text;
  for (const char* key : {"name", "region"})
    for (const Node::Entry& entry : item.entries)
      if (entry.key == key && entry.value->kind == Node::Kind::scalar) return entry.value->text;
  return list.name == "'materials'" ? "all" : "";
}

/// Follows a path and copies what is on it: all else is shared with the scene as it was.
class Change {
 public:
  Change(const std::string& option, const std::string& text) : reported_(option + " " + excerpt(text)) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) refuse("expected PATH=VALUE");
    path_ = trimmed(std::string_view(text).substr(0, equals));
    const std::string value(trimmed(std::string_view(text).substr(equals + 1)));
    if (value.empty()) refuse("the value is missing");
    if (path_.empty()) refuse("the path is missing");
    value_ = std::make_shared<Node>(*parse_yaml(value, reported_));
    value_->origin = {.file = reported_};
  }

  /// What stands at the path now; null: a key that its entry does not have.
  [[nodiscard]] Shared found(const Shared& root) const {
    Shared node = root;
    for (std::string path = path_; !path.empty();) {
      if (node->kind == Node::Kind::list) {
        const auto [at, rest] = item_of(*node, path);
        node = node->items[at];
        path = rest;
        continue;
      }
      const std::string key = path.substr(0, path.find('.'));
      const auto entry = std::find_if(node->entries.begin(), node->entries.end(),
                                      [&](const Node::Entry& each) { return each.key == key; });
      if (entry == node->entries.end()) {
        if (key.size() == path.size()) return nullptr;
        (void)within_of(*node, path);  // reports the error
        return nullptr;
      }
      node = entry->value;
      path = key.size() == path.size() ? "" : path.substr(key.size() + 1);
    }
    return node;
  }

  [[noreturn]] void refuse(const std::string& why) const { throw InvalidInput({.file = reported_}, why); }

  [[nodiscard]] Shared made(const Shared& root, const std::string& within) const {
    return within_of(*root, within.empty() ? path_ : within + "." + path_);
  }

 private:
  [[nodiscard]] Shared named_value(const std::string& name) const {
    auto node = std::make_shared<Node>(*value_);
    node->name = name;
    return node;
  }

  [[nodiscard]] Shared within_of(const Node& node, const std::string& path) const {
    if (node.kind == Node::Kind::map) return within_map(node, path);
    if (node.kind == Node::Kind::list) return within_list(node, path);
    refuse(node.name + " has no parts that " + excerpt(path) + " could be one of");
  }

  [[nodiscard]] Shared within_map(const Node& map, const std::string& path) const {
    const std::size_t dot = path.find('.');
    const std::string key = path.substr(0, dot);
    auto copy = std::make_shared<Node>(map);
    const auto found =
        std::find_if(copy->entries.begin(), copy->entries.end(), [&](const auto& each) { return each.key == key; });
    const bool here = found != copy->entries.end();
    if (dot == std::string::npos) {  // an unknown key is refused where the scene is read
      if (here)
        found->value = named_value(found->value->name);
      else
        copy->entries.push_back({key, {.file = reported_}, named_value(excerpt(key))});
      return copy;
    }
    if (!here) {
      Keys keys;
      for (const Node::Entry& entry : map.entries) keys.push_back(entry.key);
      const bool robots = std::find(keys.begin(), keys.end(), "robots") != keys.end();
      refuse("there is no " + excerpt(key) + " in " + map.name + suggest_name(key, keys) +
             (robots ? "; what a robot has of its own stands in its scene" : ""));
    }
    found->value = within_of(*found->value, path.substr(dot + 1));
    return copy;
  }

  [[nodiscard]] Shared within_list(const Node& list, const std::string& path) const {
    const auto [at, rest] = item_of(list, path);
    auto copy = std::make_shared<Node>(list);
    Shared& item = copy->items[at];
    if (!rest.empty())
      item = within_of(*item, rest);
    else if (item->kind == Node::Kind::map)
      refuse("say which number of " + item->name + " is changed, such as " + path_ + ".KEY=VALUE");
    else
      item = named_value(item->name);
    return copy;
  }

  /// The entry of a list that a path begins with, and what of the path is left. Names may have dots themselves.
  [[nodiscard]] std::pair<std::size_t, std::string> item_of(const Node& list, const std::string& path) const {
    std::size_t at = list.items.size(), longest = 0;
    bool several = false;
    Keys names;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
      const std::string number = std::to_string(i + 1), own = name_of_item(list, *list.items[i]);
      names.push_back(own.empty() ? number : own);
      for (const std::string& name : {own, number}) {
        if (name.empty() || !(path == name || path.starts_with(name + ".")) || name.size() < longest) continue;
        several = name.size() == longest && at != i;
        longest = name.size();
        at = i;
      }
    }
    const std::string requested = path.substr(0, path.find('.'));
    if (at == list.items.size())
      refuse("there is no " + excerpt(requested) + " in " + list.name + suggest_name(requested, names));
    if (several)
      refuse(list.name + " has several of the name " + excerpt(path.substr(0, longest)) +
             ": give the number of the one that is meant, from 1");
    return {at, path.size() == longest ? "" : path.substr(longest + 1)};
  }

  std::string reported_, path_;
  std::shared_ptr<Node> value_;
};

}  // namespace

double number_at(const Shared& root, const std::string& option, const std::string& path) {
  const Change change(option, path + "=0");
  const Shared node = change.found(root);
  if (!node)
    throw InvalidInput(option + " " + path + ": the scene has no such number: begin at one, " + path + "=START");
  if (node->kind != Node::Kind::scalar) change.refuse("it is no number but a list or a map: name one of its numbers");
  return number(*node);
}

Shared changed(const Shared& root, const std::string& option, const std::string& change, const std::string& within) {
  return Change(option, change).made(root, within);
}

}  // namespace softkin::scene
