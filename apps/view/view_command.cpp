#include <fcntl.h>
#include <spawn.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/answers.hpp>
#include <softkin/runs/page.hpp>
#include <thread>

#include "cli/command.hpp"
#include "cli/estimate_options.hpp"
#include "cli/run_text.hpp"
#include "cli/solve_options.hpp"
#include "cli/terminal.hpp"
#include "view/background_map.hpp"
#include "view/live_server.hpp"
#include "view/reading_stream.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin view`. An empty file name: not given.
struct ViewOptions : SolveOptions {
  std::string map;
  bool make_map = false;
  int port = 0;
  bool no_open = false;
  EstimateOptions estimate;
  std::optional<int> readings_port;

  [[nodiscard]] bool reports() const { return !estimate.unknowns.empty(); }
};

/// Options of estimation need an unknown, and estimation excludes a map that bends the robot in the page.
void check_telling(const ViewOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput(why); };
  if (options.reports()) {
    if (!options.map.empty() || options.make_map)
      refuse(std::string(options.make_map ? "--make-map" : "--map") +
             ": --unknown is estimated by the solver alone; leave out one of them");
    return;
  }
  for (std::size_t k = 0; k < readings; ++k)
    if (options.estimate.deviations[k]) refuse(deviation_names()[k] + ": it needs --unknown, the number to estimate");
  if (options.estimate.fade_s > 0) refuse("--fade: it needs --unknown, the number to estimate");
  if (options.estimate.keep_all) refuse("--keep-all: it needs --unknown, the number to estimate");
  if (options.readings_port) refuse("--readings-port: it needs --unknown, the number to estimate");
}

void add_view_options(CLI::App& command, ViewOptions& options) {
  add_scene(command, options);
  add_value(command, "--map", options.map, "F.skmap",
            "Kinematic map of the robot (softkin map): bends it in the page at\nonce, until the solver's shape comes");
  command.add_flag(
      "--make-map", options.make_map,
      "Make such a map meanwhile, by one thread that gives way to\nothers; the page takes it when it is made");
  add_value(command, "--port", options.port, "N", "Of 127.0.0.1 to listen at (default: 0, any that is free)",
            integer_from(0, 65535));
  command.add_flag("--no-open", options.no_open, "Start no browser");
  add_unknowns(command, options.estimate);
  add_deviations(command, options.estimate.deviations);
  add_fade(command, options.estimate, "readings\nstart from each other (default: each is estimated by itself)");
  add_value(
      command, "--readings-port", options.readings_port, "N",
      "Take readings at 127.0.0.1 too, as JSON lines with the columns of\n`softkin estimate` (0: at any port that "
      "is free, which is printed)",
      integer_from(0, 65535));
  add_force(command, options);
  add_solver(command, options);
}

