#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace softkin::view {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

/// What a connection that is ended stays open for, so that the other side reads why [s].
inline constexpr double linger_s = 2;

/// What a request for the server says of itself. count: of the header fields of that name.
struct RequestHead {
  std::string_view method, target, host, origin;
  std::size_t hosts = 1, origins = 0;
  bool upgrade = false;  // to a WebSocket
};

enum class Entry { page, live, forbidden, not_found, not_allowed };

/// Who is let in. Only pages of this server's own address may speak with it: a page of another site that a browser was
/// told to look for at 127.0.0.1 (DNS rebinding) names its own host, and one that connects from elsewhere its origin.
[[nodiscard]] Entry entry_of(const RequestHead& head, int port);

/// At most so many a second over time, and so many at once.
class Allowance {
 public:
  using Time = Clock::time_point;

  Allowance(double per_second, double at_once) : rate_(per_second), most_(at_once), left_(at_once) {}

  /// How many may be taken [-].
  [[nodiscard]] double left(Time now) const;
  /// Less so many, down to below 0.
  void take(double count, Time now);

 private:
  double rate_, most_, left_;
  Time last_{};
};

/// A page and who may do what in it.
struct LivePage {
  std::string html;
  std::string policy;  // Content-Security-Policy, for the header
};

/// The path at which the page finds the server.
inline constexpr const char* live_path = "/live";

/// The page with its document, that document with "live", and its policy with the connections to the server.
///
/// page      with a meta tag of its Content-Security-Policy
/// document  JSON, an object with at least one key
/// model     hexadecimal
/// estimate  what the page must know to ask for readings, JSON; empty: nothing is told
/// throws    InvalidInput where the page has no such tag, or no place for a document
[[nodiscard]] LivePage live_page(std::string_view page, std::string document, const std::string& model, int port,
                                 const std::string& estimate = "");

/// 16 hexadecimal digits of texts. source: FNV-1a, 64 bit
[[nodiscard]] std::string fingerprint_of_texts(const std::initializer_list<std::string_view>& texts);

}  // namespace softkin::view
