#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <softkin/core/error.hpp>
#include <softkin/io/examples.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/missing_file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/model/names.hpp>
#include <sstream>
#include <utility>

namespace softkin {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<const char*, const char*> short_names[] = {
    {"bar", "two_material_bar"},
    {"cantilever", "magnetic_cantilever"},
    {"chambers", "three_chamber_actuator"},
    {"crawler", "dea_crawler"},
    {"feel", "estimate"},
    {"fibres", "fibre_actuator"},
    {"finger", "pneumatic_finger"},
    {"gripper", "cable_gripper"},
    {"muscle", "mckibben"},
    {"paper_belly", "paper_finger"},
    {"pouch", "pouch_motor"},
    {"strip", "acrylic_strip"},
    {"tendons", "three_tendon_finger"},
    {"two_fingers", "two_finger_gripper"},
    {"two_materials", "cable_gripper_two_materials"},
};

constexpr const char* readme = "README.md";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

/// Commands of the sources' documents as they are typed next to a copy.
std::string beside_copy(const std::string& text) {
  return replaced(replaced(text, "build/softkin ", "softkin "), " examples/", " ");
}

/// Folders with a README, and those within folders without one: "real/beam".
std::vector<std::string> names_of(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory()) continue;
    if (fs::exists(entry.path() / readme)) {
      names.push_back(name);
      continue;
    }
    for (const auto& inner : fs::directory_iterator(entry.path()))
      if (fs::exists(inner.path() / readme)) names.push_back(name + "/" + inner.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Values of the keys `file` in a tree.
void add_files(const scene::Node& node, std::vector<std::string>& files) {
  for (const auto& item : node.items) add_files(*item, files);
  for (const scene::Node::Entry& entry : node.entries) {
    if (entry.key == "file" && entry.value->kind == scene::Node::Kind::scalar) files.push_back(entry.value->text);
    add_files(*entry.value, files);
  }
}

/// Files that a scene names and that are not there. folder: of all examples
std::vector<MissingFile> missing_files(const fs::path& folder, const std::string& scene) {
  std::vector<std::string> files;
  add_files(*scene::parse_yaml(read_file(folder / scene), scene), files);
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  std::vector<MissingFile> missing;
  const fs::path place = (folder / scene).parent_path(), shown = fs::path(scene).parent_path();
  for (const std::string& file : files) {
    if (fs::exists(place / file)) continue;
    missing.push_back({(shown / file).string(),
                       replaced(source_of_missing(place, place / file), place.string() + "/", shown.string() + "/")});
  }
  return missing;
}

Example read_example(const fs::path& folder, const std::string& name) {
  Example example;
  example.name = name;
  for (const auto& [word, of] : short_names)
    if (of == name) example.short_name = word;
  std::istringstream lines(read_file(folder / name / readme));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# ") && example.title.empty()) example.title = line.substr(2);
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "build/softkin") continue;
    words.str(beside_copy(line));
    words.clear();
    words >> word;
    do {
      do
        if (word != "\\") example.command.push_back(word);
      while (words >> word);
      words.clear();  // a command continues after a line that ends with a backslash
    } while (word == "\\" && std::getline(lines, line) && (words.str(beside_copy(line)), words >> word));
    break;
  }
  for (const std::string& word : example.command)
    if (word.ends_with(".yaml") && example.scene.empty()) example.scene = word;
  if (!example.scene.empty()) example.missing = missing_files(folder, example.scene);
  for (const std::string& word : example.command)  // measurements
    if (word.starts_with(name + "/") && word.ends_with(".csv") && !fs::exists(folder / word))
      example.missing.push_back({word, name + "/" + readme + " says where it comes from"});
  return example;
}

std::vector<ExampleActuator> actuators_of(const fs::path& scene) {
  std::vector<ExampleActuator> actuators;
  for (const Actuator& each : compile(read_scene(scene)).actuators)
    if (drives(each)) actuators.push_back({each.name, kind_name(each), command_unit(each), each.low, each.high});
  return actuators;
}

/// Files of the folder and of those in it, relative to the folder of all examples.
std::vector<fs::path> files_of(const fs::path& folder, const std::string& name) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder / name))
    if (entry.is_regular_file() && entry.path().extension() != ".pyc")  // pip compiles what it installs
      files.push_back(entry.path().lexically_relative(folder));
  std::sort(files.begin(), files.end());
  return files;
}

/// Examples that scenes of this one name: "../pneumatic_finger/pneumatic_finger.msh".
std::vector<std::string> neighbours_of(const fs::path& folder, const std::string& name) {
  static const std::regex place(R"(file: *\.\./(\w+)/)");
  std::vector<std::string> neighbours;
  for (const fs::path& file : files_of(folder, name)) {
    if (file.extension() != ".yaml") continue;
    const std::string text = read_file(folder / file);
    for (std::sregex_iterator found(text.begin(), text.end(), place), end; found != end; ++found)
      if (const std::string other = (*found)[1]; fs::exists(folder / other / readme)) neighbours.push_back(other);
  }
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  return neighbours;
}

