#include "live_gate.hpp"

#include <algorithm>
#include <cstdint>
#include <softkin/core/error.hpp>
#include <softkin/runs/page.hpp>

namespace softkin::view {

namespace {

/// Does a request name this server as its host?
bool names_us(std::string_view host, int port) {
  const std::string number = std::to_string(port);
  for (const char* name : {"127.0.0.1", "localhost"})
    if (host == name + (":" + number) || (port == 80 && host == name)) return true;
  return false;
}

}  // namespace

Entry entry_of(const RequestHead& head, int port) {
  if (head.hosts != 1 || !names_us(head.host, port)) return Entry::forbidden;
  if (head.method != "GET") return Entry::not_allowed;
  if (head.target == "/") return Entry::page;
  if (head.target != live_path) return Entry::not_found;
  if (head.origins != 1 || head.origin != "http://" + std::string(head.host)) return Entry::forbidden;
  return head.upgrade ? Entry::live : Entry::not_found;
}

double Allowance::left(Time now) const {
  const double seconds = last_ == Time{} ? 0 : std::chrono::duration<double>(now - last_).count();
  return std::min(max_, left_ + rate_ * std::max(0.0, seconds));
}

void Allowance::take(double count, Time now) {
  left_ = left(now) - count;
  last_ = now;
}

LivePage live_page(std::string_view page, std::string document, const std::string& model, int port,
                   const std::string& estimate) {
  constexpr std::string_view tag = "http-equiv=\"Content-Security-Policy\"", content = "content=\"";
  const std::size_t at = page.find(tag), begin = page.find(content, at);
  const std::size_t end = begin == std::string_view::npos ? begin : page.find('"', begin + content.size());
  if (at == std::string_view::npos || end == std::string_view::npos || page.find('>', at) < end)
    throw InvalidInput("the page has no policy that says what it may do");
  const std::string number = std::to_string(port);
  LivePage live;
  live.policy = std::string(page.substr(begin + content.size(), end - begin - content.size())) +
                "; connect-src 'self' ws://127.0.0.1:" + number + " ws://localhost:" + number;
  const std::string reported =
      std::string(page.substr(0, begin)) + std::string(content) + live.policy + std::string(page.substr(end));
  live.policy += "; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*";  // notebooks show it
  document.pop_back();
  document += std::string(",\"live\":{\"path\":\"") + live_path + "\",\"model\":\"" + model + "\"" +
              (estimate.empty() ? "" : ",\"estimate\":" + estimate) + "}}";
  live.html = runs::page_html(reported, document);
  return live;
}

std::string fingerprint_of_texts(const std::initializer_list<std::string_view>& texts) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](unsigned char byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const std::string_view text : texts) {
    for (const char c : text) add(static_cast<unsigned char>(c));
    add(0xff);  // of no UTF-8: texts do not run into each other
  }
  std::string digits(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) digits[i] = "0123456789abcdef"[hash & 15];
  return digits;
}

}  // namespace softkin::view
