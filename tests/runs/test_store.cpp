#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/store.hpp>

#include "cli/run_program.hpp"

namespace softkin::runs {
namespace {

namespace fs = std::filesystem;
using softkin::testing::read_text;
using softkin::testing::TemporaryFolder;

const std::string head = "first line\nsecond line\n";

struct StoreFolder : TemporaryFolder {
  std::string file = *this / "records";

  [[nodiscard]] Store begun() const { return Store(file, head, false); }
  [[nodiscard]] Store resumed() const { return Store(file, head, true); }
};

std::vector<std::string> records_of(const Store& store) {
  std::vector<std::string> records;
  store.each([&](std::size_t number, std::string_view record) {
    EXPECT_EQ(number, records.size());
    records.emplace_back(record);
    return true;
  });
  return records;
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was thrown";
}

/// A journal that a repository keeps by Git LFS.
TEST(Store, IsNotResumedFromAPointer) {
  const StoreFolder folder;
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n";
  write_file(folder.file, pointer);
  try {
    (void)folder.resumed();
    ADD_FAILURE() << "resumed";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("is a Git LFS pointer"), std::string::npos) << error.what();
  }
  EXPECT_EQ(read_beginning(folder.file, 1000), pointer);
}

TEST(Store, KeepsRecordsInTheirOrder) {
  const StoreFolder folder;
  {
    Store store = folder.begun();
    for (const char* record : {"a", "", "c"}) store.append(record);
    EXPECT_EQ(store.size(), 3u);
    EXPECT_EQ(read_text(folder.file), head + "a\n\nc\n");
    EXPECT_EQ(records_of(store), (std::vector<std::string>{"a", "", "c"}));
  }
  Store store = folder.resumed();
  EXPECT_EQ(store.head(), head);
  EXPECT_FALSE(store.was_torn());
  store.append("d");
  EXPECT_EQ(records_of(store), (std::vector<std::string>{"a", "", "c", "d"}));
}

TEST(Store, ReadsRecordsThatAreLongerThanItsPieces) {
  const StoreFolder folder;
  std::vector<std::string> records;
  {
    Store store = folder.begun();
    for (std::size_t i = 0; i < 20; ++i) {
      records.emplace_back(i * 30011, static_cast<char>('a' + i % 26));
      store.append(records.back());
    }
    EXPECT_EQ(records_of(store), records);
  }
  EXPECT_EQ(records_of(folder.resumed()), records);
}

TEST(Store, VisitsNoMoreThanIsAsked) {
  const StoreFolder folder;
  Store store = folder.begun();
  for (int i = 0; i < 9; ++i) store.append(std::to_string(i));
  std::size_t visited = 0;
  store.each([&](std::size_t number, std::string_view) {
    ++visited;
    return number < 4;
  });
  EXPECT_EQ(visited, 5u);
}

TEST(Store, BegunAgainForgetsWhatWasThere) {
  const StoreFolder folder;
  folder.begun().append("old");
  EXPECT_EQ(folder.begun().size(), 0u);
  EXPECT_EQ(read_text(folder.file), head);
}

TEST(Store, CutsAndGoesOn) {
  const StoreFolder folder;
  Store store = folder.begun();
  for (const char* record : {"a", "b", "c"}) store.append(record);
  store.cut(5);
  EXPECT_EQ(store.size(), 3u);
  store.cut(1);
  EXPECT_EQ(read_text(folder.file), head + "a\n");
  store.append("d");
  EXPECT_EQ(records_of(store), (std::vector<std::string>{"a", "d"}));
}

TEST(Store, ATornLastLineCountsForNothing) {
  const StoreFolder folder;
  {
    Store store = folder.begun();
    store.append("a");
    store.append("a long record");
  }
  const std::string whole = read_text(folder.file);
  for (std::size_t missing = 1; missing <= 14; ++missing) {
    const std::string torn = whole.substr(0, whole.size() - missing);
    folder.write("records", torn);
    Store store = folder.resumed();
    EXPECT_EQ(store.was_torn(), missing < 14) << missing;
    EXPECT_EQ(records_of(store), std::vector<std::string>{"a"});
    EXPECT_EQ(read_text(folder.file), torn) << "nothing is written before something is added";
    store.append("b");
    EXPECT_EQ(read_text(folder.file), head + "a\nb\n") << missing;
  }
}

TEST(Store, KilledBeforeItsHeadWasThereBegins) {
  const StoreFolder folder;
  for (const std::size_t length : {std::size_t{0}, std::size_t{4}, std::size_t{11}, head.size() - 1}) {
    folder.write("records", head.substr(0, length));
    Store store = folder.resumed();
    store.append("a");
    EXPECT_EQ(read_text(folder.file), head + "a\n") << length;
  }
}

TEST(Store, LeavesAFileThatIsNoneOfIts) {
  const StoreFolder folder;
  for (const std::string text : {"", "other", "a\nb", "first line\nother"}) {
    folder.write("records", "x" + text);
    const Store store = folder.resumed();
    EXPECT_NE(store.head(), head);
    EXPECT_EQ(read_text(folder.file), "x" + text);
  }
}

TEST(Store, IsLockedAgainstAnotherProcess) {
  const StoreFolder folder;
  std::optional<Store> store;
  store.emplace(folder.file, head, false);
  store->append("a");
  const auto other = [&](bool resume) {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        Store second(folder.file, head, resume);
        ::_exit(0);
      } catch (const InvalidInput& error) {
        ::_exit(std::string(error.what()).ends_with("another softkin is at work on it") ? 7 : 8);
      }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(other(true), 7);
  EXPECT_EQ(other(false), 7);
  EXPECT_EQ(read_text(folder.file), head + "a\n");
  store.reset();
  EXPECT_EQ(other(true), 0);
}

/// Limits the size of files of this process [bytes].
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit before_{};
  sighandler_t handler_ = nullptr;
};

