#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/drive/marlin_answer.hpp>
#include <softkin/drive/marlin_link.hpp>

namespace softkin::drive {

namespace {

using Kind = MarlinAnswer::Kind;

constexpr long base = 10000;             // number that M110 sets
constexpr double write_s = 1;            // for which a port may take nothing, however soon answers are due
constexpr double slice_s = 0.05;         // between two looks at the user's order
constexpr double report_step_mm = 0.01;  // M114 prints two decimals
constexpr int foreign_limit = 3;         // requests for a number that is not of the stream: a damaged one comes alone
constexpr int position_attempts = 5;

/// The stream is over.
struct Ended {
  StreamEnd end;
  std::string message;
};
/// The start has to begin anew.
struct Restart {
  std::string why;
};

/// A line with its number: its place in the list.
struct Entry {
  std::string text;
  double patience_s = 0;
  std::size_t program_lines = 0;  // of the program, up to and with this entry
};

class Session {
 public:
  Session(SerialPort& port, const GcodeProgram& program, const LinkOptions& options, const LinkHooks& hooks)
      : port_(port), program_(program), options_(options), hooks_(hooks) {
    report_.lines = program.lines.size();
  }

  StreamReport run() {
    try {
      wait_for_boot();
      start();
      send_program();
    } catch (const Ended& ended) {
      report_.end = ended.end;
      report_.message = ended.message;
    }
    if (report_.end == StreamEnd::quick_stopped) quick_stop();
    report_.acknowledged = lines_before(cursor_);
    report_.sent = lines_before(high_);
    if (!report_.position_known) report_.position.clear();
    log('!', report_.message);
    return std::move(report_);
  }

 private:
  [[nodiscard]] std::size_t lines_before(std::size_t entry) const {
    return entry == 0 || entries_.empty() ? 0 : entries_[entry - 1].program_lines;
  }

  void log(char kind, const std::string& text) const {
    if (hooks_.log) hooks_.log(kind, text);
  }

  Order order() const {
    const Order order = hooks_.order ? hooks_.order() : Order::go;
    if (order == Order::quick_stop)
      throw Ended{StreamEnd::quick_stopped, "stopped at once (M410): the position is unknown"};
    return order;
  }

  // --- the wire

  void write(const std::string& line) {
    log('>', line);
    if (!port_.write(line + "\n", std::max(options_.timeout_s, write_s)))
      throw Ended{StreamEnd::port_lost, "the port takes nothing more: the position is unknown"};
  }

  /// An answer, or nothing until the deadline. What ends the stream whenever it comes, ends it here.
  std::optional<MarlinAnswer> read(double deadline) {
    for (;;) {
      (void)order();
      const double left = deadline - seconds_now();
      switch (port_.read_line(line_, std::max(0.0, std::min(left, slice_s)))) {
        case SerialPort::Read::lost:
          throw Ended{StreamEnd::port_lost, "the port is gone: the position is unknown"};
        case SerialPort::Read::nothing:
          if (left <= slice_s) return std::nullopt;
          continue;
        case SerialPort::Read::line:
          break;
      }
      log('<', line_);
      MarlinAnswer answer = parse_answer(line_);
      if (answer.kind == Kind::started) booted();
      if (answer.kind == Kind::error) return what_follows();
      if (answer.kind == Kind::halted) halted(line_);
      if (!answer.position.empty()) position_ = answer.position;
      return answer;
    }
  }

  [[noreturn]] void halted(const std::string& line) const {
    throw Ended{StreamEnd::halted, "the board reports: " + line + "; the position is unknown"};
  }

  /// An error in words that Marlin does not use is one of the line where the board asks for it again.
  MarlinAnswer what_follows() {
    const std::string error = line_;  // reading on replaces it
    const double deadline = seconds_now() + options_.timeout_s;
    while (auto answer = read(deadline)) {
      if (answer->kind == Kind::resend) return *answer;
      if (answer->kind == Kind::ok) break;
    }
    halted(error);
  }

  void booted() const {
    if (!started_) throw Restart{"the board has booted"};
    throw Ended{StreamEnd::rebooted, "the board has booted anew (it sent '" + line_ + "'): the position is unknown"};
  }

  /// Reads until it is silent; what the board asks for meanwhile is obeyed.
  void drain() {
    disturbed_ = false;
    since_silence_ = 0;
    while (const auto answer = read(seconds_now() + options_.quiet_s))
      if (answer->kind == Kind::resend) obey(*answer->number);
    disturbed_ = false;
  }

  // --- one line in flight

