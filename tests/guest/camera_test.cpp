// SPDX-License-Identifier: Apache-2.0
// The bench's reader of cameras on the kernel's real V4L2: a loop that the test writes into (v4l2loopback),
// and a camera of the kernel's own that fails on demand (vivid). Time is the guest's: a count of
// instructions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/v4l2-dv-timings.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "hil/camera/v4l2/device_list.h"
#include "hil/camera/v4l2/v4l2_frames.h"
#include "hil/camera/v4l2/v4l2_stream.h"
#include "hil/camera/v4l2/video_device.h"
#include "tests/guest/loop_camera.h"
#include "tests/guest/player.h"

namespace kerfbench::guest {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth_px = 160;
constexpr int kHeight_px = 120;
constexpr std::uint32_t kRate_hz = 30;
constexpr std::uint64_t kPeriod_ns = 1'000'000'000 / kRate_hz;
const std::string kLoop = "/dev/video20";  // As init.sh numbers them.
const std::string kVivid = "/dev/video30";

hil::CameraSettings grey(int width_px, int height_px) {
  hil::CameraSettings settings;
  settings.format = hil::findPixelFormat("GREY");
  settings.width_px = width_px;
  settings.height_px = height_px;
  return settings;
}

/// What a source gave out, and what it told, until it ended.
struct Taken {
  std::vector<Frame> frames;
  hil::CaptureReport report;

  [[nodiscard]] std::vector<std::string> incidents() const {
    std::vector<std::string> words;
    for (const hil::CaptureIncident& incident : report.first_incidents) words.push_back(incident.words);
    return words;
  }
};

class Reader {
 public:
  Reader(const std::string& path, const hil::CameraSettings& settings, hil::V4l2FrameOptions options)
      : stream_(hil::kernelVideoCalls(), path, settings),
        source_(stream_, hil::CameraClock(0.0, {{0.0, 0.0}}), options) {}

  std::vector<Frame> take(std::size_t count) { return source_.nextBatch(count); }
  /// To the end.
  Taken takeAll() {
    std::vector<Frame> frames = source_.nextBatch(SIZE_MAX);
    return {std::move(frames), source_.report()};
  }

 private:
  hil::V4l2Stream stream_;
  hil::V4l2FrameSource source_;
};

class LoopTest : public testing::Test {
 protected:
  /// A reader of so many frames, and a camera that starts when the reader streams.
  Taken record(std::uint64_t frames, const std::vector<Exposure>& script) {
    Reader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(frames));
    std::jthread camera([&] { writer.run(script); });
    return reader.takeAll();
  }
  static hil::V4l2FrameOptions optionsFor(std::uint64_t frames) {
    hil::V4l2FrameOptions options;
    options.exposure_s = 1e-3;
    options.frames = frames;
    options.timeout_ms = 500;
    return options;
  }
  /// Each frame is the picture of its own place in the sequence, which begins with that of `first_number`.
  static void expectNumbered(const std::vector<Frame>& frames, std::uint32_t first_number) {
    ASSERT_FALSE(frames.empty());
    for (const Frame& frame : frames) {
      const auto number = static_cast<std::uint32_t>(first_number + frame.sequence);
      EXPECT_EQ(frame.image.pixels, numberedImage(kWidth_px, kHeight_px, number).pixels) << number;
    }
  }
  LoopWriter writer{kLoop, kWidth_px, kHeight_px, kRate_hz};
};

TEST_F(LoopTest, IsListedWithWhatItsWriterSet) {
  writer.write(1);
  const std::vector<hil::CameraListing> cameras = hil::listCameras(hil::kernelVideoCalls());
  const auto found = std::ranges::find(cameras, kLoop, &hil::CameraListing::path);
  ASSERT_NE(found, cameras.end());
  EXPECT_EQ(found->driver, "v4l2 loopback");
  EXPECT_TRUE(found->captures);
  ASSERT_FALSE(found->formats.empty());
  EXPECT_EQ(found->formats.front().fourcc, "GREY");
  EXPECT_TRUE(found->formats.front().is_readable);
}

TEST_F(LoopTest, FramesComeInSequenceAndToTheByte) {
  const Taken taken = record(60, exposures(1, 61, kPeriod_ns));
  EXPECT_THAT(taken.incidents(), IsEmpty());
  EXPECT_EQ(taken.report.ended_early, "");
  EXPECT_EQ(taken.report.good, 60U);
  ASSERT_EQ(taken.frames.size(), 60U);
  expectNumbered(taken.frames, 2);  // The first is discarded.
  for (std::size_t i = 1; i < taken.frames.size(); ++i)
    EXPECT_NEAR(taken.frames[i].start_s - taken.frames[i - 1].start_s, 1.0 / kRate_hz, 1e-3) << i;
}