TEST(Store, TakesBackARecordThatTheDiskHasNoRoomFor) {
  const StoreFolder folder;
  Store store = folder.begun();
  store.append("a");
  {
    const SmallDisk disk(head.size() + 10);
    const std::string why = message_of([&] { store.append("too long for what is left"); });
    EXPECT_NE(why.find("records: cannot be written: no room left"), std::string::npos) << why;
    EXPECT_EQ(read_text(folder.file), head + "a\n");
    EXPECT_EQ(store.size(), 1u);
    store.append("short");
  }
  store.append("long enough to need the room");
  EXPECT_EQ(records_of(store), (std::vector<std::string>{"a", "short", "long enough to need the room"}));
}

TEST(WriteFile, SaysWhyAndLeavesWhatWasThere) {
  const TemporaryFolder folder;
  const std::string file = folder.write("report.json", "before");
  {
    const SmallDisk disk(10);
    const std::string why = message_of([&] { write_file(file, std::string(100'000, 'x')); });
    EXPECT_NE(why.find("report.json: cannot be written: File too large"), std::string::npos) << why;
  }
  EXPECT_EQ(read_text(file), "before");
  EXPECT_EQ(folder.files(), 1u);
  write_file(file, "after");
  EXPECT_EQ(read_text(file), "after");
}

TEST(Store, WithoutANameLeavesNothing) {
  const TemporaryFolder folder;
  const char* before = ::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", (folder / "").c_str(), 1);
  {
    Store store("", head, true);
    store.append("a");
    store.append("b");
    EXPECT_EQ(records_of(store), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(folder.files(), 0u);
    store.remove();
  }
  kept.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
}

TEST(Store, SaysWhereItCannotWrite) {
  const StoreFolder folder;
  const std::string why = message_of([&] { Store(folder / "none/records", head, false); });
  EXPECT_NE(why.find("none/records: cannot be written: No such file or directory"), std::string::npos) << why;
  Store store = folder.begun();
  store.remove();
  EXPECT_FALSE(fs::exists(folder.file));
}

}  // namespace
}  // namespace softkin::runs
