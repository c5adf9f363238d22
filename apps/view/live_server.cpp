#include "live_server.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <set>

#include "live_connection.hpp"

namespace softkin::view {

namespace {

constexpr std::size_t refused_at_once = 64;  // connections that only receive the error that there are too many
constexpr auto sweep_every = std::chrono::milliseconds(250);

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
    return {content_.model,
            connection.has_secret(),
            control_.holder == &connection,
            control_.holder == nullptr && !control_.lent,
            control_.lent,
            presence().watchers};
  }

  [[nodiscard]] Presence presence() const {
    return {greeted_.size() - (control_.holder != nullptr ? 1 : 0), control_.holder != nullptr, control_.lent};
  }

  void greet(Connection& connection) override {
    greeted_.insert(&connection);
    if (connection.has_secret() && control_.holder == nullptr && !control_.lent) {
      give_control(&connection);
    } else {
      connection.report_state();  // the others with the next sweep
    }
    if (map_) connection.send(map_);
    if (current_) connection.show(nobodys_frame());
  }

  void obey(Connection& connection, const ClientMessage& message) override {
    if (std::holds_alternative<Take>(message)) {
      if (!connection.has_secret()) throw Refusal("only who has the secret of the address takes control");
      if (control_.lent) throw Refusal("readings are streamed to the robot, which has no other control meanwhile");
      if (control_.holder != &connection) give_control(&connection);
      return;
    }
    if (control_.holder != &connection) throw Refusal("another one has control, or nobody", id_of(message));
    if (const auto* command = std::get_if<CommandRequest>(&message))
      ask_({control_.turn, *command});
    else if (const auto* target = std::get_if<TargetRequest>(&message))
      ask_({control_.turn, *target});
    else if (const auto* readings = std::get_if<ReadingsRequest>(&message))
      ask_({control_.turn, *readings});
    else
      give_control(nullptr);  // release
  }

  void retire(Connection& connection) override {
    if (control_.lender == &connection) control_.lender = nullptr;
    if (greeted_.erase(&connection) > 0 && control_.holder == &connection) give_control(nullptr);
  }

  void leave(const std::shared_ptr<Connection>& connection) override {
    refused_.erase(connection);
    if (connections_.erase(connection) == 0) return;
    if (stopping_ && connections_.empty()) context_.stop();
  }

  void give_control(Connection* connection) {
    control_.holder = connection;
    ++control_.turn;
    for (Connection* each : greeted_) {
      if (each->has_frame()) each->show(nobodys_frame());  // its number is of another's request
      each->report_state();
    }
  }

  void lend(bool lent) {
    if (std::exchange(control_.lent, lent) == lent) return;
    if (lent) control_.lender = control_.holder;
    give_control(lent ? nullptr : std::exchange(control_.lender, nullptr));
  }

  /// The shape for clients that did not request it.
  Bytes nobodys_frame() {
    if (!nobodys_frame_) nobodys_frame_ = std::make_shared<const std::string>(frame_bytes(current_->shape, 0));
    return nobodys_frame_;
  }

  void take_shape(std::shared_ptr<const LiveAnswer> answer) {
    current_ = std::move(answer);
    nobodys_frame_.reset();
    const bool requested = control_.holder != nullptr && current_->asker == control_.turn;
    const Bytes frame = requested
                            ? std::make_shared<const std::string>(frame_bytes(current_->shape, current_->shape.id))
                            : nobodys_frame();
    if (control_.holder != nullptr) control_.holder->show(frame);
    for (Connection* each : greeted_)
      if (each != control_.holder) each->show(frame);
  }

  void take_map(Bytes text) {
    map_ = std::move(text);
    for (Connection* each : greeted_) each->send(map_);
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
      if (const Presence there = presence(); there != reported_) {
        reported_ = there;
        for (Connection* each : greeted_) each->report_state();
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
  /// The client that controls the robot.
  struct Control {
    Connection* holder = nullptr;
    Connection* lender = nullptr;  // had control before the robot was lent
    bool lent = false;             // to a stream of readings
    std::uint64_t turn = 0;        // counts changes of control
  };
  Control control_;
  std::set<Connection*> greeted_;  // of connections_
  Presence reported_;
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
