#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/own_file.hpp>
#include <sstream>
#include <string>
#include <system_error>

namespace softkin {

namespace fs = std::filesystem;

namespace {

std::ifstream opened(const fs::path& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) throw InvalidInput({path.string()}, "no such file");
  if (fs::is_directory(path, failure)) throw InvalidInput({path.string()}, "is a folder, not a file");
  if (fs::is_character_file(path, failure) || fs::is_block_file(path, failure))  // may never end
    throw InvalidInput({path.string()}, "is a device, not a file");
  return std::ifstream(path, std::ios::binary);
}

constexpr std::string_view lfs_mark = "version https://git-lfs.github.com/spec/";

void refuse_pointer(const fs::path& path, std::string_view content) {
  if (content.starts_with(lfs_mark))
    throw InvalidInput({path.string()}, "is a Git LFS pointer, not the file itself; run `git lfs pull`");
}

}  // namespace

std::string read_file(const fs::path& path) {
  std::ifstream stream = opened(path);
  std::ostringstream content;
  std::error_code failure;
  if (!stream || !(content << stream.rdbuf())) {
    if (stream && fs::is_empty(path, failure)) return "";
    throw InvalidInput({path.string()}, "cannot be read");
  }
  std::string text = std::move(content).str();
  refuse_pointer(path, text);
  return text;
}

void refuse_lfs_pointer(const fs::path& path) {
  refuse_pointer(path, read_beginning(path, lfs_mark.size()));
}

std::string read_beginning(const fs::path& path, std::size_t most) {
  std::ifstream stream = opened(path);
  std::string content(most, '\0');
  if (!stream.read(content.data(), static_cast<std::streamsize>(most)) && !stream.eof())
    throw InvalidInput({path.string()}, "cannot be read");
  content.resize(stream.gcount());
  return content;
}

void write_file(const fs::path& path, std::string_view content) {
  write_file(path, [content](std::ostream& stream) {
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

namespace {

/// Makes what was written outlive the machine: else a crash may leave the new name with nothing in it.
void sync(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);  // a disk may know none
  ::close(descriptor);
}

}  // namespace

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  const fs::path part = path.string() + "." + std::to_string(::getpid()) + ".part";
  errno = 0;
  std::ofstream stream(part, std::ios::binary);
  if (stream) write(stream);
  stream.close();
  std::string why = errno != 0 ? std::strerror(errno) : "the disk does not take it";
  std::error_code failure;
  if (stream) {
    sync(part);
    fs::rename(part, path, failure);
    why = failure.message();
  }
  if (!stream || failure) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw InvalidInput({path.string()}, "cannot be written: " + why);
  }
}

namespace fs = std::filesystem;

namespace {

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// The same for every spelling of a path, whether the file exists or not.
fs::path resolved(const fs::path& file) {
  std::error_code failure;
  const fs::path result = fs::weakly_canonical(fs::absolute(file), failure);
  return failure ? fs::absolute(file) : result;
}

[[noreturn]] void refuse(const Output& output, const std::string& why) {
  throw InvalidInput(output.option + " " + output.file.string() + ": " + why);
}

/// ours: the file, or one that is written next to it
void check_own(const Output& output, const fs::path& ours) {
  std::error_code failure;
  if (!fs::exists(ours, failure)) return;
  bool own = false;
  try {
    own = is_own_file(ours) || (output.is_own && output.is_own(ours));
  } catch (const InvalidInput&) {  // an unreadable file counts as foreign
  }
  if (!own)
    refuse(output,
           (ours == output.file ? std::string() : "its " + ours.filename().string() + " ") +
               "is there already, and not by softkin: name another file, or add --force-overwrite to replace it");
}

/// Whatever is written for this output.
void check_all_own(const Output& output) {
  check_own(output, output.file);
  const std::string ending = output.file.extension().string();
  if (ending == ".json" || ending == ".skmap" || ending == ".yaml") check_own(output, journal_of(output.file));
  for (std::size_t i = 0; i < output.shapes; ++i) check_own(output, series_file(output.file, i));
  if (output.shapes > 0) check_own(output, stopped_file(output.file));
}

void check_series(const Output& output, const std::vector<fs::path>& inputs) {
  std::set<fs::path> beside;
  for (const fs::path& input : inputs)
    if (resolved(folder_of(input)) == resolved(folder_of(output.file))) beside.insert(input.filename());
  if (beside.empty()) return;
  for (std::size_t i = 0; i < output.shapes; ++i) {
    const fs::path name = series_file(output.file, i).filename();
    if (beside.count(name) > 0) refuse(output, "its " + name.string() + " would replace a file that is read");
  }
}

/// What write_file writes before it renames: NAME.PID.part. Returns NAME, or "".
std::string torn_name(std::string name) {
  const std::string end = ".part";
  if (name.size() < end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0) return "";
  name.resize(name.size() - end.size());
  const std::size_t dot = name.find_last_not_of("0123456789");
  return dot == std::string::npos || name[dot] != '.' || dot + 1 == name.size() ? "" : name.substr(0, dot);
}

constexpr const char* probe_begin = ".softkin.";

/// What OutputFolders writes to see whether it can.
std::string probe_name() {
  return probe_begin + std::to_string(::getpid());
}

bool is_probe(const std::string& name) {
  const std::string begin = probe_begin;
  return name.starts_with(begin) && name.size() > begin.size() &&
         name.find_first_not_of("0123456789", begin.size()) == std::string::npos;
}

bool is_left_over(const std::string& file, const std::set<std::string>& outputs) {
  const std::string torn = torn_name(file);
  return outputs.count(torn) > 0 || is_probe(torn) || is_probe(file);
}

}  // namespace

