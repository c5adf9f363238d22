#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/patience.hpp"

namespace softkin::view::testing {

using softkin::testing::patient;

/// A socket to 127.0.0.1 whose waits have a time limit.
class PlainSocket {
 public:
  /// receive_buffer: of the socket [bytes]; 0: the system's
  explicit PlainSocket(int port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place = {};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int on = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (receive_buffer > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
      ::close(socket_);
      throw std::runtime_error("no connection");
    }
  }
  ~PlainSocket() {
    if (socket_ >= 0) ::close(socket_);
  }
  PlainSocket(PlainSocket&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), read_(std::move(other.read_)) {}
  PlainSocket& operator=(PlainSocket&&) = delete;

  /// Returns false after the other side has closed.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(count);
    }
    return true;
  }

  /// Ends sending; the socket still receives.
  void end_sending() { ::shutdown(socket_, SHUT_WR); }

  /// Returns the next `count` bytes; none where fewer arrive in time.
  std::optional<std::string> take(std::size_t count, double seconds = patient(5)) {
    while (read_.size() < count)
      if (!fill(seconds)) return std::nullopt;
    std::string bytes = read_.substr(0, count);
    read_.erase(0, count);
    return bytes;
  }

  /// Up to and with the mark.
  std::optional<std::string> take_until(std::string_view mark, double seconds = patient(5)) {
    std::size_t at;
    while ((at = read_.find(mark)) == std::string::npos)
      if (!fill(seconds)) return std::nullopt;
    return take(at + mark.size());
  }

  /// All until the other side closes; none where it does not.
  std::optional<std::string> take_rest(double seconds = patient(5)) {
    while (fill(seconds)) {
    }
    if (!closed_) return std::nullopt;
    return std::exchange(read_, "");
  }

  [[nodiscard]] bool is_closed() const { return closed_; }

 private:
  bool fill(double seconds) {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, static_cast<int>(1000 * seconds)) <= 0) return false;
    char bytes[65536];
    const ssize_t count = ::recv(socket_, bytes, sizeof bytes, 0);
    closed_ = count <= 0;
    if (count > 0) read_.append(bytes, count);
    return count > 0;
  }

  int socket_;
  bool closed_ = false;
  std::string read_;
};

/// The whole answer to a request, from its status line on.
inline std::string answer_to(int port, const std::string& request) {
  PlainSocket socket(port);
  socket.send(request);
  return socket.take_rest().value_or("no answer");
}

inline std::string host_of(int port) {
  return "127.0.0.1:" + std::to_string(port);
}

enum Opcode : int { continued = 0, text = 1, binary = 2, closing = 8, ping = 9, pong = 10 };

struct LiveMessage {
  int opcode = text;
  std::string bytes;

  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(bytes); }
  [[nodiscard]] int close_code() const {
    if (opcode != closing || bytes.size() < 2) return 0;
    return 256 * static_cast<unsigned char>(bytes[0]) + static_cast<unsigned char>(bytes[1]);
  }
};

/// A frame of a shape taken apart.
struct LiveFrame {
  nlohmann::json head;
  std::vector<float> numbers;

  explicit LiveFrame(const std::string& bytes) {
    std::uint32_t length = 0;
    if (bytes.size() < sizeof length) throw std::runtime_error("a frame without a head");
    std::memcpy(&length, bytes.data(), sizeof length);
    if (length % 4 != 0 || length > bytes.size() - sizeof length) throw std::runtime_error("a head of another length");
    head = nlohmann::json::parse(bytes.substr(sizeof length, length));
    const std::size_t begin = sizeof length + length;
    if ((bytes.size() - begin) % sizeof(float) != 0) throw std::runtime_error("a frame that ends amid a number");
    numbers.resize((bytes.size() - begin) / sizeof(float));
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data() + begin, bytes.size() - begin);
  }
};