TEST_F(LoopTest, ACameraThatStopsEndsTheCapture) {
  const Taken taken = record(60, exposures(1, 20, kPeriod_ns));
  EXPECT_THAT(taken.report.ended_early, HasSubstr("no frame within 500 ms"));
  EXPECT_EQ(taken.report.good, 19U);
  expectNumbered(taken.frames, 2);
}

TEST_F(LoopTest, APictureThatComesTwiceIsLeftOut) {
  std::vector<Exposure> script = exposures(1, 31, kPeriod_ns);
  script[15].number = script[14].number;
  const Taken taken = record(30, script);
  EXPECT_THAT(taken.incidents(), testing::ElementsAre("its picture is the one before, to the byte"));
  EXPECT_EQ(taken.report.good, 29U);
  expectNumbered(taken.frames, 2);
}

TEST_F(LoopTest, FramesThatWereOverwrittenBeforeTheyWereReadAreMissed) {
  Reader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(12));
  std::jthread camera([&] { writer.run(exposures(1, 40, kPeriod_ns)); });
  std::vector<Frame> frames = reader.take(4);
  sleepUntil_ns(now_ns() + 20 * kPeriod_ns);  // Nobody reads.
  const Taken taken = reader.takeAll();
  frames.insert(frames.end(), taken.frames.begin(), taken.frames.end());
  EXPECT_EQ(taken.report.ended_early, "");
  EXPECT_GE(taken.report.lost, 18U);
  EXPECT_THAT(taken.incidents(), testing::ElementsAre(HasSubstr("frames were lost")));
  expectNumbered(frames, 2);
}

TEST_F(LoopTest, AFrameThatTheCameraNeverNumberedIsMissedByItsTime) {
  std::vector<Exposure> script = exposures(1, 31, kPeriod_ns);
  for (Exposure& exposure : std::span(script).subspan(15)) exposure.at_ns += kPeriod_ns;
  const Taken taken = record(30, script);
  EXPECT_THAT(taken.incidents(),
              testing::ElementsAre("frames are missing before it that the sequence does not show"));
  EXPECT_EQ(taken.report.good, 29U);
}

TEST_F(LoopTest, FramesOfAnotherSizeAreLeftOut) {
  Reader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(7));
  std::jthread camera([&] {
    for (std::uint32_t number = 1; number <= 8; ++number) {
      sleepUntil_ns(now_ns() + kPeriod_ns);
      const int height_px = number == 4 ? kHeight_px / 2 : number == 6 ? 2 * kHeight_px : kHeight_px;
      writer.write(numberedImage(kWidth_px, height_px, number));
    }
  });
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.incidents(),
              testing::ElementsAre("it has too few or too many bytes", "it has too few or too many bytes"));
  EXPECT_EQ(taken.report.good, 5U);
  expectNumbered(taken.frames, 2);
}

TEST(LoopWithoutWriter, IsToldInWords) {
  try {
    hil::V4l2Stream(hil::kernelVideoCalls(), "/dev/video21", grey(kWidth_px, kHeight_px));
    ADD_FAILURE() << "a loop without a writer streams";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("/dev/video21: format: Device or resource busy"));
  }
}

TEST(NoCamera, IsSaidInWords) {
  EXPECT_THROW(hil::V4l2Stream(hil::kernelVideoCalls(), "/dev/video99", grey(160, 120)), std::system_error);
}

class VividTest : public testing::Test {
 protected:
  static hil::V4l2FrameOptions optionsFor(std::uint64_t frames) {
    hil::V4l2FrameOptions options;
    options.exposure_s = 1e-3;
    options.frames = frames;
    options.timeout_ms = 500;
    options.watch.sensor_has_noise = false;  // A test pattern.
    return options;
  }
  /// Sets a control while another reads, as anybody may.
  static void control(const std::string& key, std::int32_t value = 1) {
    const std::vector<hil::CameraListing> cameras = hil::listCameras(hil::kernelVideoCalls());
    const auto camera = std::ranges::find(cameras, kVivid, &hil::CameraListing::path);
    ASSERT_NE(camera, cameras.end());
    const auto found = std::ranges::find(camera->controls, key, &hil::ControlListing::key);
    ASSERT_NE(found, camera->controls.end()) << key << " is none of\n" << hil::describe(*camera);
    hil::VideoDevice device(hil::kernelVideoCalls(), kVivid);
    v4l2_control wanted{found->id, value};
    device.require(VIDIOC_S_CTRL, &wanted, key.c_str());
  }
  static hil::CameraSettings webcam() {
    hil::CameraSettings settings = grey(320, 180);
    settings.frame_rate_hz = 25.0;
    return settings;
  }
  /// 0: a webcam, 1: HDMI (init.sh).
  static void selectInput(int input) {
    hil::VideoDevice(hil::kernelVideoCalls(), kVivid).require(VIDIOC_S_INPUT, &input, "VIDIOC_S_INPUT");
  }
  hil::CameraSettings settings = webcam();
};

