#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>

#include "live_server.hpp"

namespace softkin::view {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

using net::ip::tcp;
using Bytes = std::shared_ptr<const std::string>;

/// Counts what a socket writes, and lets it read no faster than bytes_per_second.
class Pace {
 public:
  [[nodiscard]] std::size_t written() const { return written_; }

 private:
  friend class beast::rate_policy_access;

  [[nodiscard]] std::size_t available_read_bytes() const noexcept {
    return static_cast<std::size_t>(std::max(0.0, allowance_.left(Clock::now())));
  }
  [[nodiscard]] static std::size_t available_write_bytes() noexcept { return std::numeric_limits<std::size_t>::max(); }
  void transfer_read_bytes(std::size_t count) noexcept { allowance_.take(static_cast<double>(count), Clock::now()); }
  void transfer_write_bytes(std::size_t count) noexcept { written_ += count; }
  static void on_timer() noexcept {}

  static constexpr double bytes_per_second = 1024 * 1024;
  Allowance allowance_{bytes_per_second, bytes_per_second};
  std::size_t written_ = 0;
};

using Stream = beast::basic_stream<tcp, net::any_io_executor, Pace>;

class Connection;

/// The interface of a connection to the server that accepted it.
class Host {
 public:
  virtual ~Host() = default;
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual const LiveLimits& limits() const = 0;
  [[nodiscard]] virtual const LiveContent& content() const = 0;
  [[nodiscard]] virtual const Model& model() const = 0;
  [[nodiscard]] virtual LiveState state_of(const Connection& connection) const = 0;
  virtual void greet(Connection& connection) = 0;  // it said hello
  virtual void obey(Connection& connection, const ClientMessage& message) = 0;
  virtual void retire(Connection& connection) = 0;  // it is ending: it neither watches nor controls
  virtual void leave(const std::shared_ptr<Connection>& connection) = 0;
};

/// One connection, from its request to its end. Reads and writes one thing at a time.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Host& host);

  /// Reads the request and answers it.
  void begin();
  /// Answers any request with the error that there are too many connections.
  void refuse();

  // For connections that watch.
  [[nodiscard]] bool has_secret() const { return has_secret_; }
  void show(Bytes frame);
  [[nodiscard]] bool has_frame() const { return frame_ != nullptr; }
  void report_state();
  void send(Bytes text);
  void refuse(const Refusal& refusal);

  /// Closes with a reason; without one where there is no WebSocket yet.
  void close(websocket::close_code code);
  /// Ends at once.
  void drop();
  /// Called now and then: ends what does not come on.
  void sweep(Clock::time_point now);

 private:
  /// asking: HTTP. open: a WebSocket that did not say hello yet.
  enum class Stage { asking, open, greeted, ending };

  [[nodiscard]] Stream& stream() { return socket_.next_layer(); }
  [[nodiscard]] bool is_open() const { return stage_ == Stage::open || stage_ == Stage::greeted; }
  void prepare();
  void begin_writing();
  void requested(beast::error_code error);
  void answer(http::status status, const char* type, std::string_view text);
  void linger();
  void end();
  void accept();
  bool too_many();
  void read();
  void take_message();
  void take_message(const ClientMessage& message);
  void check_id(const ClientMessage& message);
  void write();

  Host& host_;
  websocket::stream<Stream> socket_;
  beast::flat_buffer buffer_{16384};
  std::optional<http::request_parser<http::empty_body>> request_;
  Allowance messages_;
  int refusals_ = 0;
  RequestId last_id_ = 0;
  Stage stage_ = Stage::asking;
  bool has_secret_ = false;
  Clock::time_point opened_{}, since_{};  // since_: of the last byte written, or of the end

  bool writing_ = false;
  std::size_t written_ = 0;
  std::deque<Bytes> texts_;  // fewer than the refusals that end it, a state and a map
  bool state_due_ = false;
  std::string reported_state_;
  Bytes frame_;  // the newest
};

}  // namespace softkin::view
