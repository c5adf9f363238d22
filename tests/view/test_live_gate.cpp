#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

#include "served_robot.hpp"

namespace softkin::view {
namespace {

TEST(LiveGate, OnlyPagesOfThisAddressComeIn) {
  const int port = 8123;
  const RequestHead page{"GET", "/", "127.0.0.1:8123", "", 1, 0, false};
  EXPECT_EQ(entry_of(page, port), Entry::page);
  RequestHead head = page;
  for (const char* host : {"", "127.0.0.1", "127.0.0.1:8124", "localhost:81230", "evil.com:8123", "127.0.0.1.:8123",
                           "127.0.0.1:8123 ", "LOCALHOST:8123", "[::1]:8123", "127.0.0.1:08123"}) {
    head.host = host;
    EXPECT_EQ(entry_of(head, port), Entry::forbidden) << host;
  }
  head = page;
  head.hosts = 2;
  EXPECT_EQ(entry_of(head, port), Entry::forbidden);
  head = page;
  head.host = "localhost";
  EXPECT_EQ(entry_of(head, 80), Entry::page);
  for (const char* target : {"/live", "/x", "//", "/?", "http://127.0.0.1:8123/", "*", "/live/"}) {
    head = page;
    head.target = target;
    EXPECT_EQ(entry_of(head, port), target == std::string("/live") ? Entry::forbidden : Entry::not_found) << target;
  }
  for (const char* method : {"POST", "HEAD", "OPTIONS", "get", ""}) {
    head = page;
    head.method = method;
    EXPECT_EQ(entry_of(head, port), Entry::not_allowed) << method;
  }
}

TEST(LiveGate, SocketsNeedTheOriginOfTheirHost) {
  const RequestHead live{"GET", "/live", "localhost:8123", "http://localhost:8123", 1, 1, true};
  EXPECT_EQ(entry_of(live, 8123), Entry::live);
  RequestHead head = live;
  for (const char* origin : {"", "null", "http://127.0.0.1:8123", "https://localhost:8123", "http://localhost:8124",
                             "http://localhost:8123/", "http://localhost:8123.evil.com", "file://"}) {
    head.origin = origin;
    EXPECT_EQ(entry_of(head, 8123), Entry::forbidden) << origin;
  }
  head = live;
  head.origins = 2;
  EXPECT_EQ(entry_of(head, 8123), Entry::forbidden);
  head = live;
  head.upgrade = false;
  EXPECT_EQ(entry_of(head, 8123), Entry::not_found);
}

TEST(LiveGate, AllowanceIsSoManyASecond) {
  Allowance allowance(240, 60);
  auto now = Allowance::Time{} + std::chrono::hours(1);
  int taken = 0;
  const auto take_all = [&] {
    for (; allowance.left(now) >= 1; ++taken) allowance.take(1, now);
  };
  take_all();
  EXPECT_EQ(taken, 60);
  for (int i = 0; i < 100; ++i) {  // 2 s in steps
    now += std::chrono::milliseconds(20);
    take_all();
  }
  EXPECT_NEAR(taken, 60 + 480, 1);
  now += std::chrono::hours(1);
  take_all();
  EXPECT_NEAR(taken, 60 + 480 + 60, 1);
}

TEST(LiveGate, PageGetsDocumentAndConnections) {
  const LivePage live = live_page(testing::small_page(), R"({"robot":"a</script>b"})", "00ff", 8123);
  const std::string own =
      "default-src 'none'; script-src 'sha256-abc='; base-uri 'none'; connect-src 'self' "
      "ws://127.0.0.1:8123 ws://localhost:8123";
  EXPECT_EQ(live.policy, own + "; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*");
  EXPECT_NE(live.html.find("content=\"" + own + "\">"), std::string::npos) << live.html;
  const std::string element = "id=\"softkin-page\">";
  const std::size_t begin = live.html.find(element) + element.size();
  const auto document = nlohmann::json::parse(live.html.substr(begin, live.html.find("</script>", begin) - begin));
  EXPECT_EQ(document, nlohmann::json::parse(R"({"robot":"a</script>b","live":{"path":"/live","model":"00ff"}})"));
  EXPECT_THROW((void)live_page("<html></html>", "{\"a\":1}", "0", 1), InvalidInput);
  EXPECT_THROW((void)live_page("<meta http-equiv=\"Content-Security-Policy\"><p content=\"x\">", "{\"a\":1}", "0", 1),
               InvalidInput);
}

TEST(LiveGate, BuiltPageHasAPolicy) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  const LivePage live = live_page(runs::embedded_page(), R"({"robot":"a"})", "00ff", 8123);
  EXPECT_EQ(live.policy.find("default-src 'none'; script-src 'sha256-"), 0u) << live.policy;
}

TEST(LiveGate, FingerprintsTellTextsApart) {
  EXPECT_EQ(fingerprint_of_texts({"a", "b"}), fingerprint_of_texts({"a", "b"}));
  EXPECT_EQ(fingerprint_of_texts({}), "cbf29ce484222325");  // the basis of FNV-1a
  for (const auto& other :
       {fingerprint_of_texts({"ab"}), fingerprint_of_texts({"ab", ""}), fingerprint_of_texts({"b", "a"})})
    EXPECT_NE(other, fingerprint_of_texts({"a", "b"}));
}

}  // namespace
}  // namespace softkin::view
