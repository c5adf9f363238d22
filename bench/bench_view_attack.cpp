// softkin view under attack: 200 pages, of which a quarter watches, a quarter never reads, a quarter sends nothing or
// its request byte by byte, and a quarter sends invalid messages. Measures how long the controlling page waits for
// shapes, compared with a server without other pages, and the memory of the server.

#include <signal.h>
#include <sys/wait.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/runs/page_document.hpp>
#include <thread>

#include "command_line.hpp"
#include "finger.hpp"
#include "machine.hpp"
#include "view/live_client.hpp"
#include "view/live_server.hpp"

namespace {

using namespace softkin;
using namespace softkin::view;
using bench::now;
using view::testing::LiveClient;
using view::testing::PlainSocket;

struct Options {
  double seconds = 5, size = 6500;
  int clients = 200, threads = 1;
};

constexpr const char* secret = "0123456789abcdef0123456789abcdef";
constexpr const char* page =
    "<html><meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\">"
    "<script type=\"application/json\" id=\"softkin-page\">null</script></html>";

/// Serves the finger until the process is ended, and writes the port into the pipe.
int serve(const Options& options, int pipe) {
  const Model model = compile(
      bench::finger_robot(bench::bellows_finger(bench::cell_for(options.size)), bench::FingerKind::physical, ""));
  const Statics statics(model);
  runs::PageDocument document(model, "");
  StaticsOptions solver;
  solver.threads = options.threads;
  LiveServer server(0);
  LiveRobot robot(statics, document, solver, statics.solve(model.rest_actuation(), statics.rest(), solver),
                  [&](auto answer) { server.show(std::move(answer)); });
  const int port = server.port();
  if (::write(pipe, &port, sizeof port) != sizeof port) return 1;
  LiveContent content{live_page(page, document.text(nullptr), "00ff", port), "00ff", secret};
  server.run(
      model, std::move(content), [&](LiveRequest request) { robot.ask(std::move(request)); }, {}, true);
  return robot.stop(5) ? 0 : 1;
}

/// Resident memory of a process [MiB].
double resident_mib(pid_t process) {
  std::ifstream statm("/proc/" + std::to_string(process) + "/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024 * 1024);
}

void rest_for(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// What attackers did.
struct Tally {
  std::atomic<std::int64_t> frames{0}, connections{0}, turned_away{0}, attacks{0};
};

class Attack {
 public:
  Attack(int port, int clients) : port_(port) {
    const int quarter = std::max(1, clients / 4);
    threads_.emplace_back([this, quarter] { watch(quarter); });
    threads_.emplace_back([this, quarter] { never_read(quarter); });
    threads_.emplace_back([this, quarter] { dribble(quarter); });
    constexpr int hostile_threads = 5;
    for (int i = 0; i < hostile_threads; ++i)
      threads_.emplace_back(
          [this, i, count = std::max(1, quarter / hostile_threads)] { attack(count, static_cast<unsigned>(i)); });
  }
  ~Attack() {
    ended_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Attack(const Attack&) = delete;
  Attack& operator=(const Attack&) = delete;

  Tally tally;

 private:
  /// A connection, if there is one to be had.
  template <class Client>
  std::unique_ptr<Client> connected(int receive_buffer) {
    try {
      auto client = std::make_unique<Client>(port_, receive_buffer);
      ++tally.connections;
      return client;
    } catch (const std::exception&) {
      ++tally.turned_away;
      return nullptr;
    }
  }

  void watch(int count) {
    std::vector<std::unique_ptr<LiveClient>> clients(count);
    while (!ended_) {
      for (auto& client : clients) {
        if (!client && (client = connected<LiveClient>(0))) client->hello("");
        if (!client) continue;
        const auto message = client->receive(0);
        if (message && message->opcode == view::testing::binary) ++tally.frames;
        if (client->socket().is_closed()) client.reset();
      }
      rest_for(0.005);
    }
  }

  void never_read(int count) {
    while (!ended_) {
      std::vector<std::unique_ptr<LiveClient>> clients;
      for (int i = 0; i < count; ++i)
        if ((clients.emplace_back(connected<LiveClient>(4096)))) clients.back()->hello(i % 2 == 0 ? "" : "guess");
      for (int i = 0; i < 450 && !ended_; ++i) rest_for(0.1);  // longer than the server's time limit
    }
  }

  void dribble(int count) {
    while (!ended_) {
      std::vector<std::unique_ptr<PlainSocket>> sockets;
      for (int i = 0; i < count; ++i) sockets.push_back(connected<PlainSocket>(4096));
      for (int i = 0; i < 120 && !ended_; ++i) {
        for (std::size_t k = 0; k < sockets.size(); k += 2)
          if (sockets[k]) sockets[k]->send("G");
        rest_for(0.1);
      }
    }
  }

  /// Without a pause to speak of, one after another.
  void attack(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::unique_ptr<LiveClient>> clients(count);
    while (!ended_) {
      for (auto& client : clients) {
        if (!client) client = connected<LiveClient>(0);
        if (!client) continue;
        ++tally.attacks;
        if (!harm(*client, random)) client.reset();
      }
      request_wrongly(random);
      rest_for(0.01);
    }
  }

  /// false: the connection is of no more use
  static bool harm(LiveClient& client, std::mt19937& random) {
    std::string junk(random() % 6000, '\0');
    for (char& c : junk) c = static_cast<char>(random());
    switch (random() % 8) {
      case 0:
        return client.send(junk, static_cast<int>(random() % 16), random() % 2 == 0);
      case 1:
        return client.socket().send(junk) && false;
      case 2:
        client.hello(std::string(32, static_cast<char>('0' + random() % 10)));
        return client.say({{"type", "take"}});
      case 3:
        return client.send(std::string(4096, '['));
      case 4:
        for (int i = 0; i < 300; ++i)
          if (!client.send(R"({"type":"command","id":1,"commands":[1e999]})")) return false;
        return true;
      case 5:
        for (int i = 0; i < 300; ++i)
          if (!client.send("", view::testing::ping)) return false;
        return true;
      case 6:
        return client.send("half a mess", view::testing::text, false);
      default:
        return false;
    }
  }

  void request_wrongly(std::mt19937& random) {
    const auto socket = connected<PlainSocket>(0);
    if (!socket) return;
    const std::string host = random() % 2 == 0 ? "evil.com" : view::testing::host_of(port_);
    socket->send((random() % 2 == 0 ? "GET / HTTP/1.1\r\nHost: " : "POST /live HTTP/1.1\r\nHost: ") + host +
                 "\r\n\r\n");
    if (random() % 2 == 0) (void)socket->take(100, 0.01);
  }

  int port_;
  std::atomic<bool> ended_{false};
  std::vector<std::thread> threads_;
};

/// How long shapes were waited for.
struct Waits {
  std::vector<double> seconds;
  double largest_mib = 0;
  bool kept = true;  // control, all the time

  [[nodiscard]] double quantile(double fraction) const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? NAN : sorted[fraction * static_cast<double>(sorted.size() - 1)];
  }
};

/// Commands to and fro, twenty a second at most, each once the last was answered.
Waits control(LiveClient& client, std::uint64_t& id, double seconds, pid_t server) {
  Waits waits;
  for (const double end = now() + seconds; now() < end && waits.kept;) {
    const double begin = now();
    ++id;
    client.command(id, {1.2 + 0.1 * std::sin(0.05 * static_cast<double>(id))});
    waits.kept = client.shape(static_cast<std::int64_t>(id), 20).has_value();
    waits.seconds.push_back(now() - begin);
    waits.largest_mib = std::max(waits.largest_mib, resident_mib(server));
    rest_for(std::max(0.0, 0.05 - (now() - begin)));
  }
  return waits;
}

void print_waits(const char* what, const Waits& waits) {
  std::printf("%-12s %6zu shapes, waited %6.1f ms median, %6.1f ms 99 %%, %6.1f ms longest; server %.1f MiB at most\n",
              what, waits.seconds.size(), 1e3 * waits.quantile(0.5), 1e3 * waits.quantile(0.99),
              1e3 * waits.quantile(1), waits.largest_mib);
  std::fflush(stdout);
}

int measure(const Options& options, int port, pid_t server) {
  LiveClient client(port);
  client.hello(secret);
  std::uint64_t id = 0;
  (void)control(client, id, std::min(2.0, options.seconds), server);  // warms up
  const Waits alone = control(client, id, options.seconds / 4, server);
  print_waits("alone", alone);
  Waits attacked, halfway;
  {
    Attack attack(port, options.clients);
    halfway = control(client, id, options.seconds / 2, server);
    print_waits("attacked", halfway);
    attacked = control(client, id, options.seconds / 2, server);
    print_waits("  later", attacked);
    const Tally& tally = attack.tally;
    std::printf("attackers: %lld connections, %lld turned away, %lld attacks, %lld shapes watched\n",
                static_cast<long long>(tally.connections), static_cast<long long>(tally.turned_away),
                static_cast<long long>(tally.attacks), static_cast<long long>(tally.frames));
  }
  const bool kept = alone.kept && halfway.kept && attacked.kept;
  std::printf("control was %s; after it %.1f MiB\n", kept ? "kept" : "LOST", resident_mib(server));
  return kept ? 0 : 1;
}

int run(const Options& options) {
  bench::print_machine();
  int pipe[2];
  if (::pipe(pipe) != 0) throw InvalidInput("no pipe");
  const pid_t server = ::fork();
  if (server == 0) std::_Exit(serve(options, pipe[1]));
  ::close(pipe[1]);
  int port = 0, status = 0, code = 1;
  if (::read(pipe[0], &port, sizeof port) == sizeof port) code = measure(options, port, server);
  ::kill(server, SIGTERM);
  ::waitpid(server, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) code = 1;
  std::printf("server ended %s\n", code == 0 ? "well" : "or served BADLY");
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace softkin::bench;
  CommandLine app("softkin view under attack", "bench_view_attack");
  Options options;
  app.add_option("--seconds", options.seconds, "of attack").check(within(0.1, 1e6));
  app.add_option("--clients", options.clients).check(within(4, 240));
  app.add_option("--size", options.size, "tetrahedra of the finger").check(positive());
  app.add_option("--threads", options.threads, "of the solver").check(within(0, 512));
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