/// Returns a random secret: 128 bits, hexadecimal.
std::string fresh_secret() {
  unsigned char bytes[16];
  if (::getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
    throw InvalidInput("this machine gives no random numbers, of which the page's secret is made");
  std::string text;
  for (const unsigned char byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

/// Starts the desktop's program for addresses, where there is one; reports where that fails. It runs in a process group
/// of its own: Ctrl-C does not reach the browser.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::string program = "xdg-open", word = address;
  char* const words[] = {program.data(), word.data(), nullptr};
  pid_t process = -1;
  const bool started = ::posix_spawnp(&process, program.c_str(), &files, &attributes, words, environ) == 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (!started) return;
  std::thread([process] {
    int status = 0;
    if (::waitpid(process, &status, 0) == process && !(WIFEXITED(status) && WEXITSTATUS(status) == 0))
      std::fprintf(stderr, "softkin: warning: no browser could be started: open the address above in one\n");
  }).detach();
}

/// The answers of two servers with the same fingerprint are the same.
std::string fingerprint_of(const Model& model, const ViewOptions& options) {
  const std::string solver = options.solver_name + " " + exact(options.tolerance_mm) + " " +
                             std::to_string(options.max_iterations) + " " + std::to_string(options.statics().anderson) +
                             (options.stable ? " stable" : "") + changes_text(options.tuning);
  std::string reported = exact(options.estimate.fade_s) + (options.estimate.keep_all ? " all" : "");
  for (const std::string& unknown : options.estimate.unknowns) reported += " " + unknown;
  for (const double deviation : options.estimate.requested_deviations()) reported += " " + exact(deviation);
  return view::fingerprint_of_texts({SOFTKIN_VERSION, softkin::fingerprint_of(model), solver,
                                     options.map.empty() ? "" : read_file(options.map), reported});
}

/// The shape at rest; Ctrl-C ends the search for it.
Equilibrium at_rest(const Statics& statics, const StaticsOptions& options) {
  ProgressLine line;
  EquilibriumProgress fraction;
  return statics.solve(statics.model().rest_actuation(), statics.rest(), options, [&](const Progress& p) {
    line.show(fraction.fraction(p), EquilibriumProgress::text(p));
    return !interrupted();
  });
}

/// The line on stderr while it serves. May be called on any thread.
class ServingLine {
 public:
  void there(const std::string& text) { show(there_, text); }
  void making(const std::string& text) { show(making_, text); }
  void say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    line_.clear();
    std::fputs(text.c_str(), stderr);
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    line_.clear();
  }

 private:
  void show(std::string& part, const std::string& text) {
    const std::lock_guard lock(mutex_);
    part = text;
    line_.show(-1, there_ + making_ + "; Ctrl-C ends");
  }

  std::mutex mutex_;
  ProgressLine line_;
  std::string there_ = "0 pages watch, none has control", making_;
};

class ViewRun {
 public:
  ViewRun(const Model& model, const ViewOptions& options)
      : model_(model), options_(options), statics_(model), document_(model, runs::kept_command()) {
    if (!options.map.empty()) map_.emplace(runs::read_map_of(model, options.map));
    if (options.reports())
      estimator_.emplace(model, view::estimate_setup(model, options.estimate.requested_unknowns(),
                                                     options.estimate.requested_deviations(), deviation_names(),
                                                     options.estimate.how(options.statics())));
  }

  /// stream: of readings; null: none
  int run(view::LiveServer& server, view::ReadingStream* stream) {
    Equilibrium rest = at_rest(statics_, options_.statics());
    const ElementDeformation deformation = statics_.measured(rest.state);
    const StepRecord record = runs::step_record(model_, rest, deformation);
    if (rest.report.status != Status::converged) {
      std::fprintf(stderr, "softkin: %s: %s\n", name_of(rest.report.status), shortfall_text(model_, record).c_str());
      return not_converged;
    }
    document_.add(record, rest.state.positions, deformation);
    return serve(server, stream, std::move(rest));
  }

 private:
  int serve(view::LiveServer& server, view::ReadingStream* stream, Equilibrium rest) {
    const std::string model = fingerprint_of(model_, options_);
    view::LiveContent content{view::live_page(runs::embedded_page(), document_.text(map_ ? &map_->data() : nullptr),
                                              model, server.port(), estimator_ ? estimator_->page_text() : ""),
                              model, fresh_secret(), estimator_ ? estimator_->columns().size() : 0};
    const std::string address = "http://127.0.0.1:" + std::to_string(server.port()) + "/#" + content.secret;
    view::LiveRobot robot(
        statics_, document_, options_.statics(), std::move(rest),
        [&server, stream](auto answer) {
          if (stream != nullptr) stream->answer(answer);
          server.show(std::move(answer));
        },
        estimator_ ? &*estimator_ : nullptr);
    std::string reported = "view: " + address + "\n";
    if (stream != nullptr) reported += begin(*stream, server, robot);
    print(reported + "Ctrl-C ends it; anyone who has the address can bend the robot\n");
    if (!options_.no_open) open_browser(address);
    ServingLine line;
    std::optional<view::BackgroundMap> maker;
    if (options_.make_map) make_map(server, line, maker);
    server.run(
        model_, std::move(content), [&robot](view::LiveRequest request) { robot.ask(std::move(request)); },
        [&line](const view::Presence& there) {
          line.there(counted(there.watchers, "page watches", "pages watch") +
                     (there.streamed     ? ", readings are streamed"
                      : there.controlled ? ", one has control"
                                         : ", none has control"));
        },
        true);
    line.clear();
    if (stream != nullptr) stream->stop();
    const bool made = !maker || maker->stop(0.3);
    if (robot.stop(0.3) && made) return done;
    // a large robot's factorisation cannot be stopped, and nobody waits for it
    std::fflush(nullptr);
    std::_Exit(done);
  }

  /// What is printed of it.
  std::string begin(view::ReadingStream& stream, view::LiveServer& server, view::LiveRobot& robot) {
    const std::string token = fresh_secret();
    stream.begin(
        {model_, estimator_->columns(), estimator_->reported_actuators(), estimator_->fades()}, token,
        [&robot](view::LiveRequest request) { robot.ask(std::move(request)); },
        [&server](bool lent) { server.lend(lent); });
    return "readings: JSON lines at 127.0.0.1:" + std::to_string(stream.port()) + ", the first {\"token\": \"" + token +
           "\"}\n";
  }

  void make_map(view::LiveServer& server, ServingLine& line, std::optional<view::BackgroundMap>& maker) {
    MapOptions map;
    map.checks = 50;  // the solver follows anyway
    map.statics = options_.statics();
    maker.emplace(
        model_, map,
        [&line](const MapProgress& at) {
          line.making("; map: " + counted(static_cast<std::size_t>(at.equilibria + at.checks), "shape") + " solved");
          return true;
        },
        [this, &server, &line](const MapData* made, const std::string& why) {
          line.making("");
          if (made != nullptr) return server.give_map(document_.map_text(*made));
          line.say("softkin: warning: no map was made, the solver alone answers: " + why + "\n");
        });
  }

  const Model& model_;
  const ViewOptions& options_;
  Statics statics_;
  std::optional<KinematicMap> map_;
  std::optional<view::LiveEstimator> estimator_;
  runs::PageDocument document_;
};

int run_view(const ViewOptions& options) {
  check_solver(options);
  if (options.make_map && !options.map.empty()) throw InvalidInput("--make-map: --map gives one");
  if (!runs::page_is_there()) throw InvalidInput(std::string("view: ") + runs::no_page);
  check_telling(options);
  view::LiveServer server(options.port);
  std::optional<view::ReadingStream> stream;
  if (options.readings_port) stream.emplace(*options.readings_port);
  std::vector<fs::path> inputs{options.scene};
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  line.show(-1, "assembling");
  ViewRun run(model, options);
  line.clear();
  catch_interrupt();
  print(options.scene + ": " + runs::model_summary(model, options.solver_name) + "\n");
  return run.run(server, stream ? &*stream : nullptr);
}

}  // namespace

void add_view_command(CLI::App& app, Run& run) {
  add_command(
      app, run, "view", "The robot live in a browser: bent while it is dragged, by the solver",
      "Serves a page at 127.0.0.1 until Ctrl-C. Who opens the printed address has control; who opens it "
      "without what\n"
      "follows the # only watches. With --unknown the page shows the forces on the robot, estimated from readings.\n"
      "Exit code: 0 ended by Ctrl-C, 1 no equilibrium at rest, 2 bad usage or bad input.\n"
      "Examples:\n"
      "  softkin view examples/pneumatic_finger/pneumatic_finger.yaml\n"
      "  softkin view examples/estimate/finger.yaml --unknown touch:place --deviation 0.2     # forces on it",
      add_view_options, run_view);
}

}  // namespace softkin::cli
