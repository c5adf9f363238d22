#pragma once

#include <functional>
#include <memory>
#include <softkin/model/model.hpp>
#include <string>

#include "live_gate.hpp"
#include "live_robot.hpp"

namespace softkin::view {

/// The limits of a server. Seconds where a name ends in _s.
struct LiveLimits {
  std::size_t connections = 256;  // more are refused
  double messages_per_second = 240, messages_at_once = 60;
  int refusals = 20;      // of one connection, then it is closed
  double head_s = 10;     // in which a request must have come, and the first message
  double idle_s = 40;     // of silence; after half of it the server checks that the client is there
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
  std::size_t readings = 0;  // columns of which a page may send readings; 0: nothing is estimated
};

/// Serves a page and its WebSocket at 127.0.0.1, on the thread that run() is called on. A slow reader gets fewer
/// shapes, the newest ones; no connection waits for another.
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

  /// Runs until stop(); signals: or until SIGINT or SIGTERM.
  ///
  /// model   of the robot, must outlive the call
  /// ask     receives the requests of the client that has control
  /// notice  is called with the clients that are present, at most four times a second
  void run(const Model& model, LiveContent content, Ask ask, const Notice& notice = {}, bool signals = false);

  // May be called on any thread.

  /// Sends a shape to all who watch.
  void show(std::shared_ptr<const LiveAnswer> answer);
  /// Sends a map to all who watch, and to clients that connect later. map: as runs::PageDocument writes it
  void give_map(const std::string& map);
  /// Lends control to a stream of readings: meanwhile no page has it, and the page that had it gets it back.
  void lend(bool lent);
  /// Notifies all clients, and ends within half a second.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin::view
