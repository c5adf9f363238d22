#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace softkin::testing {

/// How bad the line is. Shares are of all lines, in each direction.
struct LineFaults {
  double fraction = 0;
  unsigned seed = 1;
  double delay_s = 0.003;
  double ok_after_resend = 0.5;  // fraction of the Resends that "ok" follows
  double busy = 0;               // fraction of the moves that are answered late, with "busy" before
  long reboot_after_moves = -1;  // then the board boots anew; -1: never
  bool silent_reboot = false;    // its "start" is lost
  long mute_after_moves = -1;    // then it answers nothing any more
  bool advanced_ok = false;
  bool other_words = false;             // as of another maker: errors in his words, M114 answered on the line of "ok"
  long refuse_once = -1;                // this line, with its number, is refused when it comes first
  std::string axes = "XYZ";             // that the board has
  std::function<double(double)> clamp;  // soft endstops of X
};

/// What Marlin does with its serial line (line numbers, checksums, Resend, M110, lines without a number), at the other
/// end of a pseudo terminal, on a thread of its own, with faults on the line in both directions.
class FaultyMarlin {
 public:
  explicit FaultyMarlin(LineFaults faults = {}) : faults_(std::move(faults)), random_(faults_.seed) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) throw std::runtime_error("no pty");
    port_ = ::ptsname(master_);
    slave_ = ::open(port_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);  // held open: the port outlives its users
    termios settings = {};
    ::tcgetattr(slave_, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(slave_, TCSANOW, &settings);
    thread_ = std::thread([this] { run(); });
  }
  ~FaultyMarlin() { end(); }
  FaultyMarlin(const FaultyMarlin&) = delete;
  FaultyMarlin& operator=(const FaultyMarlin&) = delete;

  /// Ends the thread; what it did may be looked at from then on.
  void end() {
    quit_ = true;
    if (thread_.joinable()) thread_.join();
    if (master_ >= 0) ::close(master_);
    if (slave_ >= 0) ::close(slave_);
    master_ = slave_ = -1;
  }
  /// The cable is pulled.
  void unplug() { end(); }

  [[nodiscard]] const std::string& port() const { return port_; }
  [[nodiscard]] long moves() const { return move_count_; }

  using Position = std::map<char, double>;
  /// Returns the position after each move that changes it.
  [[nodiscard]] const std::vector<Position>& motions() const { return motions_; }
  [[nodiscard]] const std::vector<std::string>& executed() const { return executed_; }  // all commands
  [[nodiscard]] long faults_made() const { return faults_made_; }
  [[nodiscard]] long refused() const { return refused_; }
  [[nodiscard]] long quick_stops() const { return quick_stops_; }
  [[nodiscard]] std::size_t motions_before_boot() const { return motions_before_boot_; }

 private:
  static constexpr std::size_t longest_command = 96;

  double chance() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::size_t pick(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }
  char any_byte() { return static_cast<char>(pick(256)); }
  static void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

  /// What arrives of a line (its end included).
  std::string damaged(std::string line) {
    if (chance() >= faults_.fraction || line.empty()) return line;
    ++faults_made_;
    const std::size_t at = pick(line.size());
    switch (pick(6)) {
      case 0:
        line[at] = static_cast<char>(line[at] ^ static_cast<char>(1 + pick(255)));
        return line;
      case 1:
        return line.erase(at, 1);
      case 2:
        return line.insert(at, 1, any_byte());
      case 3:
        return "";
      case 4:
        return line + line;
      default:
        sleep(faults_.delay_s);
        return line;
    }
  }

  void run() {
    std::string from_host;
    while (!quit_) {
      pollfd request = {master_, POLLIN, 0};
      if (::poll(&request, 1, 5) <= 0) continue;
      char bytes[512];
      const ssize_t count = ::read(master_, bytes, sizeof bytes);
      if (count <= 0) continue;
      from_host.append(bytes, count);
      for (std::size_t end = 0; (end = from_host.find('\n')) != std::string::npos;) {
        const std::string line = from_host.substr(0, end + 1);
        from_host.erase(0, end + 1);
        receive(damaged(line));
        if (flush_) from_host.clear();
        flush_ = false;
      }
    }
  }

  void receive(const std::string& bytes) {
    for (const char c : bytes) {
      if (c == '\n' || c == '\r') {
        comment_ = escaped_ = false;
        const std::string command = std::exchange(command_, "");
        if (!command.empty() && !take(command.c_str()) && chance() < 0.5) {  // the rest may have come already, or not
          flush_ = true;
          return;
        }
      } else if (comment_) {
      } else if (!escaped_ && c == '\\') {
        escaped_ = true;
      } else if (!escaped_ && c == ';') {
        comment_ = true;
      } else if (!escaped_ && c == '\b') {
        if (!command_.empty()) command_.pop_back();
      } else {
        escaped_ = false;
        command_ += c;
        if (command_.size() >= longest_command - 1) comment_ = true;
      }
    }
  }

  void say(const std::string& text) {
    if (mute_) return;
    const std::string line = damaged(text + "\n");
    std::size_t sent = 0;
    while (sent < line.size() && !quit_) {
      const ssize_t count = ::write(master_, line.data() + sent, line.size() - sent);
      if (count > 0) sent += count;
    }
  }

  bool refuse(const std::string& why) {
    ++refused_;
    say(faults_.other_words ? "Error:that was not understood"
                            : "Error:" + why + ", Last Line: " + std::to_string(last_));
    say("Resend: " + std::to_string(last_ + 1));
    if (chance() < faults_.ok_after_resend) say("ok");
    return false;
  }

  /// A whole line, as in Marlin's get_serial_commands. False where it is refused.
  bool take(std::string line) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.empty()) return true;
    std::string number;
    if (line[0] == 'N') {
      const bool sets_number = line.find("M110") != std::string::npos;
      std::size_t at = 0;
      if (sets_number && line.size() > 4 && line.find('N', 4) != std::string::npos) at = line.find('N', 4);
      const long n = std::strtol(line.c_str() + at + 1, nullptr, 10);
      if (n != last_ + 1 && !sets_number) return refuse("Line Number is not Last Line Number+1");
      const std::size_t star = line.rfind('*');
      if (star == std::string::npos) return refuse("No Checksum with line number");
      unsigned char checksum = 0;
      for (std::size_t i = 0; i < star; ++i) checksum = static_cast<unsigned char>(checksum ^ line[i]);
      if (std::strtol(line.c_str() + star + 1, nullptr, 10) != checksum) return refuse("checksum mismatch");
      if (n == faults_.refuse_once) {
        faults_.refuse_once = -1;
        return refuse("checksum mismatch");
      }
      last_ = n;
      number = std::to_string(n);
      line = line.substr(0, star);
      const std::size_t blank = line.find(' ');
      line = blank == std::string::npos ? "" : line.substr(blank + 1);
    } else if (line.rfind("M410", 0) == 0) {
      ++quick_stops_;
    }
    execute(line.substr(0, line.find('*')));
    const std::string tail = std::exchange(on_ok_, "");
    if (!boots_) say("ok" + (faults_.advanced_ok && !number.empty() ? " N" + number + " P15 B3" : tail));
    if (boots_) boot();
    return true;
  }

  void execute(const std::string& command) {
    const char letter = command.empty() ? ' ' : command[0];
    unsigned short code = 0;  // of 16 bits, as Marlin's
    std::size_t at = 1;
    while (at < command.size() && std::isdigit(static_cast<unsigned char>(command[at])))
      code = static_cast<unsigned short>(code * 10 + (command[at++] - '0'));
    if ((letter != 'G' && letter != 'M') || at == 1) {
      say("echo:Unknown command: \"" + command + "\"");
      return;
    }
    executed_.push_back(command);
    if (letter == 'G' && (code == 0 || code == 1)) return move(command.substr(at));
    if (letter == 'G' && code == 92) set(command.substr(at), position_);
    if (letter == 'M' && code == 114) report();
  }

  void set(const std::string& words, Position& position) const {
    for (std::size_t i = 0; i < words.size(); ++i)
      if (faults_.axes.find(words[i]) != std::string::npos) position[words[i]] = std::strtod(&words[i + 1], nullptr);
  }

  void move(const std::string& words) {
    Position target = position_;
    set(words, target);
    if (faults_.clamp) target['X'] = faults_.clamp(target['X']);
    if (chance() < faults_.busy) {
      say("echo:busy: processing");
      sleep(faults_.delay_s / 2);
      say("echo:busy: processing");
      sleep(faults_.delay_s / 2);
    }
    if (target == position_) return;
    position_ = target;
    motions_.push_back(target);
    const long count = ++move_count_;
    if (count == faults_.reboot_after_moves) boots_ = true;
    if (count == faults_.mute_after_moves) mute_ = true;
  }

  void report() {
    std::string text;
    char number[40];
    for (const char axis : faults_.axes + "E") {
      const auto found = position_.find(axis);
      std::snprintf(number, sizeof number, "%c:%.2f ", axis, found == position_.end() ? 0.0 : found->second);
      text += number;
    }
    if (faults_.other_words)
      on_ok_ = " " + text;
    else
      say(text + "Count X:0 Y:0 Z:0");
  }

  void boot() {
    boots_ = false;
    motions_before_boot_ = motions_.size();
    last_ = 0;
    position_.clear();
    command_.clear();
    if (faults_.silent_reboot) return;
    say("start");
    say("echo:Marlin 2.1.2");
  }

  LineFaults faults_;
  std::mt19937 random_;
  int master_ = -1, slave_ = -1;
  std::string port_;
  std::thread thread_;
  std::atomic<bool> quit_ = false;
  std::atomic<long> move_count_ = 0;

  std::string command_, on_ok_;
  bool comment_ = false, escaped_ = false, flush_ = false, boots_ = false, mute_ = false;
  long last_ = 0;
  Position position_;
  std::vector<Position> motions_;
  std::vector<std::string> executed_;
  long faults_made_ = 0, refused_ = 0, quick_stops_ = 0;
  std::size_t motions_before_boot_ = 0;
};

}  // namespace softkin::testing
