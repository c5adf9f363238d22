#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <stdexcept>

#include "fuzz/targets.hpp"

// softkin_fuzz --target=NAME [options of libFuzzer] [corpora or inputs]; --list prints targets and dictionaries, --show
// prints for every input why it was refused.

namespace softkin::fuzz {

namespace fs = std::filesystem;

Input::Input(std::string_view text, fs::path folder) : folder_(std::move(folder)) {
  constexpr std::string_view between = "%%%\n";
  for (std::size_t end; (end = text.find(between)) != std::string_view::npos; text.remove_prefix(end + between.size()))
    parts_.push_back(text.substr(0, end));
  parts_.push_back(text);
}

std::string Input::part(std::size_t number) const {
  return number < parts_.size() ? std::string(parts_[number]) : "";
}

fs::path Input::file(const std::string& name, std::size_t number) const {
  const fs::path file = path(name);
  if (number >= parts_.size()) {
    fs::remove(file);
    return file;
  }
  std::ofstream stream(file, std::ios::binary);
  stream.write(parts_[number].data(), static_cast<std::streamsize>(parts_[number].size()));
  require(stream.good(), "the temporary folder cannot be written to");
  return file;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

void require_finite(double value, const char* what) {
  require(std::isfinite(value), what);
}

namespace {

/// What the run is about.
struct Run {
  Target target{};
  fs::path folder;
  bool show = false;

  ~Run() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

Run& the_run() {
  static Run run;
  return run;
}

[[noreturn]] void list_targets() {
  for (const Target& target : all_targets()) std::printf("%s %s\n", target.name, target.dictionary);
  std::exit(0);
}

/// A refusal is one sentence that is safe to print.
void check_refusal(const std::string& message) {
  require(!message.empty(), "an error says nothing");
  const bool one_line = message.find_first_of("\r\n") == std::string::npos;
  if (!one_line || find_unprintable(message) != std::string::npos) {
    std::fprintf(stderr, "message: %s\n", message.c_str());
    require(false, "an error is not one line of text");
  }
}

}  // namespace

}  // namespace softkin::fuzz

using namespace softkin;

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  const std::string option = "--target=";
  std::string name;
  for (int i = 1; i < *count; ++i) {
    const std::string argument = (*arguments)[i];
    if (argument == "--list") fuzz::list_targets();
    if (argument == "--show") fuzz::the_run().show = true;
    if (argument.starts_with(option)) name = argument.substr(option.size());
  }
  fuzz::Run& run = fuzz::the_run();
  for (const fuzz::Target& target : fuzz::all_targets())
    if (target.name == name) run.target = target;
  if (run.target.run == nullptr) {
    std::fprintf(stderr, "softkin_fuzz: --target=NAME with a NAME of --list is needed, not '%s'\n", name.c_str());
    std::exit(2);
  }
  run.folder = std::filesystem::temp_directory_path() / ("softkin_fuzz." + std::to_string(::getpid()));
  std::filesystem::create_directories(run.folder);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Run& run = fuzz::the_run();
  try {
    run.target.run({{reinterpret_cast<const char*>(data), size}, run.folder});
  } catch (const InvalidInput& error) {
    fuzz::check_refusal(error.what());
    if (run.show) std::fprintf(stderr, "refused: %s\n", error.what());
  }
  return 0;
}
