#include "live_server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <csignal>
#include <deque>
#include <set>

namespace softkin::view {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

namespace {

using net::ip::tcp;
using Clock = std::chrono::steady_clock;
using Bytes = std::shared_ptr<const std::string>;

constexpr std::size_t refused_at_once = 64;       // connections that are only told that there are too many
constexpr double linger_s = 2;                    // for the other side to read that it goes
constexpr int send_buffer = 256 * 1024;           // [bytes] what waits here is not the newest
constexpr double bytes_per_second = 1024 * 1024;  // that one connection may send
constexpr auto sweep_every = std::chrono::milliseconds(250);

double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

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

  Allowance allowance_{bytes_per_second, bytes_per_second};
  std::size_t written_ = 0;
};

/// Of a request; none: of what is none.
std::optional<RequestId> id_of(const ClientMessage& message) {
  if (const auto* command = std::get_if<CommandRequest>(&message)) return command->id;
  if (const auto* target = std::get_if<TargetRequest>(&message)) return target->id;
  if (const auto* readings = std::get_if<ReadingsRequest>(&message)) return readings->id;
  return std::nullopt;
}

using Stream = beast::basic_stream<tcp, net::any_io_executor, Pace>;
using Response = http::response<http::span_body<const char>>;

class Connection;

/// What connections need of who accepted them.
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
  Connection(tcp::socket socket, Host& host)
      : host_(host),
        socket_(std::move(socket)),
        messages_(host.limits().messages_per_second, host.limits().messages_at_once) {}

