// SPDX-License-Identifier: Apache-2.0
#include "hil/base/parallel.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

TEST(ForEachIndex, CallsEachIndexOnce) {
  for (const int threads : {0, 1, 2, 7}) {
    std::vector<int> calls(1000, 0);
    forEachIndex(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(1000, 1)) << threads;
  }
  forEachIndex(0, 4, [](std::size_t) { FAIL(); });
}

TEST(ForEachIndex, PassesOnTheFailureOfTheSmallestIndex) {
  for (const int threads : {1, 3}) {
    try {
      forEachIndex(100, threads, [](std::size_t i) {
        if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "no failure";
    } catch (const std::runtime_error& failure) {
      EXPECT_STREQ(failure.what(), "7");
    }
  }
}

}  // namespace
}  // namespace kerfbench::base
