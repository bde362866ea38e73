// SPDX-License-Identifier: Apache-2.0
#include "hil/base/unique_fd.h"

#include <fcntl.h>

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

struct Noted {
  std::vector<int> closed;
  int close(int fd) {
    closed.push_back(fd);
    return 0;
  }
};
using NotedFd = OwnedFd<SystemClose<Noted*>>;

TEST(OwnedFd, IsClosedOnceByTheLastOwner) {
  Noted system;
  {
    NotedFd first(7, {&system});
    NotedFd second(std::move(first));
    NotedFd third;
    EXPECT_FALSE(third.valid());
    third = std::move(second);
    EXPECT_EQ(third.get(), 7);
    EXPECT_TRUE(system.closed.empty());
  }
  EXPECT_EQ(system.closed, std::vector<int>{7});
}

TEST(OwnedFd, ClosesWhatItHeldWhenItTakesAnother) {
  Noted system;
  NotedFd fd(7, {&system});
  fd = NotedFd(8, {&system});
  EXPECT_EQ(system.closed, std::vector<int>{7});
  EXPECT_EQ(fd.get(), 8);
}

TEST(OwnedFd, GivesTheDescriptorAway) {
  Noted system;
  {
    NotedFd fd(7, {&system});
    EXPECT_EQ(fd.release(), 7);
    EXPECT_FALSE(fd.valid());
  }
  EXPECT_TRUE(system.closed.empty());
}

TEST(UniqueFd, ClosesTheKernelsDescriptor) {
  const int fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  { const UniqueFd owner(fd); }
  EXPECT_EQ(::fcntl(fd, F_GETFD), -1);
}

}  // namespace
}  // namespace kerfbench::base
