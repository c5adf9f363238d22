#include "live_connection.hpp"

#include <boost/asio/post.hpp>

namespace softkin::view {

namespace {

using Response = http::response<http::span_body<const char>>;

constexpr int send_buffer = 256 * 1024;  // [bytes] what waits here is not the newest

Clock::duration duration(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Connection::Connection(tcp::socket socket, Host& host)
    : host_(host),
      socket_(std::move(socket)),
      messages_(host.limits().messages_per_second, host.limits().messages_at_once) {}

void Connection::begin() {
  prepare();
  request_.emplace();
  request_->header_limit(8192);
  stream().expires_after(duration(host_.limits().head_s));
  http::async_read(stream(), buffer_, *request_,
                   [self = shared_from_this()](beast::error_code error, std::size_t) { self->requested(error); });
}

void Connection::refuse() {
  prepare();
  answer(http::status::service_unavailable, "text/plain", "too many connections\n");
}

void Connection::show(Bytes frame) {
  frame_ = std::move(frame);
  write();
}

void Connection::report_state() {
  state_due_ = true;
  write();
}

void Connection::send(Bytes text) {
  texts_.push_back(std::move(text));
  write();
}

void Connection::refuse(const Refusal& refusal) {
  if (++refusals_ >= host_.limits().refusals) return close(websocket::close_code::policy_error);
  send(std::make_shared<const std::string>(refused_text(refusal)));
}

void Connection::close(websocket::close_code code) {
  if (stage_ == Stage::ending) return;
  if (!is_open()) return drop();
  end();
  host_.retire(*this);
  socket_.async_close(code, [self = shared_from_this()](beast::error_code) { self->drop(); });
}

void Connection::drop() {
  stage_ = Stage::ending;
  stream().close();
  host_.retire(*this);
  host_.leave(shared_from_this());
}

void Connection::sweep(Clock::time_point now) {
  const LiveLimits& limits = host_.limits();
  if (stage_ == Stage::ending) {
    if (seconds_between(since_, now) > linger_s) drop();
    return;
  }
  if (writing_ && written_ != stream().rate_policy().written()) {
    written_ = stream().rate_policy().written();
    since_ = now;
  }
  if (writing_ && seconds_between(since_, now) > limits.stalled_s) return drop();
  if (stage_ == Stage::open && seconds_between(opened_, now) > limits.head_s)
    close(websocket::close_code::policy_error);
}

void Connection::prepare() {
  beast::error_code ignored;
  stream().socket().set_option(tcp::no_delay(true), ignored);
  stream().socket().set_option(net::socket_base::send_buffer_size(send_buffer), ignored);
}

void Connection::begin_writing() {
  writing_ = true;
  written_ = stream().rate_policy().written();
  since_ = Clock::now();
}

void Connection::requested(beast::error_code error) {
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
void Connection::answer(http::status status, const char* type, std::string_view text) {
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

void Connection::end() {
  stage_ = Stage::ending;
  since_ = Clock::now();
}

/// What the other side still sends is read: a reset would take the answer away from it.
void Connection::linger() {
  if (stage_ != Stage::ending) {
    end();
    beast::error_code ignored;
    stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
  }
  buffer_.clear();
  stream().async_read_some(buffer_.prepare(1024), [self = shared_from_this()](beast::error_code error, std::size_t) {
    error ? self->drop() : self->linger();
  });
}

void Connection::accept() {
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
    self->stage_ = Stage::open;
    self->opened_ = Clock::now();
    self->read();
  });
}

/// Counts one more that it sent; too many in a short time end it.
bool Connection::too_many() {
  const auto now = Clock::now();
  messages_.take(1, now);
  if (messages_.left(now) >= 0) return false;
  // not from inside of what reads
  net::post(socket_.get_executor(), [self = shared_from_this()] { self->close(websocket::close_code::policy_error); });
  return true;
}

void Connection::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) return self->drop();
    if (self->stage_ != Stage::ending) self->take_message();
    self->buffer_.clear();
    self->read();
  });
}

void Connection::take_message() {
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

void Connection::take_message(const ClientMessage& message) {
  if (const Hello* hello = std::get_if<Hello>(&message)) {
    if (stage_ == Stage::greeted) throw Refusal("hello was said already");
    has_secret_ = same_secret(hello->secret, host_.content().secret);
    stage_ = Stage::greeted;
    return host_.greet(*this);
  }
  if (stage_ != Stage::greeted) throw Refusal("hello comes first");
  check_id(message);
  host_.obey(*this, message);
}

void Connection::check_id(const ClientMessage& message) {
  const RequestId id = id_of(message).value_or(0);
  if (id == 0) return;
  if (id <= last_id_) throw Refusal("id must be larger than that of the request before", id);
  last_id_ = id;
}

/// Writes pending messages before the newest shape; does nothing while a write is in progress.
void Connection::write() {
  if (writing_ || !is_open()) return;
  if (std::exchange(state_due_, false)) {
    std::string state = state_text(host_.state_of(*this));
    if (state != reported_state_) texts_.push_back(std::make_shared<const std::string>(state));
    reported_state_ = std::move(state);
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

}  // namespace softkin::view
