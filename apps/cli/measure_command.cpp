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

/// Becomes softkin-measure, which stands beside this program where OpenCV was there when it was built.
int become_measure(std::vector<std::string> arguments) {
  namespace fs = std::filesystem;
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "softkin-measure";
  if (!fs::exists(program))
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
      "measure", "Measure in pictures: markers, specimens, angles, tracks; in mm (softkin measure --help)");
  command.prefix_command();
  command.set_help_flag();
  command.callback([&command, &run] { run = [arguments = command.remaining()] { return become_measure(arguments); }; });
}

}  // namespace softkin::cli
