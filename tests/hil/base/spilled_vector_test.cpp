// SPDX-License-Identifier: Apache-2.0
#include "hil/base/spilled_vector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <system_error>
#include <utility>

namespace kerfbench::base {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// No whole number of them fills a page.
struct Odd {
  std::uint64_t a{};
  std::array<std::uint8_t, 12> b{};
  std::uint32_t c{};
  friend bool operator==(const Odd&, const Odd&) = default;
};
static_assert(sizeof(Odd) == 24);

constexpr std::size_t kInMemory = SpilledBytes::kInMemory / sizeof(std::uint64_t);

SpilledVector<std::uint64_t> counted(std::size_t count) {
  SpilledVector<std::uint64_t> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(i * i);
  return all;
}

bool isCounted(const SpilledVector<std::uint64_t>& all, std::size_t from = 0) {
  for (std::size_t i = from; i < all.size(); ++i) {
    if (all[i] != i * i) return false;
  }
  return true;
}

TEST(SpilledVector, IsEmptyAtFirst) {
  const SpilledVector<int> none;
  EXPECT_THAT(none, IsEmpty());
  EXPECT_EQ(none.begin(), none.end());
  for (const int value : none.streamed()) FAIL() << value;
  EXPECT_EQ(none, SpilledVector<int>(none));
  EXPECT_THAT((SpilledVector<int>{3, 4}), ElementsAre(3, 4));
}

TEST(SpilledVector, HoldsWhatWasAppendedOnBothSidesOfEachBorder) {
  constexpr std::size_t kBlock = (std::size_t{1} << 20U) / sizeof(std::uint64_t);
  for (const std::size_t border : {std::size_t{64}, kInMemory, kInMemory + kBlock, kInMemory + 60 * kBlock}) {
    for (const std::size_t count : {border - 1, border, border + 1}) {
      const SpilledVector<std::uint64_t> all = counted(count);
      ASSERT_EQ(all.size(), count);
      EXPECT_TRUE(isCounted(all)) << count;
      EXPECT_EQ(all.back(), (count - 1) * (count - 1));
    }
  }
}

TEST(SpilledVector, TakesElementsThatFillNoPage) {
  SpilledVector<Odd> all;
  std::vector<Odd> expected;
  for (std::uint32_t i = 0; i < 700'000; ++i)
    expected.push_back({i * 7ULL, {static_cast<std::uint8_t>(i)}, i});
  for (std::size_t at = 0; at < expected.size(); at += 1000)
    all.append(std::span<const Odd>(expected).subspan(at, 1000));
  EXPECT_EQ(all, expected);
}

TEST(SpilledVector, StreamsWhatItHoldsAndHoldsItAfterwards) {
  const SpilledVector<std::uint64_t> all = counted(3 * kInMemory + 12345);
  for (int round = 0; round < 2; ++round) {
    std::uint64_t i = 0;
    for (const std::uint64_t value : all.streamed()) {
      ASSERT_EQ(value, i * i);
      ++i;
    }
    EXPECT_EQ(i, all.size());
  }
  all.giveBack(0, all.size());
  EXPECT_TRUE(isCounted(all));
}

TEST(SpilledVector, IsEmptyWhenItWasMovedAndCanBeFilledAgain) {
  SpilledVector<std::uint64_t> all = counted(2 * kInMemory);
  const SpilledVector<std::uint64_t> taken = std::move(all);
  EXPECT_TRUE(all.empty());  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(taken.size(), 2 * kInMemory);
  all = counted(kInMemory + 1);
  EXPECT_TRUE(isCounted(all));
  all.clear();
  all.push_back(5);
  EXPECT_THAT(all, ElementsAre(5U));
  EXPECT_TRUE(isCounted(taken));
}

TEST(SpilledVector, CopiesGoOnApart) {
  SpilledVector<std::uint64_t> all = counted(2 * kInMemory + 77);
  SpilledVector<std::uint64_t> copy = all;
  EXPECT_EQ(copy, all);
  for (std::uint64_t i = all.size(); i < 3 * kInMemory; ++i) all.push_back(i * i);
  for (std::uint64_t i = copy.size(); i < 3 * kInMemory; ++i) copy.push_back(i);
  EXPECT_TRUE(isCounted(all));
  ASSERT_EQ(copy.size(), 3 * kInMemory);
  for (std::uint64_t i = 0; i < copy.size(); ++i) ASSERT_EQ(copy[i], i < 2 * kInMemory + 77 ? i * i : i);
  const SpilledVector<std::uint64_t> of_copy = copy;
  all.clear();
  copy.clear();
  EXPECT_EQ(of_copy.back(), 3 * kInMemory - 1) << "what is left of the file is its own";
}

/// Says why appending failed, and whether all is still there.
[[noreturn]] void exitWithReason(std::size_t count, std::size_t held = 0) {
  SpilledVector<std::uint64_t> all;
  all.holdInMemory(held);
  try {
    for (std::size_t i = 0; i < count; ++i) all.push_back(i * i);
  } catch (const std::system_error& e) {
    std::fputs(e.what(), stderr);
    std::_Exit(isCounted(all) && all.size() >= kInMemory ? 1 : 2);
  }
  std::_Exit(0);
}

TEST(SpilledVectorDeathTest, AFullDiskIsAnErrorWithFolderAndSize) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fill = [](std::size_t file_bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{file_bytes, file_bytes};
    ::setenv("TMPDIR", testing::TempDir().c_str(), 1);
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) std::_Exit(3);
    exitWithReason(4 * kInMemory);
  };
  EXPECT_EXIT(fill(SpilledBytes::kInMemory + (4U << 20U)), testing::ExitedWithCode(1),
              "no temporary file of 13631488 bytes in .*TMPDIR names another folder.*: File too large");
  EXPECT_EXIT(fill(1U << 20U), testing::ExitedWithCode(1), "no temporary file of 8388608 bytes");
}

TEST(SpilledVectorDeathTest, WithoutAFolderItHoldsWhatFitsInMemory) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fill = [](std::size_t count, std::size_t held) {
    ::setenv("TMPDIR", "/nowhere/at/all", 1);
    exitWithReason(count, held);
  };
  EXPECT_EXIT(fill(kInMemory, 0), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(fill(kInMemory + 1, 0), testing::ExitedWithCode(1),
              "no temporary file in /nowhere/at/all .*: No such file");
  EXPECT_EXIT(fill(3 * kInMemory, 3 * kInMemory), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace kerfbench::base
