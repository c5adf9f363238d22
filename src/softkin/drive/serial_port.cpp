// The kernel's own header has rates that <termios.h> has not, and cannot stand beside it.
#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <softkin/core/error.hpp>
#include <softkin/drive/serial_port.hpp>

namespace softkin::drive {

namespace {

constexpr std::size_t longest_line = 4096;  // garbage without an end is thrown away

/// False where nothing happened until then.
bool wait_for(int file, short events, double deadline) {
  for (;;) {
    const double left = std::max(0.0, deadline - seconds_now());
    timespec time = {};
    time.tv_sec = static_cast<time_t>(left);
    time.tv_nsec = static_cast<long>(1e9 * (left - std::floor(left)));
    pollfd request = {file, events, 0};
    const int ready = ::ppoll(&request, 1, &time, nullptr);
    if (ready >= 0 || errno != EINTR) return ready != 0;
    if (left <= 0) return false;
  }
}

/// Raw, 8N1, at any rate that the driver takes, such as the 250000 baud of many boards.
void set_up(int file, int baud) {
  termios2 settings = {};
  if (::ioctl(file, TCGETS2, &settings) != 0) throw InvalidInput("is no serial port");
  settings.c_iflag &= ~static_cast<tcflag_t>(IGNBRK | BRKINT | PARMRK | ISTRIP | INLCR | IGNCR | ICRNL | IXON);
  settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  settings.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | ISIG | IEXTEN);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CRTSCTS);
  settings.c_cflag |= CS8 | CLOCAL | CREAD;
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  if (::ioctl(file, TCSETS2, &settings) != 0) throw InvalidInput("cannot be set up");
  if (::ioctl(file, TIOCEXCL) != 0) throw InvalidInput("cannot be had alone");
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD);
  settings.c_cflag |= BOTHER;
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  if (::ioctl(file, TCSETS2, &settings) != 0) throw InvalidInput("does not take " + std::to_string(baud) + " baud");
}

}  // namespace

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

SerialPort::SerialPort(const std::string& path, int baud) {
  file_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) throw InvalidInput("port " + path + ": " + std::strerror(errno));
  try {
    set_up(file_, baud);
  } catch (const InvalidInput& error) {
    ::close(file_);
    throw InvalidInput("port " + path + ": " + error.what());
  }
  (void)::ioctl(file_, TCFLSH, TCIOFLUSH);
}

SerialPort::~SerialPort() {
  (void)::ioctl(file_, TIOCNXCL);
  ::close(file_);
}

bool SerialPort::write(std::string_view bytes, double timeout_s) {
  double deadline = seconds_now() + timeout_s;
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count > 0) {
      bytes.remove_prefix(count);
      deadline = seconds_now() + timeout_s;
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
      return false;
    } else if (!wait_for(file_, POLLOUT, deadline)) {
      return false;
    }
  }
  return true;
}

bool SerialPort::take_line(std::string& line) {
  const std::size_t end = pending_.find('\n', begin_);
  if (end == std::string::npos) {
    pending_.erase(0, begin_);
    begin_ = 0;
    if (pending_.size() > longest_line) pending_.clear();
    return false;
  }
  line.assign(pending_, begin_, end - begin_);
  while (!line.empty() && line.back() == '\r') line.pop_back();
  begin_ = end + 1;
  return true;
}

SerialPort::Read SerialPort::read_line(std::string& line, double timeout_s) {
  const double deadline = seconds_now() + timeout_s;
  for (;;) {
    if (take_line(line)) return Read::line;
    char bytes[1024];
    const ssize_t count = ::read(file_, bytes, sizeof bytes);
    if (count > 0) {
      pending_.append(bytes, count);
      continue;
    }
    if (count < 0 && errno != EAGAIN && errno != EINTR) return Read::lost;
    if (seconds_now() >= deadline || !wait_for(file_, POLLIN, deadline)) return Read::nothing;
    // a port that is gone is always ready, and has nothing
    pollfd state = {file_, POLLIN, 0};
    if (::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0 &&
        (state.revents & POLLIN) == 0)
      return Read::lost;
  }
}

}  // namespace softkin::drive
