#include "reading_stream.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <deque>
#include <set>
#include <thread>

#include "live_gate.hpp"

namespace softkin::view {

namespace net = boost::asio;

namespace {

using net::ip::tcp;
using ErrorCode = boost::system::error_code;

constexpr auto look_every = std::chrono::milliseconds(250);
constexpr double longest_answer_s = 600;                        // to a writer that has sent all
constexpr std::uint64_t first_writer = std::uint64_t{1} << 63;  // askers below it are pages

class Writer;

/// The interface of a connection to the stream that accepted it.
class WriterHost {
 public:
  virtual ~WriterHost() = default;
  [[nodiscard]] virtual const StreamLimits& limits() const = 0;
  [[nodiscard]] virtual const LineColumns& columns() const = 0;
  /// Throws Refusal: another token, or another one writes.
  virtual void let_in(Writer& writer, const std::string& token) = 0;
  virtual void ask(ReadingsRequest request) = 0;
  /// Is every line of the current writer estimated or passed over?
  [[nodiscard]] virtual bool has_reported_all() const = 0;
  virtual void retire(Writer& writer) = 0;  // it is ending: it streams no more
  virtual void leave(const std::shared_ptr<Writer>& writer) = 0;
};

/// One connection: its token, then its readings. Reads and writes one thing at a time.
class Writer : public std::enable_shared_from_this<Writer> {
 public:
  Writer(tcp::socket socket, WriterHost& host)
      : host_(host), socket_(std::move(socket)), lines_(host.limits().lines_per_second, host.limits().lines_at_once) {
    ErrorCode ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
  }

  void begin() { read(); }

  /// Sends an estimate, in place of one that still waits.
  void show(std::string line) {
    reported_ = std::move(line);
    write();
  }

  /// Writes the pending lines, then ends.
  void end() {
    if (std::exchange(ending_, true)) return;
    since_ = Clock::now();
    host_.retire(*this);
    write();
  }

  /// Ends at once.
  void drop() {
    ending_ = true;
    ErrorCode ignored;
    socket_.close(ignored);
    host_.leave(shared_from_this());
  }

  /// Called now and then: ends what does not come on.
  void look(Clock::time_point now) {
    const StreamLimits& limits = host_.limits();
    if (ending_ && seconds_between(since_, now) > linger_s) return drop();
    if (writing_ && seconds_between(since_, now) > limits.stalled_s) return drop();
    if (has_said_all_ && seconds_between(since_, now) > longest_answer_s) return drop();
    if (!ending_ && !let_in_ && seconds_between(opened_, now) > limits.head_s) refuse("no token came", true);
  }

 private:
  void read() {
    net::async_read_until(
        socket_, net::dynamic_buffer(text_, longest_line + 1), '\n',
        [self = shared_from_this()](ErrorCode error, std::size_t length) { self->have_read(error, length); });
  }

  void have_read(ErrorCode error, std::size_t length) {
    if (ending_) return;
    if (error == net::error::not_found)  // the buffer is full
      return refuse("a line is at most " + std::to_string(longest_line) + " bytes long", true);
    if (error == net::error::eof && let_in_) {  // its last line is still answered
      has_said_all_ = true;
      since_ = Clock::now();
      if (!text_.empty()) take_line(std::exchange(text_, ""));
      return write();
    }
    if (error) return drop();
    std::string line = text_.substr(0, length - 1);
    text_.erase(0, length);
    take_line(std::move(line));
    if (!ending_) read();
  }

  void take_line(std::string line) {
    if (line.ends_with('\r')) line.pop_back();
    lines_.take(1, Clock::now());
    if (lines_.left(Clock::now()) < 0) return refuse("too many lines in a short time", true);
    try {
      take(line);
    } catch (const Refusal& refusal) {
      refuse(refusal.what(), !let_in_);
    }
  }

  void take(const std::string& line) {
    if (!let_in_) {
      host_.let_in(*this, read_token_line(line));
      let_in_ = true;
      return;
    }
    ReadingsRequest request = read_reading_line(line, host_.columns(), last_s_);
    if (request.time_s) last_s_ = request.time_s;
    host_.ask(std::move(request));
  }

  void refuse(const std::string& why, bool ends) {
    errors_.push_back(error_line(why));
    if (ends || ++refusals_ >= host_.limits().refusals) return end();
    write();
  }

  /// Writes errors first; does nothing while a write is in progress.
  void write() {
    if (writing_) return;
    if (!errors_.empty()) {
      writes_ = std::move(errors_.front()) + "\n";
      errors_.pop_front();
    } else if (reported_) {
      writes_ = *std::exchange(reported_, std::nullopt) + "\n";
    } else {
      if (ending_) return hang_up();
      if (has_said_all_ && host_.has_reported_all()) end();
      return;
    }
    writing_ = true;
    since_ = Clock::now();
    net::async_write(socket_, net::buffer(writes_), [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->writing_ = false;
      if (error) return self->drop();
      self->write();
    });
  }

  /// What the other side still sends is read: a reset would take the last words away from it.
  void hang_up() {
    ErrorCode ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    socket_.async_read_some(net::buffer(rest_), [self = shared_from_this()](ErrorCode error, std::size_t) {
      error ? self->drop() : self->hang_up();
    });
  }

