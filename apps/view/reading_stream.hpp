#pragma once

#include <functional>
#include <memory>
#include <string>

#include "live_robot.hpp"
#include "reading_lines.hpp"

namespace softkin::view {

/// The limits of a stream. Seconds where a name ends in _s.
struct StreamLimits {
  std::size_t connections = 16;  // more are closed
  double lines_per_second = 1000, lines_at_once = 1000;
  int refusals = 20;      // of one connection, then it is closed
  double head_s = 10;     // in which the token must have come
  double stalled_s = 30;  // in which no byte of what is written is taken
};

/// Takes readings at 127.0.0.1, a JSON line each, from one writer at a time, on a thread of its own. Requests an
/// estimate from the newest line; answers go back as lines. A slow reader gets fewer of them, the newest ones.
class ReadingStream {
 public:
  using Ask = std::function<void(LiveRequest)>;
  /// Called with true when a writer has shown the token, with false when it has disconnected.
  using Lend = std::function<void(bool)>;

  /// Listens.
  ///
  /// port    0: any that is free
  /// throws  InvalidInput where it cannot
  explicit ReadingStream(int port, const StreamLimits& limits = {});
  /// Ends it.
  ~ReadingStream();
  ReadingStream(const ReadingStream&) = delete;
  ReadingStream& operator=(const ReadingStream&) = delete;

  [[nodiscard]] int port() const;

  /// Begins to let writers in.
  ///
  /// columns  of its lines
  /// token    that a writer must show; not empty
  /// ask      receives the requests, with an asker that no page has, a new one for each writer
  void begin(LineColumns columns, std::string token, Ask ask, Lend lend);

  // May be called on any thread.

  /// Sends an estimate to the writer. Answers to others are ignored.
  void answer(std::shared_ptr<const LiveAnswer> answer);
  /// Closes all connections, and ends.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin::view
