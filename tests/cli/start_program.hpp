#pragma once

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "run_program.hpp"
#include "support/patience.hpp"

namespace softkin::testing {

/// A running softkin process that can receive signals; it is ended in the destructor. Output goes to files of the
/// folder.
class StartedProgram {
 public:
  /// Starts the program.
  ///
  /// terminal  standard error is a (pseudo) terminal
  /// columns   > 0: standard output is a terminal of this width, too; its text is then among the errors
  StartedProgram(const TemporaryFolder& folder, const std::vector<std::string>& arguments, bool terminal = false,
                 int columns = 0)
      : output_(folder / "stdout.txt"), errors_(folder / "stderr.txt") {
    std::vector<std::string> words{SOFTKIN_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int output = open_to_write(output_);
    const int errors = terminal ? open_terminal() : open_to_write(errors_);
    if (columns > 0) {
      winsize size = {};
      size.ws_col = static_cast<unsigned short>(columns);
      ::ioctl(errors, TIOCSWINSZ, &size);
    }
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(columns > 0 ? errors : output, STDOUT_FILENO);
      ::dup2(errors, STDERR_FILENO);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(output);
    ::close(errors);
    if (process_ < 0) throw std::runtime_error("cannot start a process");
  }
  ~StartedProgram() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
    if (terminal_ >= 0) ::close(terminal_);
  }
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;

  void send(int signal_number) const { ::kill(process_, signal_number); }

  /// Waits until condition(); false where the program ended or a minute passed before, more where all is slow.
  template <class Condition>
  [[nodiscard]] bool wait_until(const Condition& condition) const {
    for (int i = 0; i < 1000 * patient(60); ++i) {
      if (condition()) return true;
      siginfo_t state = {};
      ::waitid(P_PID, static_cast<id_t>(process_), &state, WEXITED | WNOHANG | WNOWAIT);
      if (state.si_pid == process_) return condition();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  [[nodiscard]] ProgramResult wait() {
    ProgramResult result;
    if (terminal_ >= 0) result.errors = read_terminal();
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.output = read_text(output_);
    if (terminal_ < 0) result.errors = read_text(errors_);
    return result;
  }

 private:
  static int open_to_write(const std::string& path) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  }
  int open_terminal() {
    terminal_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (terminal_ < 0 || ::grantpt(terminal_) != 0 || ::unlockpt(terminal_) != 0)
      throw std::runtime_error("no pseudo terminal");
    return ::open(::ptsname(terminal_), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  [[nodiscard]] std::string read_terminal() const {  // until the program has closed it
    std::string text;
    char bytes[4096];
    for (ssize_t count = 0; (count = ::read(terminal_, bytes, sizeof bytes)) > 0;) text.append(bytes, count);
    return text;
  }

  std::string output_, errors_;
  pid_t process_ = -1;
  int terminal_ = -1;
};

}  // namespace softkin::testing
