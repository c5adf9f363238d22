#pragma once

#include <softkin/runs/page.hpp>
#include <thread>

#include "live_client.hpp"
#include "runs/small_runs.hpp"
#include "view/live_server.hpp"

namespace softkin::view::testing {

constexpr const char* secret = "0123456789abcdef0123456789abcdef";

/// A page as it is built, with the policy that it then has.
inline std::string small_page() {
  return "<!doctype html><html><head>\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "script-src 'sha256-abc='; base-uri 'none'\">\n</head><body>"
         "<script type=\"application/json\" id=\"softkin-page\">null</script></body></html>\n";
}

/// A server without a robot, which records its requests.
class Served {
 public:
  explicit Served(const Model& model, const LiveLimits& limits = {}) : server(0, limits), model_(model) {
    run([this](const LiveRequest& request) {
      const std::lock_guard<std::mutex> lock(mutex_);
      requested_.push_back(request);
    });
  }
  /// ask: receives the requests; readings: number of columns that pages may send readings of
  Served(const Model& model, LiveServer::Ask ask, std::size_t readings = 0) : server(0), model_(model) {
    run(std::move(ask), readings);
  }
  ~Served() { end(); }

  void end() {
    if (!thread_.joinable()) return;
    server.stop();
    thread_.join();
  }

  [[nodiscard]] std::vector<LiveRequest> requested() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return requested_;
  }
  [[nodiscard]] int port() const { return server.port(); }
  /// Returns a client that has sent its hello.
  [[nodiscard]] LiveClient client(const std::string& with = secret, int receive_buffer = 0) const {
    LiveClient client(port(), receive_buffer);
    client.hello(with);
    return client;
  }

  LiveServer server;

 private:
  void run(LiveServer::Ask ask, std::size_t readings = 0) {
    LiveContent content{live_page(small_page(), R"({"robot":"block"})", "00ff", server.port()), "00ff", secret,
                        readings};
    thread_ = std::thread([this, content, ask] { server.run(model_, content, ask); });
  }

  const Model& model_;
  mutable std::mutex mutex_;
  std::vector<LiveRequest> requested_;
  std::thread thread_;
};

/// A robot, and who serves it.
struct ServedRobot {
  explicit ServedRobot(const Model& of, const StaticsOptions& options = runs::testing::one_thread())
      : model(of),
        statics(model),
        document(model, "softkin view"),
        served(model, [this](const LiveRequest& request) { robot->ask(request); }),
        robot(std::make_unique<LiveRobot>(statics, document, options,
                                          statics.solve(model.rest_actuation(), statics.rest(), options),
                                          [this](auto answer) { served.server.show(std::move(answer)); })) {}
  ~ServedRobot() {
    served.end();
    robot.reset();
  }

  const Model& model;
  Statics statics;
  runs::PageDocument document;
  Served served;
  std::unique_ptr<LiveRobot> robot;
};

/// Returns a synthetic shape with a number of vertices.
inline std::shared_ptr<const LiveAnswer> made_up_shape(RequestId id, std::size_t vertices, std::uint64_t asker = 1) {
  LiveShape shape;
  shape.id = id;
  shape.status = "converged";
  shape.commands = Eigen::VectorXd::Constant(2, static_cast<double>(id));
  shape.vertices = vertices;
  shape.numbers.assign(3 * vertices, static_cast<float>(id));
  return std::make_shared<const LiveAnswer>(LiveAnswer{asker, std::move(shape)});
}

}  // namespace softkin::view::testing