  /// Reads the request and answers it.
  void begin() {
    prepare();
    request_.emplace();
    request_->header_limit(8192);
    stream().expires_after(duration(host_.limits().head_s));
    http::async_read(stream(), buffer_, *request_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->requested(error); });
  }

  /// Says that there are too many, whatever is asked.
  void refuse() {
    prepare();
    answer(http::status::service_unavailable, "text/plain", "too many connections\n");
  }

  // Of what watches.
  [[nodiscard]] bool has_secret() const { return has_secret_; }
  void show(Bytes frame) {
    frame_ = std::move(frame);
    write();
  }
  [[nodiscard]] bool has_frame() const { return frame_ != nullptr; }
  void tell_state() {
    state_due_ = true;
    write();
  }
  void tell(Bytes text) {
    texts_.push_back(std::move(text));
    write();
  }
  void refuse(const Refusal& refusal) {
    if (++refusals_ >= host_.limits().refusals) return close(websocket::close_code::policy_error);
    tell(std::make_shared<const std::string>(refused_text(refusal)));
  }

  /// Says why it ends; without a word where there is no WebSocket yet.
  void close(websocket::close_code code) {
    if (ending_) return;
    if (!open_) return drop();
    ending_ = true;
    since_ = Clock::now();
    host_.retire(*this);
    socket_.async_close(code, [self = shared_from_this()](beast::error_code) { self->drop(); });
  }

  /// Ends at once.
  void drop() {
    ending_ = true;
    stream().close();
    host_.retire(*this);
    host_.leave(shared_from_this());
  }

  /// Called now and then: ends what does not come on.
  void sweep(Clock::time_point now) {
    const LiveLimits& limits = host_.limits();
    if (ending_) {
      if (seconds_between(since_, now) > linger_s) drop();
      return;
    }
    if (writing_ && written_ != stream().rate_policy().written()) {
      written_ = stream().rate_policy().written();
      since_ = now;
    }
    if (writing_ && seconds_between(since_, now) > limits.stalled_s) return drop();
    if (open_ && !greeted_ && seconds_between(opened_, now) > limits.head_s) close(websocket::close_code::policy_error);
  }

 private:
  [[nodiscard]] Stream& stream() { return socket_.next_layer(); }
  static Clock::duration duration(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  void prepare() {
    beast::error_code ignored;
    stream().socket().set_option(tcp::no_delay(true), ignored);
    stream().socket().set_option(net::socket_base::send_buffer_size(send_buffer), ignored);
  }

  void begin_writing() {
    writing_ = true;
    written_ = stream().rate_policy().written();
    since_ = Clock::now();
  }

  void requested(beast::error_code error) {
    const bool ends = error == http::error::end_of_stream || error == http::error::partial_message;
    const bool malformed = error && error.category() == http::make_error_code(http::error::bad_method).category();
    if (error && (ends || !malformed)) return drop();
    if (error) return answer(http::status::bad_request, "text/plain", "this is no request\n");
    const auto& request = request_->get();
    const auto text = [&](http::field field) {
      const beast::string_view value = request[field];
      return std::string_view(value.data(), value.size());
    };
    const RequestHead head{{request.method_string().data(), request.method_string().size()},
                           {request.target().data(), request.target().size()},
                           text(http::field::host),
                           text(http::field::origin),
                           request.count(http::field::host),
                           request.count(http::field::origin),
                           websocket::is_upgrade(request)};
    switch (entry_of(head, host_.port())) {
      case Entry::page:
        return answer(http::status::ok, "text/html; charset=utf-8", host_.content().page.html);
      case Entry::live:
        return accept();
      case Entry::forbidden:
        return answer(http::status::forbidden, "text/plain", "only for pages of this address\n");
      case Entry::not_allowed:
        return answer(http::status::method_not_allowed, "text/plain", "only GET\n");
      case Entry::not_found:
        break;
    }
    answer(http::status::not_found, "text/plain", "there is nothing here\n");
  }

  /// text: outlives the connection
  void answer(http::status status, const char* type, std::string_view text) {
    const auto response = std::make_shared<Response>(status, 11);
    response->set(http::field::content_type, type);
    response->set("Content-Security-Policy", host_.content().page.policy);
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set(http::field::cache_control, "no-store");
    response->set("Cross-Origin-Resource-Policy", "same-origin");
    if (status == http::status::method_not_allowed) response->set(http::field::allow, "GET");
    response->keep_alive(false);
    response->body() = {text.data(), text.size()};
    response->prepare_payload();
    stream().expires_never();
    begin_writing();
    http::async_write(stream(), *response, [self = shared_from_this(), response](beast::error_code error, std::size_t) {
      self->writing_ = false;
      if (error) return self->drop();
      self->linger();
    });
  }

  /// What the other side still sends is read: a reset would take the answer away from it.
  void linger() {
    if (!ending_) {
      ending_ = true;
      since_ = Clock::now();
      beast::error_code ignored;
      stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
    }
    buffer_.clear();
    stream().async_read_some(buffer_.prepare(1024), [self = shared_from_this()](beast::error_code error, std::size_t) {
      error ? self->drop() : self->linger();
    });
  }

  void accept() {
    const LiveLimits& limits = host_.limits();
    stream().expires_never();
    socket_.set_option(websocket::stream_base::timeout{duration(limits.head_s), duration(limits.idle_s), true});
    socket_.read_message_max(longest_message_of(host_.content().readings));
    socket_.auto_fragment(false);
    socket_.control_callback([this](websocket::frame_type, beast::string_view) { too_many(); });
    socket_.async_accept(request_->get(), [self = shared_from_this()](beast::error_code error) {
      if (error) return self->drop();
      self->request_.reset();
      self->buffer_.clear();
      self->open_ = true;
      self->opened_ = Clock::now();
      self->read();
    });
  }

  /// Counts one more that it sent; too many in a short time end it.
  bool too_many() {
    const auto now = Clock::now();
    messages_.take(1, now);
    if (messages_.left(now) >= 0) return false;
    // not from inside of what reads
    net::post(socket_.get_executor(),
              [self = shared_from_this()] { self->close(websocket::close_code::policy_error); });
    return true;
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->drop();
      if (!self->ending_) self->take_message();
      self->buffer_.clear();
      self->read();
    });
  }

  void take_message() {
    if (too_many()) return;
    if (socket_.got_binary()) return close(websocket::close_code::unknown_data);
    const auto data = buffer_.cdata();
    try {
      take_message(read_client_message({static_cast<const char*>(data.data()), data.size()}, host_.model(),
                                       host_.content().readings));
    } catch (const Refusal& refusal) {
      refuse(refusal);
    }
  }

  void take_message(const ClientMessage& message) {
    if (const Hello* hello = std::get_if<Hello>(&message)) {
      if (greeted_) throw Refusal("hello was said already");
      has_secret_ = same_secret(hello->secret, host_.content().secret);
      greeted_ = true;
      return host_.greet(*this);
    }
    if (!greeted_) throw Refusal("hello comes first");
    check_id(message);
    host_.obey(*this, message);
  }

  void check_id(const ClientMessage& message) {
    const RequestId id = id_of(message).value_or(0);
    if (id == 0) return;
    if (id <= last_id_) throw Refusal("id must be larger than that of the request before", id);
    last_id_ = id;
  }

  /// What is to be told before the newest shape; nothing while something is on its way.
  void write() {
    if (writing_ || ending_ || !open_) return;
    if (std::exchange(state_due_, false)) {
      std::string state = state_text(host_.state_of(*this));
      if (state != told_state_) texts_.push_back(std::make_shared<const std::string>(state));
      told_state_ = std::move(state);
    }
    const bool is_text = !texts_.empty();
    const Bytes bytes = is_text ? std::exchange(texts_.front(), nullptr) : std::exchange(frame_, nullptr);
    if (is_text) texts_.pop_front();
    if (!bytes) return;
    begin_writing();
    socket_.text(is_text);
    socket_.async_write(net::buffer(*bytes), [self = shared_from_this(), bytes](beast::error_code error, std::size_t) {
      self->writing_ = false;
      if (error) return self->drop();
      self->write();
    });
  }

  Host& host_;
  websocket::stream<Stream> socket_;
  beast::flat_buffer buffer_{16384};
  std::optional<http::request_parser<http::empty_body>> request_;
  Allowance messages_;
  int refusals_ = 0;
  RequestId last_id_ = 0;
  bool open_ = false, greeted_ = false, has_secret_ = false, ending_ = false;
  Clock::time_point opened_{}, since_{};  // since_: of the last byte written, or of the end

  bool writing_ = false;
  std::size_t written_ = 0;
  std::deque<Bytes> texts_;  // fewer than the refusals that end it, a state and a map
  bool state_due_ = false;
  std::string told_state_;
  Bytes frame_;  // the newest
};

}  // namespace

