#include "child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <softkin/core/error.hpp>
#include <sstream>
#include <thread>

#include "machine.hpp"

namespace softkin::bench {

namespace {

pid_t start(int (*child)(const void*), const void* argument) {
  std::fflush(nullptr);
  const pid_t id = ::fork();
  if (id < 0) throw InvalidInput("no process could be started");
  if (id == 0) ::_exit(child(argument));
  return id;
}

/// Waits for a process that has until `deadline`, and ends it then.
ProcessEnd finish(pid_t id, double begin, double deadline) {
  ProcessEnd end;
  int status = 0;
  rusage usage{};
  for (;;) {
    const pid_t ended = ::wait4(id, &status, WNOHANG, &usage);
    if (ended == id) break;
    if (ended < 0 && errno != EINTR) throw InvalidInput("a process was lost");
    if (!end.timed_out && now() > deadline) {
      end.timed_out = true;
      ::kill(id, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  end.seconds = now() - begin;
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  end.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024;
  return end;
}

void write_all(int file, const std::vector<char>& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) ::_exit(3);
    done += count;
  }
}

/// Until the other end closes the pipe, or the deadline.
void read_all(int file, double deadline, std::vector<char>& bytes) {
  std::array<char, 4096> piece;
  for (;;) {
    pollfd ready{file, POLLIN, 0};
    const double left = deadline - now();
    if (left <= 0) return;
    if (::poll(&ready, 1, left > 1 ? 1000 : 1 + static_cast<int>(1000 * left)) <= 0) continue;
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    bytes.insert(bytes.end(), piece.data(), piece.data() + count);
  }
}

struct Work {
  const std::function<std::vector<char>()>* work;
  int read_end, write_end;
};

int do_work(const void* argument) {
  const Work& work = *static_cast<const Work*>(argument);
  ::close(work.read_end);
  try {
    write_all(work.write_end, (*work.work)());
    return 0;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "bench: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench: %s\n", error.what());
  }
  return 1;
}

struct Program {
  const std::vector<std::string>* command;
  const std::vector<std::string>* environment;
  std::string folder, output;
};

int do_program(const void* argument) {
  const Program& program = *static_cast<const Program*>(argument);
  for (const std::string& pair : *program.environment) {
    const std::size_t at = pair.find('=');
    ::setenv(pair.substr(0, at).c_str(), pair.substr(at + 1).c_str(), 1);
  }
  if (::chdir(program.folder.c_str()) != 0) return 126;
  if (!program.output.empty()) {
    const int file = ::open(program.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file < 0) return 126;
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
  }
  std::vector<char*> words;
  for (const std::string& word : *program.command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  ::execvp(words[0], words.data());
  return 127;
}

}  // namespace

std::string ProcessEnd::complaint() const {
  if (timed_out) return "ended after " + std::to_string(static_cast<int>(seconds)) + " s";
  if (exit_code > 128) return "ended by signal " + std::to_string(exit_code - 128);
  return exit_code == 0 ? "" : "failed with exit code " + std::to_string(exit_code);
}

ProcessEnd run_in_child(const std::function<std::vector<char>()>& work, double limit, std::vector<char>& bytes) {
  int ends[2];
  if (::pipe(ends) != 0) throw InvalidInput("no pipe could be opened");
  const double begin = now();
  const Work argument{&work, ends[0], ends[1]};
  const pid_t id = start(do_work, &argument);
  ::close(ends[1]);
  bytes.clear();
  read_all(ends[0], begin + limit, bytes);
  ::close(ends[0]);
  return finish(id, begin, begin + limit);
}

ProcessEnd run_program(const std::vector<std::string>& command, const std::string& folder,
                       const std::string& output_file, const std::vector<std::string>& environment, double limit) {
  const Program argument{&command, &environment, folder, output_file};
  const double begin = now();
  return finish(start(do_program, &argument), begin, begin + limit);
}

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace softkin::bench