  void fail_once(const std::string& why) {
    if (++failures_ < options_.attempts) return;
    const std::string text = why + " " + std::to_string(failures_) + " times in a row";
    if (!started_) throw Restart{text};
    throw Ended{StreamEnd::no_answer, text + ": the position is unknown"};
  }

  /// The board expects this number. True where it is one of this stream.
  bool obey(long number) {
    disturbed_ = true;
    const long index = number - base - 1;
    if (index < 0 || index > static_cast<long>(high_)) {
      if (!started_) throw Restart{"the board requested line " + std::to_string(number)};
      foreign_ = number == foreign_number_ ? foreign_ + 1 : 1;
      foreign_number_ = number;
      if (foreign_ >= foreign_limit)
        throw Ended{StreamEnd::rebooted,
                    "the board asks for line " + std::to_string(number) +
                        ", which is not of this stream: it was reset, and the position is unknown"};
      return false;
    }
    foreign_ = 0;
    if (static_cast<std::size_t>(index) > cursor_) failures_ = 0;
    cursor_ = index;
    return true;
  }

  void transmit(bool again) {
    const Entry& entry = entries_[cursor_];
    std::string line = numbered_line(base + 1 + static_cast<long>(cursor_), entry.text);
    if (again) line.insert(0, "\n");  // ends what may be left of the line sent before
    high_ = std::max(high_, cursor_ + 1);
    write(line);
  }

  /// Sends the line at the cursor; returns once it is accepted, or another one is requested.
  void exchange() {
    while (const auto answer = read(seconds_now())) {  // nothing should be there
      disturbed_ = disturbed_ || answer->kind == Kind::ok;
      if (answer->kind == Kind::resend) obey(*answer->number);
    }
    if (disturbed_ || since_silence_ >= options_.checkpoint_lines) drain();
    if (cursor_ >= entries_.size()) return;
    transmit(failures_ > 0);
    double deadline = seconds_now() + options_.timeout_s + entries_[cursor_].patience_s;
    bool again = false;
    for (;;) {
      const auto answer = read(deadline);
      if (!answer) {
        ++report_.timeouts;
        fail_once("no answer to line " + std::to_string(base + 1 + static_cast<long>(cursor_)));
        log('!', "no answer: sent again");
        transmit(true);
        again = true;
        deadline = seconds_now() + options_.timeout_s;
      } else if (answer->kind == Kind::busy) {
        deadline = std::max(deadline, seconds_now() + options_.timeout_s);
      } else if (answer->kind == Kind::ok) {
        if (answer->number && *answer->number != base + 1 + static_cast<long>(cursor_)) continue;  // of another line
        ++cursor_;
        ++since_silence_;
        failures_ = foreign_ = 0;
        disturbed_ = again;
        return;
      } else if (answer->kind == Kind::resend) {
        const std::size_t before = cursor_;
        obey(*answer->number);
        if (cursor_ <= before) {
          ++report_.resends;
          fail_once("line " + std::to_string(base + 1 + static_cast<long>(before)) + " was requested again");
        }
        return;
      }
    }
  }

  void send(std::string text, double patience) {
    entries_.push_back({std::move(text), patience, next_});
    while (cursor_ < entries_.size()) exchange();
  }

  // --- the position

  [[nodiscard]] std::optional<double> coordinate(char axis) const {
    for (const auto& [letter, value] : *position_)
      if (letter == axis) return value;
    return std::nullopt;
  }

  /// What is wrong with the board's report; empty: nothing.
  [[nodiscard]] std::string fault(const std::vector<double>& expected) const {
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const std::string axis(1, program_.axes[i]);
      const auto found = coordinate(program_.axes[i]);
      if (!found) return "the board has no axis " + axis;
      if (std::abs(*found - expected[i]) > report_step_mm)
        return "the board reports " + axis + " " + decimal(*found, 2) + " mm instead of " + decimal(expected[i], 2) +
               " mm";
    }
    return "";
  }

  /// Asks the board where it is, after all that was sent; the stream ends unless it is there.
  void check_position(const std::vector<double>& expected, double patience) {
    std::string before;
    for (int i = 0; i < position_attempts; ++i) {
      position_.reset();
      send("M114", patience);
      for (const double deadline = seconds_now() + options_.timeout_s; !position_;)
        if (!read(deadline)) break;
      std::string now_wrong = position_ ? fault(expected) : "";
      if (position_ && now_wrong.empty()) {
        report_.position_known = true;
        report_.position = expected;
        return;
      }
      if (position_ && now_wrong == before) break;  // not noise, then
      if (position_) before = now_wrong;
    }
    report_.position_known = false;
    throw Ended{StreamEnd::wrong_position,
                (before.empty() ? "the board does not report its position (M114)" : before) +
                    std::string(started_ ? ": the position is unknown" : ", before anything was moved")};
  }