  WriterHost& host_;
  tcp::socket socket_;
  Allowance lines_;
  std::string text_;                     // that was read, and is not yet processed
  std::array<char, 4096> rest_{};        // input that is discarded; text_ may still be pending
  std::string writes_;                   // that is being written
  std::deque<std::string> errors_;       // fewer than the refusals that end it
  std::optional<std::string> reported_;  // the newest
  std::optional<double> last_s_;         // of the line before
  int refusals_ = 0;
  bool let_in_ = false, has_said_all_ = false, writing_ = false, ending_ = false;
  Clock::time_point opened_ = Clock::now(), since_{};  // since_: a write began, or an end
};

}  // namespace

struct ReadingStream::Parts : WriterHost {
  Parts(int wanted, const StreamLimits& allowed) : limits_(allowed) {
    const tcp::endpoint place(net::ip::address_v4::loopback(), static_cast<unsigned short>(wanted));
    ErrorCode error;
    acceptor_.open(place.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(place, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error)
      throw InvalidInput("--readings-port " + std::to_string(wanted) +
                         ": cannot listen at 127.0.0.1: " + error.message());
    port_ = acceptor_.local_endpoint().port();
  }

  [[nodiscard]] const StreamLimits& limits() const override { return limits_; }
  [[nodiscard]] const LineColumns& columns() const override { return *columns_; }

  void let_in(Writer& writer, const std::string& token) override {
    if (!same_secret(token, token_)) throw Refusal("this is not the token that softkin printed");
    if (writer_ != nullptr) throw Refusal("another one streams readings");
    writer_ = &writer;
    ++asker_;
    requested_ = reported_ = 0;
    times_.clear();
    lend_(true);
  }

  void ask(ReadingsRequest request) override {
    request.id = ++requested_;
    times_.emplace_back(request.id, request.time_s);
    ask_({asker_, std::move(request)});
  }

  [[nodiscard]] bool has_reported_all() const override { return reported_ == requested_; }

  void retire(Writer& writer) override {
    if (writer_ != &writer) return;
    writer_ = nullptr;
    lend_(false);
  }

  void leave(const std::shared_ptr<Writer>& writer) override {
    retire(*writer);
    writers_.erase(writer);
  }

  void take_answer(const LiveAnswer& answer) {
    if (writer_ == nullptr || answer.asker != asker_) return;
    const RequestId id = answer.shape.id;
    std::optional<double> time_s;
    while (!times_.empty() && times_.front().first <= id) {
      time_s = times_.front().second;
      times_.pop_front();
    }
    writer_->show(stream_line(answer.shape.estimate, time_s, id - std::exchange(reported_, id) - 1));
  }

  void accept() {
    acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
      if (stopping_) return;
      if (error) {  // no descriptor is left: some connection may end by then
        pause_.expires_after(std::chrono::milliseconds(100));
        return pause_.async_wait([this](ErrorCode) { accept(); });
      }
      if (writers_.size() < limits_.connections) {
        const auto writer = std::make_shared<Writer>(std::move(socket), *this);
        writers_.insert(writer);
        writer->begin();
      }
      accept();
    });
  }

  void look() {
    timer_.expires_after(look_every);
    timer_.async_wait([this](ErrorCode error) {
      if (error) return;
      const auto now = Clock::now();
      for (const auto& each : std::vector(writers_.begin(), writers_.end())) each->look(now);
      look();
    });
  }

  void stop() {
    stopping_ = true;
    for (const auto& each : std::vector(writers_.begin(), writers_.end())) each->drop();
    context_.stop();
  }

  StreamLimits limits_;
  net::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  net::steady_timer timer_{context_}, pause_{context_};
  int port_ = 0;
  std::optional<LineColumns> columns_;
  std::string token_;
  Ask ask_;
  Lend lend_;
  std::set<std::shared_ptr<Writer>> writers_;  // with those that have shown no token
  Writer* writer_ = nullptr;                   // of them, that streams
  std::uint64_t asker_ = first_writer;
  RequestId requested_ = 0, reported_ = 0;                         // of this writer's lines, the last
  std::deque<std::pair<RequestId, std::optional<double>>> times_;  // of the requests without an answer
  bool stopping_ = false;
  std::thread thread_;
};

ReadingStream::ReadingStream(int port, const StreamLimits& limits) : parts_(std::make_unique<Parts>(port, limits)) {}

ReadingStream::~ReadingStream() {
  stop();
}

int ReadingStream::port() const {
  return parts_->port_;
}

void ReadingStream::begin(LineColumns columns, std::string token, Ask ask, Lend lend) {
  Parts& parts = *parts_;
  parts.columns_.emplace(std::move(columns));
  parts.token_ = std::move(token);
  parts.ask_ = std::move(ask);
  parts.lend_ = std::move(lend);
  parts.accept();
  parts.look();
  parts.thread_ = std::thread([&parts] { parts.context_.run(); });
}

void ReadingStream::answer(std::shared_ptr<const LiveAnswer> answer) {
  net::post(parts_->context_, [parts = parts_.get(), answer = std::move(answer)] { parts->take_answer(*answer); });
}

void ReadingStream::stop() {
  if (!parts_->thread_.joinable()) return;
  net::post(parts_->context_, [parts = parts_.get()] { parts->stop(); });
  parts_->thread_.join();
}

}  // namespace softkin::view
