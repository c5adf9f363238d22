#pragma once

#include <functional>
#include <memory>
#include <softkin/model/model.hpp>
#include <string>

#include "live_gate.hpp"
#include "live_robot.hpp"

namespace softkin::view {

/// How much a server bears with. Seconds where a name ends in _s.
struct LiveLimits {
  std::size_t connections = 256;  // more are refused
  double messages_per_second = 240, messages_at_once = 60;
  int refusals = 20;      // of one connection, then it is closed
  double head_s = 10;     // in which a request must have come, and the first message
  double idle_s = 40;     // of silence; after half of it the other side is asked whether it is there
  double stalled_s = 30;  // in which no byte of what is written is taken
};

/// Who is there.
struct Presence {
  std::size_t watchers = 0;
  bool controlled = false;  // by a page
  bool streamed = false;    // by readings that come by another port
  bool operator==(const Presence&) const = default;
};

/// What a server serves.
struct LiveContent {
  LivePage page;
  std::string model;         // hexadecimal: what the page shows
  std::string secret;        // with which a page gets control; not empty
  std::size_t readings = 0;  // columns of which a page may say what was read; 0: nothing is told here
};

/// Serves a page and its WebSocket at 127.0.0.1, on the thread that run() is called on. Whoever is slow to read gets
/// fewer shapes, the newest ones; nobody waits for anybody.
class LiveServer {
 public:
  using Ask = std::function<void(LiveRequest)>;
  using Notice = std::function<void(const Presence&)>;

  /// Listens.
  ///
  /// port    0: any that is free
  /// throws  InvalidInput where it cannot
  explicit LiveServer(int port, const LiveLimits& limits = {});
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  [[nodiscard]] int port() const;

  /// Until stop(); signals: or until SIGINT or SIGTERM.
  ///
  /// model   of the robot, must live as long
  /// ask     takes what who has control asks for
  /// notice  is told who is there, at most four times a second
  void run(const Model& model, LiveContent content, Ask ask, const Notice& notice = {}, bool signals = false);

  // May be called on any thread.

  /// To all who watch.
  void show(std::shared_ptr<const LiveAnswer> answer);
  /// To all who watch, and to who comes. map: as runs::PageDocument tells it
  void give_map(const std::string& map);
  /// While it is lent to a stream of readings no page has control; who had it gets it back.
  void lend(bool lent);
  /// Tells all that it goes, and ends within half a second.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin::view
