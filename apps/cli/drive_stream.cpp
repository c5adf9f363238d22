#include "drive_stream.hpp"

#include <signal.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <softkin/core/error.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

volatile sig_atomic_t stop_count = 0, pause_asked = 0;

void on_stop(int signal_number) {
  stop_count = stop_count + 1;
  if (stop_count < 3) return;
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

void on_pause(int) {
  pause_asked = !pause_asked;
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = on_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = on_pause;
  sigaction(SIGTSTP, &action, nullptr);
}

drive::Order order_of_user() {
  if (stop_count > 1) return drive::Order::quick_stop;
  if (stop_count > 0) return drive::Order::stop;
  return pause_asked ? drive::Order::pause : drive::Order::go;
}

/// Every line with the time of day (UTC) and the seconds since the beginning; written at once.
class LogFile {
 public:
  explicit LogFile(const std::string& path) : file_(std::fopen(path.c_str(), "w"), std::fclose), path_(path) {
    if (!file_) throw InvalidInput("--log " + path + ": " + std::strerror(errno));
  }

  void add(char kind, std::string text) {
    while (text.starts_with("\n")) text.erase(0, 1);
    for (char& c : text)
      if (static_cast<unsigned char>(c) < ' ') c = '?';
    const auto time = std::chrono::system_clock::now();
    const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count() % 1000;
    std::tm utc = {};
    ::gmtime_r(&seconds, &utc);
    char day[40];
    std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", &utc);
    std::fprintf(file_.get(), "%s.%03dZ %10.3f s %c %s\n", day, static_cast<int>(ms), seconds_now() - begin_, kind,
                 text.c_str());
    if (std::fflush(file_.get()) != 0 && !warned_) {
      warned_ = true;  // motors that move are not stopped for a full disk
      std::fprintf(stderr, "softkin: warning: --log %s: %s\n", path_.c_str(), std::strerror(errno));
    }
  }

 private:
  std::unique_ptr<FILE, int (*)(FILE*)> file_;
  std::string path_;
  double begin_ = seconds_now();
  bool warned_ = false;
};

const char* name_of(drive::StreamEnd end) {
  switch (end) {
    case drive::StreamEnd::finished:
      return "finished";
    case drive::StreamEnd::stopped:
      return "stopped";
    case drive::StreamEnd::quick_stopped:
      return "quick stopped";
    case drive::StreamEnd::rebooted:
      return "rebooted";
    case drive::StreamEnd::halted:
      return "halted";
    case drive::StreamEnd::wrong_position:
      return "wrong position";
    case drive::StreamEnd::port_lost:
      return "port lost";
    case drive::StreamEnd::no_answer:
      break;
  }
  return "no answer";
}

}  // namespace

drive::StreamReport send_to_board(drive::SerialPort& port, const DriveOptions& options,
                                  const drive::GcodeProgram& program) {
  std::unique_ptr<LogFile> log;
  if (!options.log.empty()) log = std::make_unique<LogFile>(options.log);
  catch_signals();
  ProgressLine line;
  const double begin = seconds_now();
  bool was_paused = false;
  drive::LinkHooks hooks;
  hooks.order = [&] {
    const drive::Order order = order_of_user();
    if ((order == drive::Order::pause) != was_paused) {
      was_paused = !was_paused;
      line.clear();
      std::fprintf(stderr, was_paused ? "softkin: paused: Ctrl-Z goes on, Ctrl-C stops\n" : "softkin: goes on\n");
    }
    return order;
  };
  if (log) hooks.log = [&](char kind, const std::string& text) { log->add(kind, text); };
  hooks.progress = [&](std::size_t lines) {
    line.show(static_cast<double>(lines) / static_cast<double>(program.lines.size()),
              std::to_string(lines) + "/" + std::to_string(program.lines.size()) + " lines, " +
                  duration(seconds_now() - begin) + "; Ctrl-C stops, Ctrl-Z pauses");
  };
  drive::LinkOptions link;
  link.boot_s = options.boot_wait_s;
  return drive::stream(port, program, link, hooks);
}

std::string stream_text(const DriveOptions& options, const drive::GcodeProgram& program,
                        const drive::StreamReport& report) {
  std::string text = report.message;
  const auto row_of = [&](std::size_t line) {
    const std::size_t row = program.lines[line - 1].row;
    return row > 0 ? " (" + options.commands + ":" + std::to_string(row) + ")" : "";
  };
  if (report.end != drive::StreamEnd::finished) {
    text += "; the board accepted " + (report.acknowledged > 0 ? "lines up to " + std::to_string(report.acknowledged) +
                                                                     row_of(report.acknowledged)
                                                               : std::string("no line"));
    text += " of " + std::to_string(report.lines);
    if (report.sent > report.acknowledged) text += ", and perhaps those up to " + std::to_string(report.sent);
  }
  if (report.position_known) {
    text += "; the motors stand at";
    for (std::size_t i = 0; i < report.position.size(); ++i)
      text += std::string(" ") + program.axes[i] + " " + decimal(report.position[i], 3);
    text += " mm";
  } else if (report.sent > 0) {
    text += "; bring the motors home by hand before the next run";
  }
  return text;
}

nlohmann::ordered_json stream_json(const drive::GcodeProgram& program, const drive::StreamReport& report) {
  nlohmann::ordered_json json = {{"end", name_of(report.end)},  {"message", report.message},
                                 {"lines", report.lines},       {"acknowledged", report.acknowledged},
                                 {"sent", report.sent},         {"resends", report.resends},
                                 {"timeouts", report.timeouts}, {"position_known", report.position_known}};
  if (report.position_known)
    for (std::size_t i = 0; i < report.position.size(); ++i)
      json["position_mm"][std::string(1, program.axes[i])] = report.position[i];
  return json;
}

}  // namespace softkin::cli