Json json_of_example(const Example& example) {
  Json actuators = Json::array();
  for (const ExampleActuator& each : example.actuators)
    actuators.push_back(
        {{"name", each.name}, {"kind", each.kind}, {"unit", each.unit}, {"range", Json::array({each.low, each.high})}});
  Json missing = Json::array();
  for (const MissingFile& each : example.missing) missing.push_back({{"file", each.file}, {"source", each.source}});
  return {{"name", example.name},   {"short_name", example.short_name}, {"title", example.title},
          {"scene", example.scene}, {"actuators", actuators},           {"command", example.command},
          {"missing", missing}};
}

}  // namespace

fs::path examples_above(const fs::path& file) {
  for (fs::path folder = file.parent_path(), last; folder != last; last = folder, folder = folder.parent_path()) {
    std::error_code failure;
    if (fs::path examples = folder / "share/softkin/examples"; fs::is_directory(examples, failure)) return examples;
  }
  throw InvalidInput(
      "examples: they were not installed with this softkin: share/softkin/examples is in no folder above " +
      file.string());
}

std::vector<Example> all_examples(const fs::path& folder) {
  std::vector<Example> examples;
  for (const std::string& name : names_of(folder)) {
    examples.push_back(read_example(folder, name));
    if (Example& example = examples.back(); !example.scene.empty() && example.missing.empty())
      example.actuators = actuators_of(folder / example.scene);
  }
  return examples;
}

Example find_example(const fs::path& folder, const std::string& name) {
  const std::vector<std::string> names = names_of(folder);
  std::vector<std::string> known, meant;
  for (const std::string& each : names) {
    if (each == name) return read_example(folder, each);
    if (each.starts_with(name)) meant.push_back(each);
    known.push_back(each);
  }
  for (const auto& [word, of] : short_names) {
    if (word == name) return read_example(folder, of);
    known.emplace_back(word);
  }
  if (name.empty() || meant.empty()) {
    const bool near = !nearest_name(name, known).empty();
    throw InvalidInput("examples: there is none named " + excerpt(name) + suggest_name(name, near ? known : names));
  }
  if (meant.size() > 1) {
    std::string text = meant[0];
    for (std::size_t i = 1; i < meant.size(); ++i) text += (i + 1 < meant.size() ? ", " : " or ") + meant[i];
    throw InvalidInput("examples: " + excerpt(name) + " may be " + text);
  }
  return read_example(folder, meant[0]);
}

CopiedExample copy_example(const fs::path& folder, const std::string& name, const fs::path& to, bool may_replace) {
  CopiedExample copied{find_example(folder, name), {}};
  std::vector<std::string> wanted = neighbours_of(folder, copied.example.name);
  wanted.insert(wanted.begin(), copied.example.name);
  std::vector<std::pair<fs::path, std::string>> missing;
  for (const std::string& each : wanted)
    for (const fs::path& file : files_of(folder, each)) {
      const fs::path copy = to / file;
      std::string content = read_file(folder / file);
      if (file.filename() == readme) content = beside_copy(content);
      copied.files.push_back(copy);
      std::error_code failure;
      const bool exists = fs::exists(fs::symlink_status(copy, failure));
      if (exists && read_file(copy) == content) continue;
      if (exists && !may_replace)
        throw InvalidInput({copy.string()},
                           "is there already and not the example's: nothing was copied; --force-overwrite "
                           "replaces it");
      missing.emplace_back(copy, std::move(content));
    }
  std::vector<Output> outputs;
  for (const auto& [file, content] : missing) outputs.push_back({"examples copy", file});
  check_outputs(outputs, {}, true);
  const OutputFolders folders(outputs);
  for (const auto& [file, content] : missing) write_file(file, content);
  const std::string inside = copied.example.name + "/", copy = (to / inside).lexically_normal().string();
  for (std::string& word : copied.example.command)
    if (word.starts_with(inside)) word = (to / word).lexically_normal().string();
  for (MissingFile& each : copied.example.missing)
    each = {(to / each.file).lexically_normal().string(), replaced(each.source, inside, copy)};
  return copied;
}

std::string to_json(const std::vector<Example>& examples) {
  Json json = Json::array();
  for (const Example& example : examples) json.push_back(json_of_example(example));
  return json_text(json);
}

std::string to_json(const CopiedExample& copied) {
  Json json = json_of_example(copied.example);
  json.erase("actuators");
  for (const fs::path& file : copied.files) json["files"].push_back(file.string());
  return json_text(json);
}

}  // namespace softkin
