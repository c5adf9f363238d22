#include "terminal.hpp"

#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace softkin::cli {

namespace {

volatile sig_atomic_t interrupt_count = 0;

void on_interrupt(int signal_number) {
  interrupt_count = interrupt_count + 1;
  if (interrupt_count == 1) return;
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

std::size_t terminal_width() {
  winsize size = {};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
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
  return interrupt_count > 0;
}

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::show(double share, const std::string& text) {
  const double now = seconds_now();
  if (!terminal_ || now - last_ < 0.1) return;
  last_ = now;
  shown_ = true;
  std::string line = text;
  if (share >= 0) {
    constexpr std::size_t width = 20;
    const auto full = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * width);
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

}  // namespace softkin::cli