  // --- the stream

  void wait_for_boot() {
    const double deadline = seconds_now() + options_.boot_s;
    try {
      while (read(deadline)) {
      }
    } catch (const Restart&) {
      log('!', "the board has booted");
    }
  }

  void start() {
    for (int i = 0; i < options_.attempts; ++i) {
      try {
        return try_start();
      } catch (const Restart& restart) {
        log('!', "start anew: " + restart.why);
        last_why_ = restart.why;
      }
    }
    throw Ended{StreamEnd::no_answer, "no conversation with the board came about (" + last_why_ +
                                          "); nothing was moved. Is it Marlin, and is the baud rate right?"};
  }

  void try_start() {
    entries_.clear();
    cursor_ = high_ = 0;
    failures_ = 0;
    drain();
    write("\n" + numbered_line(base, "M110 N" + std::to_string(base)));
    for (const double deadline = seconds_now() + options_.timeout_s;;) {
      const auto answer = read(deadline);
      if (!answer) throw Restart{"no answer to M110"};
      if (answer->kind == Kind::ok) break;
      if (answer->kind == Kind::resend) throw Restart{"M110 was refused"};
    }
    drain();
    if (order() == Order::stop) throw Ended{StreamEnd::stopped, "stopped before anything was moved"};
    for (const std::string& line : program_.setup) send(line, 0);
    check_position(program_.start, 0);
    started_ = true;
  }

  void send_program() {
    for (const GcodeLine& line : program_.lines) {
      Order now_requested = order();
      if (now_requested == Order::pause) now_requested = pause();
      if (now_requested == Order::stop) return finish(StreamEnd::stopped, "stopped");
      ++next_;
      report_.position_known = false;
      send(line.text, line.patience_s);
      if (hooks_.progress) hooks_.progress(next_);
    }
    finish(StreamEnd::finished, "finished");
  }

  Order pause() {
    log('!', "paused");
    Order requested = Order::pause;
    while ((requested = order()) == Order::pause)
      if (const auto answer = read(seconds_now() + slice_s); answer && answer->kind == Kind::resend)
        obey(*answer->number);
    log('!', "goes on");
    return requested;
  }

  void finish(StreamEnd end, const std::string& message) {
    send("M400", program_.drain_s);
    check_position(next_ > 0 ? program_.lines[next_ - 1].position : program_.start, program_.drain_s);
    report_.end = end;
    report_.message = message + " after line " + std::to_string(next_) + " of " + std::to_string(report_.lines) +
                      ": the position is known";
  }

  /// Without number: Marlin obeys it before the lines that wait. Twice, as the line in flight may have moved on after
  /// the first.
  void quick_stop() {
    report_.position_known = false;
    for (int i = 0; i < 2; ++i) {
      log('>', "M410");
      if (!port_.write("\nM410\n", options_.timeout_s)) return;
      std::string line;
      while (port_.read_line(line, options_.quiet_s) == SerialPort::Read::line) log('<', line);
    }
  }

  SerialPort& port_;
  const GcodeProgram& program_;
  const LinkOptions& options_;
  const LinkHooks& hooks_;
  StreamReport report_;
  std::vector<Entry> entries_;  // entry i has number base + 1 + i
  std::size_t cursor_ = 0;      // entry that the board expects, as far as is known
  std::size_t high_ = 0;        // entries that were sent at least once
  std::size_t next_ = 0;        // lines of the program that are entries
  bool started_ = false;        // from here on no M110, and a boot ends the stream
  bool disturbed_ = false;      // answers may still be pending
  int since_silence_ = 0;       // lines
  int failures_ = 0;            // in a row
  int foreign_ = 0;
  long foreign_number_ = -1;
  std::optional<std::vector<std::pair<char, double>>> position_;
  std::string line_, last_why_;
};

}  // namespace

std::string numbered_line(long number, const std::string& text) {
  std::string line = "N" + std::to_string(number) + " " + text;
  unsigned char checksum = 0;
  for (const char c : line) checksum = static_cast<unsigned char>(checksum ^ static_cast<unsigned char>(c));
  return line + "*" + std::to_string(checksum);
}

StreamReport stream(SerialPort& port, const GcodeProgram& program, const LinkOptions& options, const LinkHooks& hooks) {
  return Session(port, program, options, hooks).run();
}

const char* name_of(StreamEnd end) {
  constexpr const char* names[] = {"finished", "stopped",   "quick stopped",  "rebooted",
                                   "halted",   "no answer", "wrong position", "port lost"};  // in the enum's order
  return names[static_cast<std::size_t>(end)];
}

}  // namespace softkin::drive