fs::path series_file(const fs::path& pvd, std::size_t step) {
  char number[24];
  std::snprintf(number, sizeof number, "_%04zu.vtu", step);
  return fs::path(pvd).replace_filename(pvd.stem().string() + number);
}

fs::path stopped_file(const fs::path& pvd) {
  return fs::path(pvd).replace_filename(pvd.stem().string() + "_stopped.vtu");
}

fs::path journal_of(const fs::path& output) {
  return output.string() + ".run";
}

void check_outputs(const std::vector<Output>& outputs, const std::vector<fs::path>& inputs, bool may_replace) {
  std::map<fs::path, std::string> taken;
  for (const Output& output : outputs) {
    std::error_code failure;
    if (!output.file.has_filename() || fs::is_directory(output.file, failure))
      refuse(output, "is a folder, not a file");
    if (fs::exists(output.file, failure) && !fs::is_regular_file(output.file, failure))
      refuse(output, "is no plain file and will not be replaced");
    const fs::path file = resolved(output.file);
    for (const fs::path& input : inputs)
      if (resolved(input) == file || fs::equivalent(input, file, failure))
        refuse(output, "would replace a file that is read");
    if (!taken.emplace(file, output.option).second) refuse(output, "is the file of " + taken[file]);
    check_series(output, inputs);
    if (!may_replace) check_all_own(output);
  }
}

OutputFolders::OutputFolders(const std::vector<Output>& outputs) {
  for (const Output& output : outputs) {
    const fs::path folder = folder_of(output.file);
    try {
      make(folder);
      const fs::path probe = folder / probe_name();
      write_file(probe, "");  // checks what permissions do not show, before the work and not after it
      fs::remove(probe);
    } catch (const fs::filesystem_error& failure) {
      remove_empty();
      refuse(output, "its folder cannot be made: " + failure.code().message());
    } catch (const InvalidInput&) {
      remove_empty();
      refuse(output, "its folder cannot be written to");
    }
  }
}

OutputFolders::~OutputFolders() {
  remove_empty();
}

void OutputFolders::make(const fs::path& folder) {
  if (fs::is_directory(folder)) return;
  if (fs::exists(folder)) throw fs::filesystem_error("", folder, std::make_error_code(std::errc::not_a_directory));
  if (folder.has_parent_path() && folder.parent_path() != folder) make(folder.parent_path());
  if (fs::create_directory(folder)) made_.push_back(folder);
}

void OutputFolders::remove_empty() const {
  std::error_code not_empty;
  std::for_each(made_.rbegin(), made_.rend(), [&](const fs::path& folder) { fs::remove(folder, not_empty); });
}

void remove_torn_files(const std::vector<Output>& outputs) {
  for (const Output& output : outputs) {
    const std::string name = output.file.filename().string();
    std::set<std::string> names{name, journal_of(output.file).filename().string()};
    for (std::size_t i = 0; i < output.shapes; ++i) names.insert(series_file(output.file, i).filename().string());
    std::vector<fs::path> torn;
    for (const auto& entry : fs::directory_iterator(folder_of(output.file)))
      if (is_left_over(entry.path().filename().string(), names)) torn.push_back(entry.path());
    std::error_code ignored;
    for (const fs::path& file : torn) fs::remove(file, ignored);
  }
}

}  // namespace softkin
