#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <softkin/core/error.hpp>
#include <vector>

#include "command.hpp"

namespace softkin::cli {

namespace {

namespace fs = std::filesystem;

/// softkin-measure, which is next to this program; or, where pip installed it among Python's packages, in bin of a
/// folder above, as a program of Python's. Empty where there is none.
fs::path measuring_program() {
  constexpr int max_above = 4;  // PREFIX/lib/python3.11/site-packages/softkin.scripts/softkin
  fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  if (fs::path program = folder / "softkin-measure"; fs::exists(program)) return program;
  if (folder.filename() != "softkin.scripts") return {};
  for (int above = 0; above < max_above; ++above) {
    folder = folder.parent_path();
    if (fs::path program = folder / "bin" / "softkin-measure"; fs::exists(program)) return program;
  }
  return {};
}

int become_measure(std::vector<std::string> arguments) {
  const fs::path program = measuring_program();
  if (program.empty())
    throw InvalidInput(
        "measure: this softkin was built without OpenCV 4.5 or 4.6; install it (apt-get install libopencv-dev, 140 MB) "
        "and build again");
  arguments.insert(arguments.begin(), "softkin measure");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  throw InvalidInput({program.string()}, std::string("cannot be started: ") + std::strerror(errno));
}

}  // namespace

void add_measure(CLI::App& app, Run& run) {
  CLI::App& command = *app.add_subcommand(
      "measure", "Measure in pictures: markers, specimens, angles, tracks, outlines; in mm (softkin measure --help)");
  command.prefix_command();
  command.set_help_flag();
  command.callback([&command, &run] { run = [arguments = command.remaining()] { return become_measure(arguments); }; });
}

}  // namespace softkin::cli
