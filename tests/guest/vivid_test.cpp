// SPDX-License-Identifier: Apache-2.0
// The bench's reader of cameras on a camera of the kernel's own that fails on demand (vivid).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "hil/camera/v4l2/device_list.h"
#include "hil/camera/v4l2/video_device.h"
#include "tests/guest/camera_reader.h"
#include "twin/base/image.h"

namespace kerfbench::guest {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kVivid = "/dev/video30";  // Device as init.sh numbers it.

class VividTest : public testing::Test {
 protected:
  /// Options for a test pattern, which repeats.
  static camera::V4l2FrameOptions noiseless(std::uint64_t frames) {
    camera::V4l2FrameOptions options = optionsFor(frames);
    options.watch.sensor_has_noise = false;
    return options;
  }
  /// Sets a control while another program reads, as any program may.
  static void control(const std::string& key, std::int32_t value = 1) {
    const std::vector<camera::CameraListing> cameras = camera::listCameras(camera::kernelVideoCalls());
    const auto camera = std::ranges::find(cameras, kVivid, &camera::CameraListing::path);
    ASSERT_NE(camera, cameras.end());
    const auto found = std::ranges::find(camera->controls, key, &camera::ControlListing::key);
    ASSERT_NE(found, camera->controls.end()) << key << " is none of\n" << camera::describe(*camera);
    camera::VideoDevice device(camera::kernelVideoCalls(), kVivid);
    v4l2_control wanted{found->id, value};
    device.require(VIDIOC_S_CTRL, &wanted, key.c_str());
  }
  static camera::CameraSettings webcam() {
    camera::CameraSettings settings = grey(320, 180);
    settings.frame_rate_hz = 25.0;
    return settings;
  }
  /// Selects the input; 0: a webcam, 1: HDMI (init.sh).
  static void selectInput(int input) {
    camera::VideoDevice(camera::kernelVideoCalls(), kVivid).require(VIDIOC_S_INPUT, &input, "VIDIOC_S_INPUT");
  }
  /// Timings of 640 × 480 at 59.94 Hz, VESA DMT 04h; the kernel's V4L2_DV_BT_DMT_640X480P60 is C only.
  static v4l2_dv_timings vga60() {
    v4l2_dv_timings timings{};
    timings.type = V4L2_DV_BT_656_1120;
    timings.bt.width = 640;
    timings.bt.height = 480;
    timings.bt.pixelclock = 25'175'000;
    timings.bt.hfrontporch = 16;
    timings.bt.hsync = 96;
    timings.bt.hbackporch = 48;
    timings.bt.vfrontporch = 10;
    timings.bt.vsync = 2;
    timings.bt.vbackporch = 33;
    timings.bt.standards = V4L2_DV_BT_STD_DMT | V4L2_DV_BT_STD_CEA861;
    return timings;
  }
  camera::CameraSettings settings = webcam();
};

TEST_F(VividTest, StreamsWithoutAnIncident) {
  CameraReader reader(kVivid, settings, noiseless(25));
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.incidents(), IsEmpty());
  EXPECT_EQ(taken.report.ended_early, "");
  EXPECT_EQ(taken.report.good, 25U);
  EXPECT_EQ(taken.report.clock, camera::StampClock::kMonotonic);
}

TEST_F(VividTest, AFrameThatTheDriverMarksIsLeftOut) {
  CameraReader reader(kVivid, settings, noiseless(20));
  const std::size_t before = reader.take(5).size();
  control("inject_v4l2_buf_flag_error");
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.incidents(), testing::ElementsAre("the driver marks it as damaged"));
  EXPECT_EQ(before + taken.frames.size(), 19U);
}

TEST_F(VividTest, FramesThatTheDriverDropsAreMissed) {
  control("percentage_of_dropped_buffers", 30);
  CameraReader reader(kVivid, settings, noiseless(40));
  const Taken taken = reader.takeAll();
  control("percentage_of_dropped_buffers", 0);
  EXPECT_GT(taken.report.lost, 0U);
  EXPECT_THAT(taken.incidents(), Contains(HasSubstr("frames were lost")));
}

