#include "terminal.hpp"

#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <new>
#include <softkin/core/error.hpp>

namespace softkin::cli {

namespace {

volatile sig_atomic_t interrupt_count = 0;
Deadline the_deadline;

void on_interrupt(int signal_number) {
  interrupt_count = interrupt_count + 1;
  if (interrupt_count == 1) return;
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

/// 0 where it is not known.
std::size_t width_of(int descriptor) {
  winsize size = {};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::size_t terminal_width() {
  const std::size_t width = width_of(STDERR_FILENO);
  return width > 0 ? width : 80;
}

}  // namespace

void catch_interrupt() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  action.sa_flags = SA_RESTART;  // what is being written is written to its end
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return interrupt_count > 0 || the_deadline.passed();
}

void stop_at(const Deadline& deadline) {
  the_deadline = deadline;
}

std::string why_stopped() {
  return interrupt_count > 0 ? "interrupted" : the_deadline.spent();
}

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) == 1), last_(terminal_ ? 0 : seconds_now()) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::show(double fraction, const std::string& text) {
  constexpr double between = 0.1, between_lines = 10;  // [s]
  const double now = seconds_now();
  if (now - last_ < (terminal_ ? between : between_lines)) return;
  last_ = now;
  if (!terminal_) {
    std::fprintf(stderr, "softkin: %s%s\n", fraction >= 0 ? (decimal(100 * fraction, 1) + " %: ").c_str() : "",
                 text.c_str());
    return;
  }
  shown_ = true;
  std::string line = text;
  if (fraction >= 0) {
    constexpr std::size_t width = 20;
    const auto full = static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * width);
    line = "[" + std::string(full, '#') + std::string(width - full, ' ') + "] " + text;
  }
  line.resize(std::min(line.size(), terminal_width() - 1));  // a line that wraps cannot be rewritten
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!shown_) return;
  std::fprintf(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<std::string> cut(std::vector<std::string> lines, std::size_t most) {
  if (lines.size() <= most) return lines;
  const std::size_t more = lines.size() - most;
  lines.resize(most);
  lines.push_back("... and " + std::to_string(more) + " more");
  return lines;
}

std::string joined(const std::vector<std::string>& lines, const std::string& indent) {
  std::string text;
  for (const std::string& line : lines) text += indent + line + "\n";
  return text;
}

bool fits_output(const std::string& line) {
  const std::size_t width = width_of(STDOUT_FILENO);
  return width == 0 || characters(line) <= width;
}

std::string table_text(const Table& table) {
  return joined(table.lines(width_of(STDOUT_FILENO)), "");
}

std::string written_text(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string text;
  for (const auto& [what, file] : files)
    if (!file.empty()) text += what + ": " + file + "\n";
  return text;
}

void print_piece(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw InvalidInput("standard output cannot be written");
}

void print(const std::string& text) {
  print_piece(text);
  if (std::fflush(stdout) != 0) throw InvalidInput("standard output cannot be written");
}

namespace {

/// An error is one line, whatever the names of files in it hold.
void complain(const std::string& message) {
  std::fprintf(stderr, "softkin: %s\n", on_one_line(message).c_str());
}

}  // namespace

int answer_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& command) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return refuse_usage(message, command);
}

int refuse_usage(const std::string& message, const std::string& command) {
  complain(message + " (" + command + " --help shows more)");
  return bad_input;
}

int outcome_of(const Run& run) {
  try {
    return run();
  } catch (const InvalidInput& error) {
    complain(error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    complain(error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    complain("out of memory");
  } catch (const std::exception& error) {
    complain(std::string("internal error, please report it: ") + error.what());
  }
  return bad_input;
}

}  // namespace softkin::cli
