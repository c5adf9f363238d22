#pragma once

#include <functional>
#include <softkin/drive/plan.hpp>
#include <softkin/drive/serial_port.hpp>

namespace softkin::drive {

/// How a program is streamed. Defaults suit boards on USB.
struct LinkOptions {
  double timeout_s = 2;       // a line without an answer for so long, beside its own patience, is sent again; > 0
  double quiet_s = 0.05;      // silence after which no further answer is expected; > 0
  double boot_s = 3;          // wait for boards that boot when the port is opened; >= 0
  int attempts = 10;          // failures of one line in a row after which the stream ends; > 0
  int checkpoint_lines = 64;  // lines after which a silence is waited for; > 0
};

/// The current order of the user. pause: no more lines are sent, the board completes the moves that it has. stop: the
/// same, and the stream ends. quick_stop: M410, in the middle of a move.
enum class Order { go, pause, stop, quick_stop };

/// Why a stream ended.
enum class StreamEnd {
  finished,        // everything was executed, and the board stands where it should
  stopped,         // by order, and the board stands where the last line that was sent leads
  quick_stopped,   // by order
  rebooted,        // the board was reset
  halted,          // the board reported a fault
  no_answer,       // too many failures in a row
  wrong_position,  // the board reports another position than it was sent to
  port_lost
};

/// "finished", "quick stopped", ...
[[nodiscard]] const char* name_of(StreamEnd end);

/// How a stream ended. Lines are those of the program, counted from 1. Lines up to `acknowledged` were accepted by the
/// board; those after it up to `sent` perhaps. Accepted moves have been executed where the position is known; else the
/// last of them, which the board had planned ahead, perhaps not.
struct StreamReport {
  StreamEnd end = StreamEnd::no_answer;               // why it ended
  std::string message;                                // the same for people, in a sentence
  std::size_t lines = 0, acknowledged = 0, sent = 0;  // of the program; accepted; sent
  bool position_known = false;                        // has the board reported its position
  std::vector<double> position;                       // per axis, where it is known
  std::size_t resends = 0;                            // lines that the board requested again
  std::size_t timeouts = 0;                           // lines sent again because no answer came
};

/// Callbacks while a program is streamed; each may be empty.
struct LinkHooks {
  std::function<Order()> order;                       // called at least every 50 ms
  std::function<void(char, const std::string&)> log;  // '>' sent, '<' received, '!' event
  std::function<void(std::size_t)> progress;          // lines acknowledged
};

/// Streams a program to a Marlin board, one line in flight.
///
/// Every line has a number and a checksum. Marlin executes a line only if its number follows that of the last line that
/// it accepted; any other it refuses with "Resend: N", N being the number that it expects. A line's text never changes
/// once it has its number. Whatever is lost, damaged, late or doubled, the board therefore executes a prefix of the
/// program, each line once and in order: to send a line again whose "ok" was lost is safe, since the board refuses it
/// if it had accepted it, which is then the answer. The rest follows from that:
/// - "ok" carries no number, so one too many makes the stream run ahead by a line; the board's next Resend leads back.
///   After every disturbance, and every checkpoint_lines, a silence is waited for, so that it does not stay ahead.
/// - Resend may or may not be followed by "ok": what arrives until it is silent belongs to it.
/// - A board that has booted expects line 1. No line has that number (they begin at 10001), so that it would refuse
///   all; M110, which sets the number, is sent at the start alone, before anything moves. "start", or requests for a
///   number that is not of this stream, end it.
/// - Before the first move and after the last the board has to report its position (M114). Only that ends a stream as
///   finished: an "ok" may have been another line's.
/// - Positions are absolute: a move that a board were to make twice would lead nowhere the second time.
/// Marlin's checksum is the exclusive or of all bytes: it notices every single damaged byte, but not one in 256 of
/// worse damage; M114 at the end notices what that did to the position.
///
/// returns  how it ended, for every fault of board, line and port alike; never throws for these
[[nodiscard]] StreamReport stream(SerialPort& port, const GcodeProgram& program, const LinkOptions& options = {},
                                  const LinkHooks& hooks = {});

/// "N10001 G21*31" without the end of the line.
[[nodiscard]] std::string numbered_line(long number, const std::string& text);

}  // namespace softkin::drive