TEST_F(VividTest, ADriverThatFailsWhileItStreamsEndsTheCapture) {
  CameraReader reader(kVivid, settings, noiseless(20));
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
      camera::V4l2Stream(camera::kernelVideoCalls(), kVivid, settings);
      ADD_FAILURE() << key;
    } catch (const std::system_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(kVivid + ": " + call));
    }
    // The source leaves nothing behind that keeps the next one from reading.
    EXPECT_EQ(CameraReader(kVivid, settings, noiseless(3)).takeAll().report.good, 3U) << key;
  }
}

TEST_F(VividTest, NumbersThatWrapAreNoGap) {
  control("wrap_sequence_number");
  CameraReader reader(kVivid, settings, noiseless(150));
  const Taken taken = reader.takeAll();
  control("wrap_sequence_number", 0);
  EXPECT_THAT(taken.incidents(), IsEmpty());
  ASSERT_EQ(taken.report.good, 150U);
  EXPECT_EQ(taken.frames.back().sequence, 149U);
}

TEST_F(VividTest, AWindowShowsWhatTheWholePictureShowsThere) {
  selectInput(1);
  {
    camera::VideoDevice device(camera::kernelVideoCalls(), kVivid);
    v4l2_dv_timings timings = vga60();
    device.require(VIDIOC_S_DV_TIMINGS, &timings, "VIDIOC_S_DV_TIMINGS");
  }
  const Taken whole = CameraReader(kVivid, grey(640, 480), noiseless(3)).takeAll();
  camera::CameraSettings windowed = grey(640, 480);
  windowed.window = PixelWindow{288, 40, 192, 400};
  const Taken part = CameraReader(kVivid, windowed, noiseless(3)).takeAll();
  ASSERT_FALSE(whole.frames.empty());
  ASSERT_FALSE(part.frames.empty());
  const GrayImage& all = whole.frames.back().image;
  const GrayImage& window = part.frames.back().image;
  ASSERT_EQ(window.window(), *windowed.window);
  std::size_t different = 0;
  constexpr int kText = 200;  // Rows at the top of each picture that the driver writes into.
  for (int r = window.top + kText; r <= window.bottom(); ++r) {
    for (int c = window.left; c <= window.right(); ++c) different += window.at(c, r) != all.at(c, r) ? 1 : 0;
  }
  EXPECT_EQ(different, 0U);
  // The next program finds the whole sensor again.
  const Taken after = CameraReader(kVivid, grey(640, 480), noiseless(3)).takeAll();
  ASSERT_FALSE(after.frames.empty());
  EXPECT_EQ(after.frames.back().image.window(), all.window());
  selectInput(0);
}

TEST_F(VividTest, ASourceThatChangesEndsTheCapture) {
  selectInput(1);
  {
    camera::VideoDevice device(camera::kernelVideoCalls(), kVivid);
    v4l2_dv_timings timings = vga60();
    device.require(VIDIOC_S_DV_TIMINGS, &timings, "VIDIOC_S_DV_TIMINGS");
    CameraReader reader(kVivid, grey(640, 480), noiseless(20));
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
    camera::V4l2Stream(camera::kernelVideoCalls(), kVivid, grey(321, 181));
    ADD_FAILURE() << "a size became another without a word";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("size: 321 x 181 became 320 x 180"));
  }
}

// This test is the last: the camera does not come back.
TEST_F(VividTest, ACameraThatIsPulledOutEndsTheCapture) {
  CameraReader reader(kVivid, settings, noiseless(20));
  reader.take(5);
  control("disconnect");
  const Taken taken = reader.takeAll();
  EXPECT_THAT(taken.report.ended_early, HasSubstr("the camera has vanished"));
}

}  // namespace
}  // namespace kerfbench::guest
