#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/runs/solver_options_file.hpp>

namespace softkin::runs {

namespace {

/// Calls a function and adds the place in the file to its messages.
template <class Call>
void call_at(const Origin& origin, const Call& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    throw InvalidInput(origin, error.what());
  }
}

const std::vector<scene::Node::Entry>& entries_of(const scene::Node& node, const char* what) {
  if (node.kind != scene::Node::Kind::map) scene::fail(node, what);
  return node.entries;
}

}  // namespace

SolverOptions read_solver_options(const std::filesystem::path& file) {
  SolverOptions options;
  const std::shared_ptr<const scene::Node> root = scene::parse_yaml(read_file(file), file.string());
  for (const scene::Node::Entry& group :
       entries_of(*root, "solver options are a map of groups, such as 'step:' with 'max_turn: 20' below it")) {
    call_at(group.origin, [&] { check_option_group(group.key); });
    for (const scene::Node::Entry& option :
         entries_of(*group.value, "a group of options is a map of names and numbers, such as 'max_turn: 20'")) {
      const double value = scene::number(*option.value);
      call_at(option.origin, [&] { set_option(options, group.key, option.key, value); });
    }
  }
  return options;
}

}  // namespace softkin::runs