/// A page's end of the WebSocket, without a browser.
class LiveClient {
 public:
  /// throws  std::runtime_error where the server does not let it in
  explicit LiveClient(int port, int receive_buffer = 0) : socket_(port, receive_buffer) {
    socket_.send("GET /live HTTP/1.1\r\nHost: " + host_of(port) + "\r\nOrigin: http://" + host_of(port) +
                 "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    const std::string head = socket_.take_until("\r\n\r\n").value_or("");
    if (head.find("HTTP/1.1 101 ") != 0) throw std::runtime_error("not let in: " + head);
    // of RFC 6455, Section 1.3
    if (head.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") == std::string::npos) throw std::runtime_error("no accept key");
  }

  bool send(std::string_view bytes, int opcode = text, bool last = true) {
    std::string frame(1, static_cast<char>((last ? 0x80 : 0) | opcode));
    if (bytes.size() < 126) {
      frame += static_cast<char>(0x80 | bytes.size());
    } else {
      const bool large = bytes.size() > 0xffff;
      frame += static_cast<char>(0x80 | (large ? 127 : 126));
      for (int shift = large ? 56 : 8; shift >= 0; shift -= 8) frame += static_cast<char>(bytes.size() >> shift & 255);
    }
    const char mask[4] = {1, 2, 3, 4};
    frame.append(mask, 4);
    for (std::size_t i = 0; i < bytes.size(); ++i) frame += static_cast<char>(bytes[i] ^ mask[i % 4]);
    return socket_.send(frame);
  }
  bool say(const nlohmann::json& json) { return send(json.dump()); }
  void hello(const std::string& secret) { say(nlohmann::json{{"type", "hello"}, {"secret", secret}}); }
  void command(std::uint64_t id, const std::vector<double>& commands) {
    say(nlohmann::json{{"type", "command"}, {"id", id}, {"commands", commands}});
  }
  void target(std::uint64_t id, int marker, const std::vector<double>& at) {
    say(nlohmann::json{{"type", "target"}, {"id", id}, {"marker", marker}, {"at", at}});
  }

  /// The next message that is no ping, which are answered; none where nothing comes. Servers do not mask.
  std::optional<LiveMessage> receive(double seconds = patient(5)) {
    LiveMessage message;
    for (bool first = true;;) {
      const auto head = socket_.take(2, seconds);
      if (!head) return std::nullopt;
      const auto byte = [](char c) { return static_cast<std::uint64_t>(static_cast<unsigned char>(c)); };
      const int opcode = static_cast<int>(byte((*head)[0]) & 15);
      const bool last = byte((*head)[0]) >> 7 != 0;
      std::uint64_t length = byte((*head)[1]) & 127;
      if (length >= 126) {
        const auto more = socket_.take(length == 126 ? 2 : 8, seconds);
        if (!more) return std::nullopt;
        length = 0;
        for (const char c : *more) length = length << 8 | byte(c);
      }
      auto bytes = socket_.take(length, seconds);
      if (!bytes) return std::nullopt;
      if (opcode == ping) {
        send(*bytes, pong);
        continue;
      }
      if (first) message.opcode = opcode;
      first = false;
      message.bytes += *bytes;
      if (last) return message;
    }
  }

  /// The next text of this type; shapes and other texts before it do not count.
  nlohmann::json next(const std::string& type) {
    while (const auto message = receive()) {
      if (message->opcode != text) continue;
      if (nlohmann::json json = message->json(); json.at("type") == type) return json;
    }
    return {};
  }
  /// The next state for which something holds.
  template <class Holds>
  bool comes_to(const Holds& holds) {
    for (nlohmann::json state; !(state = next("state")).is_null();)
      if (holds(state)) return true;
    return false;
  }
  /// The next shape, or the one with a number.
  std::optional<LiveFrame> shape(std::int64_t id = -1, double seconds = patient(5)) {
    while (const auto message = receive(seconds)) {
      if (message->opcode == closing) return std::nullopt;
      if (message->opcode != binary) continue;
      LiveFrame frame(message->bytes);
      if (id < 0 || frame.head.at("id") == id) return frame;
    }
    return std::nullopt;
  }
  /// The code with which the server closes; 0: it does not, -1: it goes without a word.
  int close_code(double seconds = patient(5)) {
    while (const auto message = receive(seconds))
      if (message->opcode == closing) return message->close_code();
    return socket_.is_closed() ? -1 : 0;
  }

  PlainSocket& socket() { return socket_; }

 private:
  PlainSocket socket_;
};

}  // namespace softkin::view::testing