struct LiveServer::Parts : Host {
  Parts(int wanted, const LiveLimits& allowed) : limits_(allowed) {
    const tcp::endpoint place(net::ip::address_v4::loopback(), static_cast<unsigned short>(wanted));
    beast::error_code error;
    acceptor_.open(place.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(place, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error)
      throw InvalidInput("--port " + std::to_string(wanted) + ": cannot listen at 127.0.0.1: " + error.message());
    port_ = acceptor_.local_endpoint().port();
  }

  [[nodiscard]] int port() const override { return port_; }
  [[nodiscard]] const LiveLimits& limits() const override { return limits_; }
  [[nodiscard]] const LiveContent& content() const override { return content_; }
  [[nodiscard]] const Model& model() const override { return *model_; }

  [[nodiscard]] LiveState state_of(const Connection& connection) const override {
    return {content_.model, connection.has_secret(), controller_ == &connection, controller_ == nullptr && !lent_,
            lent_,          presence().watchers};
  }

  [[nodiscard]] Presence presence() const {
    return {greeted_.size() - (controller_ != nullptr ? 1 : 0), controller_ != nullptr, lent_};
  }

  void greet(Connection& connection) override {
    greeted_.insert(&connection);
    if (connection.has_secret() && controller_ == nullptr && !lent_) {
      give_control(&connection);
    } else {
      connection.tell_state();  // the others with the next sweep
    }
    if (map_) connection.tell(map_);
    if (current_) connection.show(nobodys_frame());
  }

  void obey(Connection& connection, const ClientMessage& message) override {
    if (std::holds_alternative<Take>(message)) {
      if (!connection.has_secret()) throw Refusal("only who has the secret of the address takes control");
      if (lent_) throw Refusal("readings are streamed to the robot, which has no other control meanwhile");
      if (controller_ != &connection) give_control(&connection);
      return;
    }
    if (controller_ != &connection) throw Refusal("another one has control, or nobody", id_of(message));
    if (const auto* command = std::get_if<CommandRequest>(&message))
      ask_({turn_, *command});
    else if (const auto* target = std::get_if<TargetRequest>(&message))
      ask_({turn_, *target});
    else if (const auto* readings = std::get_if<ReadingsRequest>(&message))
      ask_({turn_, *readings});
    else
      give_control(nullptr);  // release
  }

  void retire(Connection& connection) override {
    if (lender_ == &connection) lender_ = nullptr;
    if (greeted_.erase(&connection) > 0 && controller_ == &connection) give_control(nullptr);
  }

  void leave(const std::shared_ptr<Connection>& connection) override {
    refused_.erase(connection);
    if (connections_.erase(connection) == 0) return;
    if (stopping_ && connections_.empty()) context_.stop();
  }

  void give_control(Connection* connection) {
    controller_ = connection;
    ++turn_;
    for (Connection* each : greeted_) {
      if (each->has_frame()) each->show(nobodys_frame());  // its number is of another's request
      each->tell_state();
    }
  }

  void lend(bool lent) {
    if (std::exchange(lent_, lent) == lent) return;
    if (lent) lender_ = controller_;
    give_control(lent ? nullptr : std::exchange(lender_, nullptr));
  }

  /// The shape for who did not ask for it.
  Bytes nobodys_frame() {
    if (!nobodys_frame_) nobodys_frame_ = std::make_shared<const std::string>(frame_bytes(current_->shape, 0));
    return nobodys_frame_;
  }

  void take_shape(std::shared_ptr<const LiveAnswer> answer) {
    current_ = std::move(answer);
    nobodys_frame_.reset();
    const bool asked = controller_ != nullptr && current_->asker == turn_;
    const Bytes frame =
        asked ? std::make_shared<const std::string>(frame_bytes(current_->shape, current_->shape.id)) : nobodys_frame();
    if (controller_ != nullptr) controller_->show(frame);
    for (Connection* each : greeted_)
      if (each != controller_) each->show(frame);
  }

  void take_map(Bytes text) {
    map_ = std::move(text);
    for (Connection* each : greeted_) each->tell(map_);
  }

  void accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (stopping_) return;
      if (error) {  // no descriptor is left: some connection may end by then
        pause_.expires_after(std::chrono::milliseconds(100));
        return pause_.async_wait([this](beast::error_code) { accept(); });
      }
      enter(std::move(socket));
      accept();
    });
  }

  void enter(tcp::socket socket) {
    const bool full = connections_.size() >= limits_.connections;
    if (full && refused_.size() >= refused_at_once) return;
    const auto connection = std::make_shared<Connection>(std::move(socket), *this);
    (full ? refused_ : connections_).insert(connection);
    full ? connection->refuse() : connection->begin();
  }

  void sweep() {
    timer_.expires_after(sweep_every);
    timer_.async_wait([this](beast::error_code error) {
      if (error) return;
      const auto now = Clock::now();
      for (const auto* set : {&connections_, &refused_})
        for (const auto& each : std::vector(set->begin(), set->end())) each->sweep(now);
      if (const Presence there = presence(); there != told_) {
        told_ = there;
        for (Connection* each : greeted_) each->tell_state();
        if (notice_) notice_(there);
      }
      sweep();
    });
  }

  void stop() {
    if (stopping_) return context_.stop();
    stopping_ = true;
    beast::error_code ignored;
    acceptor_.close(ignored);
    for (const auto& each : std::vector(connections_.begin(), connections_.end()))
      each->close(websocket::close_code::going_away);
    if (connections_.empty()) return context_.stop();
    pause_.expires_after(std::chrono::milliseconds(500));
    pause_.async_wait([this](beast::error_code) { context_.stop(); });
  }

  using Connections = std::set<std::shared_ptr<Connection>>;

  LiveLimits limits_;
  net::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  net::steady_timer timer_{context_}, pause_{context_};
  net::signal_set signals_{context_};
  int port_ = 0;
  const Model* model_ = nullptr;
  LiveContent content_;
  Ask ask_;
  Notice notice_;

  Connections connections_, refused_;
  Connection* controller_ = nullptr;
  Connection* lender_ = nullptr;   // had control before the robot was lent
  bool lent_ = false;              // to a stream of readings
  std::uint64_t turn_ = 0;         // counts who had control
  std::set<Connection*> greeted_;  // of connections_
  Presence told_;
  std::shared_ptr<const LiveAnswer> current_;
  Bytes nobodys_frame_;
  Bytes map_;  // that was made meanwhile
  bool stopping_ = false;
};

