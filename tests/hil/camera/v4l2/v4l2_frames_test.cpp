// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/v4l2_frames.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_video.h"
#include "hil/camera/v4l2/v4l2_stream.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kOffset_s = -4.0;

/// A camera of 100 frames/s whose clock is 4 s ahead of the pins'.
class V4l2Frames : public testing::Test {
 protected:
  V4l2FrameSource& start(std::uint64_t frames) {
    options.frames = frames;
    options.exposure_s = 0.002;
    stream.emplace(video, "/dev/video7",
                   CameraSettings{.format = findPixelFormat("GREY"), .width_px = 64, .height_px = 48});
    source.emplace(*stream, CameraClock(0.0, {{kOffset_s, 0.0}}), options);
    return *source;
  }
  static std::vector<std::uint64_t> sequencesOf(const std::vector<Frame>& frames) {
    std::vector<std::uint64_t> all;
    for (const Frame& frame : frames) all.push_back(frame.sequence);
    return all;
  }

  FakeVideo video;
  V4l2FrameOptions options;
  std::optional<V4l2Stream> stream;
  std::optional<V4l2FrameSource> source;
};

TEST_F(V4l2Frames, AreGivenOnTheClockOfThePinsWithoutTheFirstBuffer) {
  video.addFrames(11, 500);
  video.now_ns = 10'000'000'000;
  V4l2FrameSource& frames = start(10);
  std::vector<Frame> all = frames.nextBatch(4);
  EXPECT_EQ(all.size(), 4U);
  for (Frame& frame : frames.nextBatch(100)) all.push_back(std::move(frame));
  ASSERT_EQ(all.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(all[i].sequence, i);
    // The first frame's stamp is 5 s and 501 periods; it is discarded.
    EXPECT_NEAR(all[i].start_s, 5.0 + 0.01 * (502.0 + static_cast<double>(i)) + kOffset_s, 1e-6);
    EXPECT_EQ(all[i].exposure_s, 0.002);
    EXPECT_EQ(all[i].image.at(5, 7), (501 + i) % 251);
  }
  EXPECT_TRUE(frames.nextBatch(5).empty());
  EXPECT_EQ(frames.report().taken, 10U);
  EXPECT_EQ(frames.report().good, 10U);
  EXPECT_EQ(frames.report().incidents, 0U);
  EXPECT_EQ(frames.report().ended_early, "");
  EXPECT_EQ(frames.report().clock, StampClock::kMonotonic);
}

TEST_F(V4l2Frames, TellLostOnesWithTheirTimeOnThePins) {
  video.addFrames(3, 0);
  video.addFrames(3, 6);
  V4l2FrameSource& frames = start(5);
  EXPECT_THAT(sequencesOf(frames.nextBatch(100)), ElementsAre(0, 1, 5, 6, 7));
  EXPECT_EQ(frames.report().lost, 3U);
  ASSERT_EQ(frames.report().incidents, 1U);
  const CaptureIncident& incident = frames.report().first_incidents.at(0);
  EXPECT_NEAR(incident.from_s, 1.03, 1e-6);
  EXPECT_NEAR(incident.to_s, 1.07, 1e-6);
  EXPECT_EQ(incident.words, "3 frames were lost");
}

TEST_F(V4l2Frames, ThatAreNotToBeBelievedAreMissingInTheSequence) {
  video.addFrames(7);
  video.frames[2].flags |= V4L2_BUF_FLAG_ERROR;
  video.frames[3].bytesused = 10;
  video.frames[5].bytes = video.frames[4].bytes;
  V4l2FrameSource& frames = start(6);
  EXPECT_THAT(sequencesOf(frames.nextBatch(100)), ElementsAre(0, 3, 5));
  const CaptureReport& report = frames.report();
  EXPECT_EQ(report.taken, 6U);
  EXPECT_EQ(report.good, 3U);
  EXPECT_EQ(report.lost, 0U);
  ASSERT_EQ(report.incidents, 3U);
  EXPECT_THAT(report.first_incidents[0].words, HasSubstr("damaged"));
  EXPECT_THAT(report.first_incidents[1].words, HasSubstr("too few"));
  EXPECT_THAT(report.first_incidents[2].words, HasSubstr("to the byte"));
  EXPECT_NEAR(report.first_incidents[1].from_s, 1.02, 1e-6);
  EXPECT_NEAR(report.first_incidents[1].to_s, 1.04, 1e-6);
}

