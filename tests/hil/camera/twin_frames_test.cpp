// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin_frames.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/hil/camera/small_cameras.h"

namespace kerfbench::hil {
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

TEST(TwinFrameSource, RefusesExposuresOutOfOrder) {
  std::vector<twin::Exposure> list = exposures(3);
  std::swap(list[1], list[2]);
  EXPECT_THROW(TwinFrameSource(twin::SpotCamera(smallCamera(300, 240, 0.1), PrintLayout{}, 4.0, 9), list, 1),
               std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::hil
