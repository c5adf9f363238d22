#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softkin {

/// What a user commands of an example.
struct ExampleActuator {
  std::string name, kind, unit;  // unit: "" of ratios
  double low = 0, high = 0;      // its range
};

/// A file of an example that does not come with softkin.
struct MissingFile {
  std::string file;    // relative to the folder of all examples: "real/beam/beam.mesh"
  std::string source;  // "'python3 real/beam/make_beam.py' makes it"; empty: not known
};

/// A robot that comes with softkin, or measurements to try it with: a folder.
struct Example {
  std::string name;        // of the folder, from that of all examples: "pneumatic_finger", "real/beam"
  std::string short_name;  // that does as well; may be empty
  std::string title;       // the heading of its README
  std::vector<std::string>
      command;        // the first of its README, to be typed in the folder above; softkin is its first word
  std::string scene;  // that the command solves: "NAME/SCENE.yaml"; empty: none
  std::vector<ExampleActuator> actuators;  // of the scene: those of the robot; none where files are missing
  std::vector<MissingFile> missing{};      // that do not come with softkin
};

/// The folder of all examples: share/softkin/examples in one of the folders above this program or library.
///
/// throws  InvalidInput: there is none
[[nodiscard]] std::filesystem::path examples_above(const std::filesystem::path& file);

/// All of them, sorted by name.
///
/// throws  InvalidInput naming the unreadable file
[[nodiscard]] std::vector<Example> all_examples(const std::filesystem::path& folder);

/// One by its name, its short name, or a beginning that no other name has; without its actuators, which take reading
/// its mesh.
///
/// throws  InvalidInput naming the nearest ones
[[nodiscard]] Example find_example(const std::filesystem::path& folder, const std::string& name);

struct CopiedExample {
  Example example;                           // its command is to be run where the copy was requested
  std::vector<std::filesystem::path> files;  // all that are there now, those of its neighbours last
};

/// Copies an example into a folder of its name below `to`, with those beside it whose meshes it takes. Commands in its
/// README lose what they have of the sources' places.
///
/// throws  InvalidInput, before anything is written, where a file is there that is not the same and may not be replaced
[[nodiscard]] CopiedExample copy_example(const std::filesystem::path& folder, const std::string& name,
                                         const std::filesystem::path& to, bool may_replace = false);

[[nodiscard]] std::string to_json(const std::vector<Example>& examples);
[[nodiscard]] std::string to_json(const CopiedExample& copied);

}  // namespace softkin