TEST_F(V4l2Frames, ThatCannotBeReadSayWhy) {
  video.fourccs = {V4L2_PIX_FMT_Y10};
  video.format.pixelformat = V4L2_PIX_FMT_Y10;
  video.format.bytesperline = 128;
  video.format.sizeimage = 128 * 48;
  video.addFrames(3);
  for (FakeFrame& frame : video.frames) frame.bytes.assign(128 * 48, 3);  // Value 0x0303 has 10 bits.
  video.frames[1].bytes[1] = 4;                                           // Value 0x0403 has more.
  options.watch.sensor_has_noise = false;
  options.frames = 2;
  options.exposure_s = 0.002;
  stream.emplace(video, "/dev/video7",
                 CameraSettings{.format = findPixelFormat("Y10"), .width_px = 64, .height_px = 48});
  source.emplace(*stream, CameraClock(0.0, {{kOffset_s, 0.0}}), options);
  EXPECT_EQ(source->nextBatch(100).size(), 1U);
  EXPECT_THAT(source->report().first_incidents.at(0).words, HasSubstr("beyond 10 bits"));
}

TEST_F(V4l2Frames, MissLossesThatOnlyTheTimeShowsUnlessATriggerMakesThem) {
  for (const bool triggered : {false, true}) {
    source.reset();
    stream.reset();
    video.now_ns = 5'000'000'000;
    video.frames.clear();
    video.addFrames(6);
    for (std::size_t i = 3; i < 6; ++i) {
      video.frames[i].stamp_ns += 30'000'000;
      video.frames[i].arrival_ns += 30'000'000;
    }
    options.is_triggered = triggered;
    V4l2FrameSource& frames = start(5);
    EXPECT_EQ(frames.nextBatch(100).size(), triggered ? 5U : 4U);
    EXPECT_EQ(frames.report().incidents, triggered ? 0U : 1U);
  }
}

TEST_F(V4l2Frames, EndEarlyWithAReasonWhenTheCameraStops) {
  video.addFrames(4);
  V4l2FrameSource& frames = start(10);
  EXPECT_EQ(frames.nextBatch(100).size(), 3U);
  EXPECT_THAT(frames.report().ended_early, HasSubstr("no frame within 1000 ms"));
  video.addFrames(4, 200);
  EXPECT_TRUE(frames.nextBatch(100).empty());  // Later frames are not part of this capture.
}

TEST_F(V4l2Frames, EndEarlyWithAReasonWhenTheCameraVanishes) {
  video.addFrames(4);
  video.frames[3].before = [this] { video.is_gone = true; };
  V4l2FrameSource& frames = start(10);
  EXPECT_EQ(frames.nextBatch(100).size(), 2U);
  EXPECT_THAT(frames.report().ended_early, HasSubstr("vanished"));
}

TEST_F(V4l2Frames, TellHowFarStampsLieInTheFuture) {
  video.addFrames(4);
  // Stamps of vivid at 25/s.
  for (FakeFrame& frame : video.frames) frame.arrival_ns = frame.stamp_ns - 34'000'000;
  for (FakeFrame& frame : video.frames) frame.arrival_ns = std::max(frame.arrival_ns, video.now_ns);
  V4l2FrameSource& frames = start(3);
  EXPECT_EQ(frames.nextBatch(100).size(), 3U);
  EXPECT_NEAR(frames.report().worst_ahead_s, 0.034, 1e-6);
}

TEST_F(V4l2Frames, KeepOnlyTheFirstThousandIncidentsButCountAll) {
  for (std::uint32_t i = 0; i < 1202; ++i) {
    video.frames.push_back(video.frameOf(i));
    video.frames.back().flags |= V4L2_BUF_FLAG_ERROR;
  }
  V4l2FrameSource& frames = start(1201);
  EXPECT_TRUE(frames.nextBatch(5000).empty());
  EXPECT_EQ(frames.report().incidents, 1201U);
  EXPECT_EQ(frames.report().first_incidents.size(), 1000U);
}

TEST_F(V4l2Frames, RefuseOptionsOutOfRangeAllAtOnce) {
  (void)start(1);
  options = {.exposure_s = 0.0, .frames = 0, .timeout_ms = 0};
  try {
    const V4l2FrameSource none(*stream, CameraClock(0.0, {{kOffset_s, 0.0}}), options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const char* name : {"exposure_s", "frames", "timeout_ms"})
      EXPECT_THAT(error.what(), HasSubstr(name));
  }
}

}  // namespace
}  // namespace kerfbench::camera