LiveServer::LiveServer(int port, const LiveLimits& limits) : parts_(std::make_unique<Parts>(port, limits)) {}

LiveServer::~LiveServer() = default;

int LiveServer::port() const {
  return parts_->port();
}

void LiveServer::run(const Model& model, LiveContent content, Ask ask, const Notice& notice, bool signals) {
  Parts& parts = *parts_;
  parts.model_ = &model;
  parts.content_ = std::move(content);
  parts.ask_ = std::move(ask);
  parts.notice_ = notice;
  if (signals) {
    parts.signals_.add(SIGINT);
    parts.signals_.add(SIGTERM);
    parts.signals_.async_wait([&parts](beast::error_code error, int) {
      if (!error) parts.stop();
    });
  }
  parts.accept();
  parts.sweep();
  parts.context_.run();
}

void LiveServer::show(std::shared_ptr<const LiveAnswer> answer) {
  net::post(parts_->context_, [parts = parts_.get(), answer = std::move(answer)] { parts->take_shape(answer); });
}

void LiveServer::give_map(const std::string& map) {
  net::post(parts_->context_, [parts = parts_.get(), text = std::make_shared<const std::string>(map_text(map))] {
    parts->take_map(text);
  });
}

void LiveServer::lend(bool lent) {
  net::post(parts_->context_, [parts = parts_.get(), lent] { parts->lend(lent); });
}

void LiveServer::stop() {
  net::post(parts_->context_, [parts = parts_.get()] { parts->stop(); });
}

}  // namespace softkin::view
