// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_frames.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/hil/camera/small_cameras.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

std::vector<twin::Exposure> exposures(std::size_t count) {
  std::vector<twin::Exposure> list;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i);
    list.push_back(
        {.sequence = 10 + i,
         .start_s = 1e-3 * t,
         .samples = {
             {.p_WQ_mm = {0.3 * t, 5.0}, .radius_mm = 0.1, .power_w = 20.0, .p_WS_mm = {0.2 * t, 0.0}}}});
  }
  return list;
}

TwinFrameSource source(int threads) {
  PrintLayout print;
  print.pitch_mm = 100.0;
  print.marks = {{{0.0, -5.0}, 3.0}};
  return {twin::SpotCamera(smallCamera(300, 240, 0.1), print, 4.0, 9), exposures(23), threads};
}

std::vector<Frame> readAll(TwinFrameSource from, std::size_t batch) {
  std::vector<Frame> all;
  for (auto frames = from.nextBatch(batch); !frames.empty(); frames = from.nextBatch(batch)) {
    EXPECT_LE(frames.size(), batch);
    for (Frame& frame : frames) all.push_back(std::move(frame));
  }
  return all;
}

TEST(TwinFrameSource, GivesTheSameFramesAtAnyNumberOfThreadsAndAnyBatch) {
  const std::vector<Frame> one = readAll(source(1), 23);
  ASSERT_EQ(one.size(), 23U);
  for (const int threads : {2, 5}) {
    for (const std::size_t batch : {std::size_t{1}, std::size_t{4}, std::size_t{100}}) {
      const std::vector<Frame> other = readAll(source(threads), batch);
      ASSERT_EQ(other.size(), one.size());
      for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(other[i].sequence, 10 + i);
        EXPECT_EQ(other[i].start_s, one[i].start_s);
        EXPECT_EQ(other[i].image.pixels, one[i].image.pixels);
      }
    }
  }
}

/// 240 rows take three periods and a bit.
TwinFrameSource slowSource(double link_bytes_per_s = 0.0) {
  twin::CameraDescription description = smallCamera(300, 240, 0.1);
  description.frame_period_s = 1e-3;
  description.read_out = {.row_s = 13e-6, .link_bytes_per_s = link_bytes_per_s};
  PrintLayout print;
  print.pitch_mm = 100.0;
  return {twin::SpotCamera(description, print, 4.0, 9), exposures(23), 2};
}

std::vector<Frame> readWindows(TwinFrameSource from, const std::vector<PixelWindow>& windows) {
  std::vector<Frame> all;
  const auto next = [&] { return from.nextWindowed(4, [&](double) { return windows; }); };
  for (auto frames = next(); !frames.empty(); frames = next()) {
    for (Frame& frame : frames) all.push_back(std::move(frame));
  }
  return all;
}

TEST(TwinFrameSource, ACameraThatStillReadsOutIsNotExposed) {
  const std::vector<Frame> whole = readWindows(slowSource(), {});
  ASSERT_EQ(whole.size(), 6U);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i].sequence, 10 + i) << "no frame was lost: none was taken";
    EXPECT_DOUBLE_EQ(whole[i].start_s, 4e-3 * static_cast<double>(i));
    EXPECT_EQ(whole[i].image.width, 300);
  }
  // Rows that several windows share are read once: 76 rows are within a period, 77 are not.
  EXPECT_EQ(readWindows(slowSource(), {{0, 20, 40, 50}, {100, 46, 40, 50}}).size(), 23U);
  EXPECT_EQ(readWindows(slowSource(), {{0, 20, 40, 50}, {100, 47, 40, 50}}).size(), 12U);
  // 2000 pixels in a period, and 2100.
  EXPECT_EQ(readWindows(slowSource(2e6), {{0, 20, 40, 50}}).size(), 23U);
  EXPECT_EQ(readWindows(slowSource(2e6), {{0, 20, 42, 50}}).size(), 12U);
  // Without windows to choose, pictures are whole and take no time.
  EXPECT_EQ(readAll(slowSource(), 5).size(), 23U);
}

TwinFrameSource withLink(const twin::FrameLink& link, std::size_t count, int threads = 1) {
  twin::CameraDescription description = smallCamera(64, 48, 0.5);
  description.link = link;
  PrintLayout print;
  print.pitch_mm = 100.0;
  return {twin::SpotCamera(description, print, 4.0, 9), exposures(count), threads};
}

TEST(TwinFrameSource, LosesTheFramesOfTheListAndLeavesAGap) {
  const std::vector<Frame> frames = readAll(withLink({.dropped = {10, 14, 15, 32}}, 23), 2);
  ASSERT_EQ(frames.size(), 19U);
  EXPECT_EQ(frames[0].sequence, 11U);
  EXPECT_EQ(frames[2].sequence, 13U);
  EXPECT_EQ(frames[3].sequence, 16U);
  EXPECT_EQ(frames.back().sequence, 31U);
}

TEST(TwinFrameSource, LosesFramesAsOftenAsTheLinkSaysTheSameAtAnyNumberOfThreads) {
  const std::vector<Frame> one = readAll(withLink({.drop_share = 0.3}, 1000), 50);
  EXPECT_NEAR(static_cast<double>(one.size()), 700.0, 60.0);
  const std::vector<Frame> two = readAll(withLink({.drop_share = 0.3}, 1000, 2), 7);
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(two[i].sequence, one[i].sequence);
  EXPECT_TRUE(readAll(withLink({.drop_share = 1.0}, 20), 5).empty());
}

TEST(TwinFrameSource, StampsFramesEarlyAndLateAsTheLinkSays) {
  const std::vector<Frame> frames =
      readAll(withLink({.stamp_jitter_s = 2e-5, .late_share = 0.1, .late_s = 5e-4}, 1000), 50);
  double sum = 0.0, squares = 0.0;
  int late = 0, punctual = 0;
  for (const Frame& frame : frames) {
    const double error_s = frame.start_s - 1e-3 * static_cast<double>(frame.sequence - 10);
    if (error_s > 2.5e-4) {
      ++late;
      continue;
    }
    ++punctual;
    sum += error_s;
    squares += error_s * error_s;
  }
  EXPECT_NEAR(late, 100, 40);
  EXPECT_NEAR(sum / punctual, 0.0, 3e-6);
  EXPECT_NEAR(std::sqrt(squares / punctual), 2e-5, 2e-6);
}

TEST(TwinFrameSource, RefusesExposuresOutOfOrder) {
  std::vector<twin::Exposure> list = exposures(3);
  std::swap(list[1], list[2]);
  EXPECT_THROW(TwinFrameSource(twin::SpotCamera(smallCamera(300, 240, 0.1), PrintLayout{}, 4.0, 9), list, 1),
               std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::camera
