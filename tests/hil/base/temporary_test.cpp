// SPDX-License-Identifier: Apache-2.0
#include "hil/base/temporary.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/atomic_file.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::set<std::string> namesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

/// A process that does its work and then waits to be killed; it has done it when this is made.
class Process {
 public:
  explicit Process(const std::function<void()>& work) {
    int done[2];
    if (::pipe(done) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(done[0]);
      work();
      (void)!::write(done[1], "x", 1);
      for (;;) ::pause();
    }
    ::close(done[1]);
    char byte{};
    EXPECT_EQ(::read(done[0], &byte, 1), 1);
    ::close(done[0]);
  }
  ~Process() { end(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void end() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_{-1};
};

class Temporary : public ::testing::Test {
 protected:
  TempFolder temp_;
};

TEST_F(Temporary, FolderGoesWithAllThatIsInIt) {
  {
    const TemporaryFolder folder(temp_.path(), "work");
    fs::create_directories(folder.path() / "a" / "b");
    std::ofstream(folder.path() / "a" / "b" / "c") << "text";
    EXPECT_THAT(namesIn(temp_.path()), SizeIs(1));
  }
  EXPECT_THAT(namesIn(temp_.path()), IsEmpty());
}

TEST_F(Temporary, FolderThatHasFoundItsPlaceStays) {
  {
    TemporaryFolder folder(temp_.path(), "work");
    fs::rename(folder.path(), temp_.path() / "place");
    folder.becomes({});
  }
  EXPECT_THAT(namesIn(temp_.path()), ElementsAre("place"));
}

TEST_F(Temporary, FolderOfAKilledProcessIsRemovedByTheNextAndThatOfALiveOneIsNot) {
  Process killed([this] {
    static std::optional<TemporaryFolder> folder;
    folder.emplace(temp_.path(), "work");
    std::ofstream(folder->path() / "half") << "written";
  });
  const Process alive([this] {
    static std::optional<TemporaryFolder> folder;
    folder.emplace(temp_.path(), "work");
  });
  fs::create_directory(temp_.path() / "work.my-own");
  fs::create_directory(temp_.path() / "other.ABCDEF");
  EXPECT_THAT(namesIn(temp_.path()), SizeIs(4));
  killed.end();
  {
    const TemporaryFolder next(temp_.path(), "work");
    EXPECT_THAT(namesIn(temp_.path()), SizeIs(4));
  }
  EXPECT_THAT(namesIn(temp_.path()), SizeIs(3));  // The live one's, and two that have nothing to do with it.
}

TEST_F(Temporary, LinkInItsPlaceIsNotFollowed) {
  const fs::path kept = temp_.path() / "kept";
  fs::create_directory(kept);
  std::ofstream(kept / "thesis") << "text";
  fs::create_directory_symlink(kept, temp_.path() / "work.ABCDEF");
  { const TemporaryFolder next(temp_.path(), "work"); }
  EXPECT_TRUE(fs::exists(kept / "thesis"));
}

TEST_F(Temporary, FileHasNoNameUntilItIsWhole) {
  AtomicFile file(temp_.path() / "file");
  file.write("content");
  EXPECT_THAT(namesIn(temp_.path()), IsEmpty());
  file.commit();
  EXPECT_THAT(namesIn(temp_.path()), ElementsAre("file"));
}

TEST_F(Temporary, AllAreRemovedWhenTheProcessIsToEnd) {
  const Process other([this] {
    static std::optional<TemporaryFolder> one;
    static std::optional<TemporaryFolder> two;
    one.emplace(temp_.path(), "one");
    two.emplace(temp_.path(), "two");
    std::ofstream(two->path() / "half") << "written";
    removeTemporaries();
  });
  EXPECT_THAT(namesIn(temp_.path()), IsEmpty());
}

}  // namespace
}  // namespace kerfbench::base
