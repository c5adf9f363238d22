#include <algorithm>
#include <cstdlib>
#include <softkin/core/error.hpp>
#include <softkin/runs/ranks.hpp>
#include <utility>

#ifdef SOFTKIN_MPI
#include <mpi.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>
#include <vector>
#endif

namespace softkin::runs {

namespace {

/// Copies that a launcher says it has started; 0: there is no launcher.
int launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* size = std::getenv(name)) return std::atoi(size);
  return 0;
}

}  // namespace

FileDesk::FileDesk(const WorkspacePlan& plan, WorkspaceFile& file, std::function<bool()> go_on,
                   std::function<void()> kept)
    : plan_(plan), file_(file), go_on_(std::move(go_on)), kept_(std::move(kept)) {}

std::optional<GroupTask> FileDesk::take() {
  const std::lock_guard lock(mutex_);
  while (next_ < plan_.groups.size() && go_on_()) {
    GroupTask task{static_cast<Index>(next_), {}};
    for (const Index sample : plan_.groups[next_]) task.known.push_back(file_.known(sample));
    ++next_;
    if (!std::all_of(task.known.begin(), task.known.end(), [](const auto& known) { return known.has_value(); }))
      return task;
  }
  return std::nullopt;
}

void FileDesk::keep(const WorkspaceSample& sample) {
  const std::lock_guard lock(mutex_);
  file_.add(sample);
  kept_();
}

#ifndef SOFTKIN_MPI

Ranks::Ranks() {
  if (launched() > 1)
    throw InvalidInput(
        "this softkin was built without MPI, so that its copies cannot divide a workspace: build it with "
        "-DSOFTKIN_MPI=ON, or run it without mpirun");
}
Ranks::~Ranks() = default;
void Ranks::together(const std::function<void()>& part) const {
  part();
}
void Ranks::agree_on(const std::string&) const {}
void Ranks::distribute(const Model&, const WorkspacePlan&, GroupDesk* desk,
                       const std::function<void(GroupDesk&)>& work) const {
  work(*desk);
}

#else

namespace {

enum Tag : int { ask = 1, sample_made = 2, leave = 3, group_given = 4 };

void check_mpi(int code) {
  if (code != MPI_SUCCESS) throw InvalidInput("MPI failed with code " + std::to_string(code));
}

/// Open MPI waits busily; a core is worth more to a solve.
void doze() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void wait_for(MPI_Request& request) {
  for (int done = 0;;) {
    check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done) return;
    doze();
  }
}

int report_status(const std::optional<Status>& status) {
  return status ? static_cast<int>(*status) : -1;
}

std::optional<Status> reported_status(int number) {
  return number < 0 ? std::nullopt : std::optional(static_cast<Status>(number));
}

/// The desk of rank 0, from another rank. Its threads take turns. A sample is sent as its row of the workspace's file,
/// so that no column can be missing.
class RemoteDesk : public GroupDesk {
 public:
  RemoteDesk(const WorkspacePlan& plan, const WorkspaceColumns& columns) : plan_(plan), columns_(columns) {}

  std::optional<GroupTask> take() override {
    const std::lock_guard lock(mutex_);
    send("", ask);
    std::vector<int> reply(2 + longest());
    MPI_Request request = MPI_REQUEST_NULL;
    check_mpi(
        MPI_Irecv(reply.data(), static_cast<int>(reply.size()), MPI_INT, 0, group_given, MPI_COMM_WORLD, &request));
    wait_for(request);
    if (reply[0] < 0) return std::nullopt;
    GroupTask task{reply[0], {}};
    for (int i = 0; i < reply[1]; ++i) task.known.push_back(reported_status(reply[2 + i]));
    return task;
  }

  void keep(const WorkspaceSample& sample) override {
    const std::string row = workspace_row(sample, columns_);
    const std::lock_guard lock(mutex_);
    send(row, sample_made);
  }

  void say_goodbye() {
    const std::lock_guard lock(mutex_);
    send("", leave);
  }

 private:
  [[nodiscard]] std::size_t longest() const {
    std::size_t most = 0;
    for (const auto& group : plan_.groups) most = std::max(most, group.size());
    return most;
  }

  static void send(const std::string& text, Tag tag) {
    MPI_Request request = MPI_REQUEST_NULL;
    check_mpi(MPI_Isend(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, tag, MPI_COMM_WORLD, &request));
    wait_for(request);
  }

  const WorkspacePlan& plan_;
  const WorkspaceColumns& columns_;
  std::mutex mutex_;
};

/// Rank 0's side: answers the others until all have left.
class Counter {
 public:
  Counter(const WorkspacePlan& plan, const WorkspaceColumns& columns, GroupDesk& desk, int others)
      : plan_(plan), columns_(columns), desk_(desk), others_(others) {}

  void serve() {
    while (others_ > 0)
      if (!answer()) doze();
  }

