#pragma once

#include <string>
#include <string_view>

namespace softkin::drive {

/// Of a clock that never jumps.
[[nodiscard]] double seconds_now();

/// A serial port in raw mode, 8N1, for one program at a time.
class SerialPort {
 public:
  /// throws  InvalidInput naming the port where it cannot be opened, is no serial port, is in use, or does not take the
  ///         rate [baud]
  SerialPort(const std::string& path, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// All of it, or false where the port is gone or takes nothing for timeout_s.
  [[nodiscard]] bool write(std::string_view bytes, double timeout_s);

  /// Of a line: it came, it has not come yet, or the port is gone.
  enum class Read { line, nothing, lost };
  /// The next line without its end, once it is whole; waits at most timeout_s (0: does not wait).
  [[nodiscard]] Read read_line(std::string& line, double timeout_s);

 private:
  bool take_line(std::string& line);

  int file_ = -1;
  std::string pending_;
  std::size_t begin_ = 0;  // of what is unread in pending_
};

}  // namespace softkin::drive
