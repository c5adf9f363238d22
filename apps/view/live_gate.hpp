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

/// The head of a request to the server. count: of the header fields of that name.
struct RequestHead {
  std::string_view method, target, host, origin;
  std::size_t hosts = 1, origins = 0;
  bool upgrade = false;  // to a WebSocket
};

enum class Entry { page, live, forbidden, not_found, not_allowed };

/// Decides who is let in. Only pages of this server's own address may connect: a page of another site whose name
/// resolves to 127.0.0.1 (DNS rebinding) names its own host, and a page that connects from elsewhere names its origin.
[[nodiscard]] Entry entry_of(const RequestHead& head, int port);

/// Limits a rate: at most per_second in the long run, and at_once in a burst.
class Allowance {
 public:
  using Time = Clock::time_point;

  Allowance(double per_second, double at_once) : rate_(per_second), max_(at_once), left_(at_once) {}

  /// Returns how many may be taken now [-].
  [[nodiscard]] double left(Time now) const;
  /// Takes count of them; what is left may fall below 0.
  void take(double count, Time now);

 private:
  double rate_, max_, left_;
  Time last_{};
};

/// A page and its security policy.
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
/// estimate  what the page needs in order to send readings, JSON; empty: nothing is estimated
/// throws    InvalidInput where the page has no such tag, or no place for a document
[[nodiscard]] LivePage live_page(std::string_view page, std::string document, const std::string& model, int port,
                                 const std::string& estimate = "");

/// 16 hexadecimal digits of texts. source: FNV-1a, 64 bit
[[nodiscard]] std::string fingerprint_of_texts(const std::initializer_list<std::string_view>& texts);

}  // namespace softkin::view
