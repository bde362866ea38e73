// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/exposure_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>

namespace kerfbench::camera {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kNever_s = -std::numeric_limits<double>::infinity();

/// One each millisecond, numbered by it.
std::vector<twin::Exposure> exposures(std::uint64_t first, std::uint64_t count) {
  std::vector<twin::Exposure> list;
  for (std::uint64_t i = first; i < first + count; ++i)
    list.push_back({.sequence = i, .start_s = 1e-3 * static_cast<double>(i), .samples = {{}}});
  return list;
}

std::vector<std::uint64_t> takeAll(ExposureFeed& feed) {
  std::vector<std::uint64_t> numbers;
  for (auto taken = feed.take(); !taken.empty(); taken = feed.take()) {
    for (const twin::Exposure& exposure : taken) numbers.push_back(exposure.sequence);
  }
  return numbers;
}

TEST(ExposureFeed, HandsOutWhatIsWantedAndNothingElse) {
  ExposureFeed feed(100);
  feed.add(exposures(0, 5));
  feed.want(0.0025, kNever_s);
  feed.add(exposures(5, 5));
  feed.want(0.0025, 0.0055);
  feed.end();
  EXPECT_THAT(takeAll(feed), ElementsAre(3U, 4U, 5U));
}

TEST(ExposureFeed, WhatComesAfterItIsWantedIsHandedOut) {
  ExposureFeed feed(100);
  feed.want(0.0, 0.002);
  feed.add(exposures(0, 5));
  feed.end();
  EXPECT_THAT(takeAll(feed), ElementsAre(0U, 1U, 2U));
}

TEST(ExposureFeed, OfNothingWantedNothingIsHandedOut) {
  ExposureFeed feed(100);
  feed.add(exposures(0, 50));
  feed.end();
  EXPECT_THAT(takeAll(feed), IsEmpty());
}

TEST(ExposureFeed, TwoThreadsLoseNothingHoweverFewMayWait) {
  ExposureFeed feed(16);
  std::vector<std::uint64_t> taken;
  std::thread consumer([&] { taken = takeAll(feed); });
  constexpr std::uint64_t kCount = 5000;
  for (std::uint64_t i = 0; i < kCount; i += 7) {
    feed.want(0.0, 1e-3 * static_cast<double>(i));
    feed.add(exposures(i, std::min<std::uint64_t>(7, kCount - i)));
  }
  feed.want(0.0, 1.0 * kCount);
  feed.end();
  consumer.join();
  ASSERT_EQ(taken.size(), kCount);
  for (std::uint64_t i = 0; i < kCount; ++i) EXPECT_EQ(taken[i], i);
}

TEST(ExposureFeed, WhoRunsTheMachineWaitsUntilSomeAreTaken) {
  ExposureFeed feed(16);
  feed.add(exposures(0, 40));
  std::thread producer([&] {
    feed.want(0.0, 1.0);
    feed.end();
  });
  EXPECT_EQ(takeAll(feed).size(), 40U);
  producer.join();
}

TEST(ExposureFeed, OnceItIsClosedNobodyWaits) {
  ExposureFeed feed(16);
  std::thread consumer([&] { EXPECT_THAT(takeAll(feed), IsEmpty()); });
  std::thread producer([&] {
    feed.add(exposures(0, 10));
    feed.close();
    feed.add(exposures(10, 100));
    feed.want(0.0, 1.0);
  });
  producer.join();
  consumer.join();
}

TEST(ExposureFeed, RefusesExposuresOutOfOrder) {
  ExposureFeed feed(16);
  feed.add(exposures(3, 2));
  EXPECT_THROW(feed.add(exposures(4, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::camera
