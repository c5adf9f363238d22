#include <filesystem>
#include <memory>
#include <softkin/io/examples.hpp>
#include <softkin/runs/page.hpp>

#include "command.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

struct ExamplesOptions {
  std::string name, folder = ".";
  bool json = false, may_replace = false;
};

std::filesystem::path examples_folder() {
  return examples_above(std::filesystem::read_symlink("/proc/self/exe"));
}

/// "air1, air2, air3: 1 to 1.6"; those of another range after a semicolon.
std::string actuators_text(const std::vector<ExampleActuator>& actuators) {
  std::string text, last;
  for (const ExampleActuator& each : actuators) {
    const std::string range =
        ": " + number(each.low) + " to " + number(each.high) + (each.unit.empty() ? "" : " " + each.unit);
    if (range != last) text += last + (text.empty() ? "" : "; ");
    if (range == last) text += ", ";
    text += each.name;
    last = range;
  }
  return text.empty() ? "none" : text + last;
}

/// What has to be made or fetched before an example runs, a line for each file.
std::string missing_text(const Example& example) {
  std::string text;
  for (const MissingFile& each : example.missing)
    text += example.name + " needs " + each.file + ", which does not come with softkin" +
            (each.source.empty() ? "" : ": " + each.source) + "\n";
  return text;
}

int run_list(const ExamplesOptions& options) {
  const std::vector<Example> examples = all_examples(examples_folder());
  if (options.json) {
    print(to_json(examples) + "\n");
    return done;
  }
  const auto column = [](const char* key) { return Column{.key = key, .left = true}; };
  Table table{{column("name"), column("short"), column("what it is"), column("actuators")}};
  for (const Example& each : examples)
    table.rows.push_back({each.name, each.short_name, each.title,
                          each.missing.empty() ? actuators_text(each.actuators) : "not known yet: see below"});
  print(table_text(table));
  for (const Example& each : examples) print(missing_text(each));
  return done;
}

int run_copy(const ExamplesOptions& options) {
  const CopiedExample copied = copy_example(examples_folder(), options.name, options.folder, options.may_replace);
  if (options.json) {
    print(to_json(copied) + "\n");
    return done;
  }
  const auto place = std::filesystem::path(options.folder) / copied.example.name;
  print(copied.example.title + ": " + counted(copied.files.size(), "file") + ", " + place.lexically_normal().string() +
        "\n" + missing_text(copied.example) + "next:\n  " + runs::command_line(copied.example.command) + "\n");
  return done;
}

void declare_list(CLI::App& command, ExamplesOptions& options) {
  command.add_flag("--json", options.json, "Print JSON; ranges are in the actuators' units");
}

void declare_copy(CLI::App& command, ExamplesOptions& options) {
  command.add_option("NAME", options.name, "Example: its name, its short one, or a beginning that no other has")
      ->type_name("")
      ->required();
  add_value(command, "FOLDER", options.folder, "", "Folder for the example's own (default: here)");
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, "Print JSON");
}

}  // namespace

void add_examples(CLI::App& app, Run& run) {
  CLI::App& examples = *app.add_subcommand("examples", "Robots that come with softkin: list them, copy one");
  examples.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  examples.callback([&examples] {
    if (examples.get_subcommands().empty()) throw CLI::RequiredError("a subcommand of examples (list, copy)");
  });
  examples.footer("Example:\n  softkin examples copy finger");
  add_command(examples, run, "list", "Names of the examples, what they are, their actuators and ranges",
              "Example:\n  softkin examples list", &declare_list, &run_list);
  add_command(
      examples, run, "copy", "Copy an example, with what it takes of others, and say what to type next",
      "A file that is there already stays as it is: where it is not the same as the example's, nothing is copied.\n"
      "Examples:\n  softkin examples copy finger\n  softkin examples copy two_fingers robots",
      &declare_copy, &run_copy);
}

}  // namespace softkin::cli