TEST_F(VividTest, StreamsWithoutAnIncident) {
  Reader reader(kVivid, settings, optionsFor(25));
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.incidents(), IsEmpty());
  EXPECT_EQ(taken.report.ended_early, "");
  EXPECT_EQ(taken.report.good, 25U);
  EXPECT_EQ(taken.report.clock, hil::StampClock::kMonotonic);
}

TEST_F(VividTest, AFrameThatTheDriverMarksIsLeftOut) {
  Reader reader(kVivid, settings, optionsFor(20));
  const std::size_t before = reader.take(5).size();
  control("inject_v4l2_buf_flag_error");
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.incidents(), testing::ElementsAre("the driver marks it as damaged"));
  EXPECT_EQ(before + taken.frames.size(), 19U);
}

TEST_F(VividTest, FramesThatTheDriverDropsAreMissed) {
  control("percentage_of_dropped_buffers", 30);
  Reader reader(kVivid, settings, optionsFor(40));
  const Taken taken = reader.takeAll();
  control("percentage_of_dropped_buffers", 0);
  EXPECT_GT(taken.report.lost, 0U);
  EXPECT_THAT(taken.incidents(), Contains(HasSubstr("frames were lost")));
}

TEST_F(VividTest, ADriverThatFailsWhileItStreamsEndsTheCapture) {
  Reader reader(kVivid, settings, optionsFor(20));
  reader.take(5);
  control("inject_fatal_streaming_error");
  const Taken taken = reader.takeAll();
  EXPECT_NE(taken.report.ended_early, "");
  EXPECT_LT(taken.report.taken, 20U);
}

TEST_F(VividTest, ADriverThatRefusesBuffersOrStreamingIsToldByCall) {
  for (const auto& [key, call] : {std::pair{"inject_vidioc_reqbufs_error", "VIDIOC_REQBUFS"},
                                  std::pair{"inject_vidioc_qbuf_error", "VIDIOC_QBUF"},
                                  std::pair{"inject_vidioc_streamon_error", "VIDIOC_STREAMON"}}) {
    control(key);
    try {
      hil::V4l2Stream(hil::kernelVideoCalls(), kVivid, settings);
      ADD_FAILURE() << key;
    } catch (const std::system_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(kVivid + ": " + call));
    }
    // And nothing is left behind that keeps the next one from it.
    EXPECT_EQ(Reader(kVivid, settings, optionsFor(3)).takeAll().report.good, 3U) << key;
  }
}

TEST_F(VividTest, NumbersThatWrapAreNoGap) {
  control("wrap_sequence_number");
  Reader reader(kVivid, settings, optionsFor(150));
  const Taken taken = reader.takeAll();
  control("wrap_sequence_number", 0);
  EXPECT_THAT(taken.incidents(), IsEmpty());
  ASSERT_EQ(taken.report.good, 150U);
  EXPECT_EQ(taken.frames.back().sequence, 149U);
}

TEST_F(VividTest, ASourceThatChangesEndsTheCapture) {
  selectInput(1);
  {
    hil::VideoDevice device(hil::kernelVideoCalls(), kVivid);
    v4l2_dv_timings timings = V4L2_DV_BT_DMT_640X480P60;
    device.require(VIDIOC_S_DV_TIMINGS, &timings, "VIDIOC_S_DV_TIMINGS");
    Reader reader(kVivid, grey(640, 480), optionsFor(20));
    reader.take(5);
    control("dv_timings_signal_mode");  // No signal.
    const Taken taken = reader.takeAll();
    EXPECT_THAT(taken.report.ended_early, HasSubstr("the source changed its size while it streamed"));
    EXPECT_LT(taken.report.taken, 20U);
    control("dv_timings_signal_mode", 0);
  }
  selectInput(0);
}

TEST_F(VividTest, ASizeThatItHasNotIsRefusedWithWhatItWouldGive) {
  try {
    hil::V4l2Stream(hil::kernelVideoCalls(), kVivid, grey(321, 181));
    ADD_FAILURE() << "a size became another without a word";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("size: 321 x 181 became 320 x 180"));
  }
}

// The last: it does not come back.
TEST_F(VividTest, ACameraThatIsPulledOutEndsTheCapture) {
  Reader reader(kVivid, settings, optionsFor(20));
  reader.take(5);
  control("disconnect");
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.report.ended_early, HasSubstr("the camera has vanished"));
}

}  // namespace
}  // namespace kerfbench::guest