 private:
  bool answer() {
    int waits = 0, count = 0;
    MPI_Status status;
    check_mpi(MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &waits, &status));
    if (!waits) return false;
    check_mpi(MPI_Get_count(&status, MPI_CHAR, &count));
    std::string text(count, '\0');
    check_mpi(
        MPI_Recv(text.data(), count, MPI_CHAR, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE));
    if (status.MPI_TAG == sample_made) keep(text, "rank " + std::to_string(status.MPI_SOURCE));
    if (status.MPI_TAG == ask) give(status.MPI_SOURCE);
    if (status.MPI_TAG == leave) --others_;
    return true;
  }

  void keep(const std::string& row, const std::string& rank) {
    const WorkspaceSample sample = read_workspace_row(row, columns_, rank);
    if (sample.number >= plan_.samples() || plan_.actuations.row(sample.number).transpose() != sample.actuation)
      throw InvalidInput({rank}, "sent sample " + std::to_string(sample.number) + " of another actuation");
    desk_.keep(sample);
  }

  void give(int rank) {
    std::vector<int> reply{-1, 0};
    if (const std::optional<GroupTask> task = desk_.take()) {
      reply = {task->group, static_cast<int>(task->known.size())};
      for (const auto& known : task->known) reply.push_back(report_status(known));
    }
    check_mpi(MPI_Send(reply.data(), static_cast<int>(reply.size()), MPI_INT, rank, group_given, MPI_COMM_WORLD));
  }

  const WorkspacePlan& plan_;
  const WorkspaceColumns& columns_;
  GroupDesk& desk_;
  int others_;
};

}  // namespace

Ranks::Ranks() {
  if (launched() == 0) return;
  int provided = 0;
  check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided));
  check_mpi(MPI_Comm_rank(MPI_COMM_WORLD, &rank_));
  check_mpi(MPI_Comm_size(MPI_COMM_WORLD, &size_));
  if (provided < MPI_THREAD_SERIALIZED)
    throw InvalidInput("this MPI does not let the threads of a program take turns (MPI_THREAD_SERIALIZED)");
}

Ranks::~Ranks() {
  int begun = 0, ended = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&ended);
  if (begun && !ended) MPI_Finalize();
}

void Ranks::together(const std::function<void()>& part) const {
  std::string message;
  std::exception_ptr failure;
  try {
    part();
  } catch (const std::exception& error) {
    message = *error.what() == '\0' ? "unknown" : error.what();
    failure = std::current_exception();
  }
  if (size_ == 1) {
    if (failure) std::rethrow_exception(failure);
    return;
  }
  int worst = 0;
  const int mine = failure ? size_ - rank_ : 0;  // the lowest rank that failed has the largest
  check_mpi(MPI_Allreduce(&mine, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD));
  if (worst == 0) return;
  const int failed = size_ - worst;
  std::vector<char> text(1000, '\0');
  if (rank_ == failed) std::copy_n(message.begin(), std::min(message.size(), text.size() - 1), text.begin());
  check_mpi(MPI_Bcast(text.data(), static_cast<int>(text.size()), MPI_CHAR, failed, MPI_COMM_WORLD));
  if (!leads()) throw Silence{};
  if (failure) std::rethrow_exception(failure);
  throw InvalidInput("rank " + std::to_string(failed) + ": " + text.data());
}

void Ranks::agree_on(const std::string& text) const {
  if (size_ == 1) return;
  std::string of_the_first = text;
  auto length = static_cast<int>(text.size());
  check_mpi(MPI_Bcast(&length, 1, MPI_INT, 0, MPI_COMM_WORLD));
  of_the_first.resize(length);
  check_mpi(MPI_Bcast(of_the_first.data(), length, MPI_CHAR, 0, MPI_COMM_WORLD));
  together([&] {
    if (of_the_first != text) throw InvalidInput("its scene, mesh or softkin is not that of rank 0");
  });
}

void Ranks::distribute(const Model& model, const WorkspacePlan& plan, GroupDesk* desk,
                       const std::function<void(GroupDesk&)>& work) const {
  if (size_ == 1) return work(*desk);
  const auto give_up = [](const char* why) {  // others wait for this rank and would wait forever
    std::fprintf(stderr, "softkin: %s\n", why);
    MPI_Abort(MPI_COMM_WORLD, 2);
  };
  try {
    const WorkspaceColumns columns = workspace_columns(model);
    if (!leads()) {
      RemoteDesk remote(plan, columns);
      work(remote);
      return remote.say_goodbye();
    }
    std::exception_ptr failure;
    std::thread own([&] {
      try {
        work(*desk);
      } catch (...) {
        failure = std::current_exception();
      }
    });
    Counter(plan, columns, *desk, size_ - 1).serve();
    own.join();
    if (failure) std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    give_up(error.what());
  }
}

#endif

}  // namespace softkin::runs
