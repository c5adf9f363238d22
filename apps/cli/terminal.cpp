#include "terminal.hpp"

#include <signal.h>
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

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void catch_interrupt() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
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
  std::string bar;
  if (share >= 0) {
    constexpr int width = 24;
    const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * width);
    bar = "[" + std::string(full, '#') + std::string(width - full, ' ') + "] ";
  }
  std::fprintf(stderr, "\r\033[K%s%.100s", bar.c_str(), text.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!shown_) return;
  std::fprintf(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

std::string number(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value == 0 ? 0.0 : value);  // never "-0"
  return text;
}

}  // namespace softkin::cli
