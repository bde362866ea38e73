// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/live/record_frames.h"
#include "hil/live/spot_recorder.h"
#include "hil/run/release.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/camera/v4l2/fake_video.h"

namespace kerfbench::live {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

class RecordFramesTest : public testing::Test {
 protected:
  RecordFramesTest() {
    (void)temp_.write("linecutter-avr.hex", ":00000001FF\n");
    video.sizes = {{800, 400}};
    video.interval = {1, 400};
    video.addControl(V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 0, 3, V4L2_EXPOSURE_MANUAL);
    video.addControl(V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 10'000, 50);
    options.scenario =
        temp_.write("s.yaml", "extends: " + base::fixture("scenarios/native/label-camera.yaml").string() +
                                  "\nname: filmed\ncameras: {spot: {triggered: true}}\n");
    options.out = temp_.path() / "spot";
    options.quiet = true;
    options.bin_dir = KERFBENCH_BINARY_DIR "/bin";
    options.time_limit_s = 2.0;
    options.wait_s = 5.0;
  }
  /// Selects the camera of another scenario: one that runs by itself.
  void runFreely() { options.scenario = base::fixture("scenarios/native/label-camera.yaml"); }
  /// Adds pictures that arrive at these times from now.
  void picturesAfter(const std::vector<std::int64_t>& times_ms) {
    std::uint32_t sequence = 0;
    for (const std::int64_t time_ms : times_ms) {
      camera::FakeFrame frame;
      frame.bytes.assign(std::size_t{800} * 400, static_cast<std::uint8_t>(sequence));
      frame.sequence = sequence++;
      frame.stamp_ns = frame.arrival_ns = video.now_ns + time_ms * kMs;
      video.frames.push_back(std::move(frame));
    }
  }
  int record() { return recordFramesOf(video, options); }
  std::string refusal() {
    try {
      record();
    } catch (const base::InputError& e) {
      return e.what();
    }
    return "no fault";
  }
  std::size_t recorded() const { return camera::FrameRecording(options.out).frames(); }

  const base::TempFolder temp_;
  camera::FakeVideo video;
  RecordFramesOptions options;
};

// The first buffer of a free-running loopback may be old; with a trigger it is the first of the job.
TEST_F(RecordFramesTest, TheFirstPictureOfATriggerIsKept) {
  picturesAfter({100, 103, 106});
  EXPECT_EQ(record(), 0);
  EXPECT_EQ(recorded(), 3U);
}

TEST_F(RecordFramesTest, TheFirstPictureOfACameraThatRunsByItselfIsNot) {
  runFreely();
  picturesAfter({100, 103, 106});
  EXPECT_EQ(record(), 0);
  EXPECT_EQ(recorded(), 2U);
}

TEST_F(RecordFramesTest, ASinglePictureIsARecording) {
  picturesAfter({100});
  EXPECT_EQ(record(), 0);
  EXPECT_EQ(recorded(), 1U);
}

TEST_F(RecordFramesTest, NoPictureIsNone) {
  EXPECT_EQ(record(), 3);
  EXPECT_EQ(recorded(), 0U);
}

TEST_F(RecordFramesTest, OnePictureOfACameraThatRunsByItselfIsNone) {
  runFreely();
  picturesAfter({100});
  EXPECT_EQ(record(), 3);
}

TEST_F(RecordFramesTest, FewerPicturesThanAskedForAreTold) {
  options.frames = 4;
  picturesAfter({100, 103, 106});
  EXPECT_EQ(record(), 3);
  EXPECT_EQ(recorded(), 3U);
}

TEST_F(RecordFramesTest, TheTimeBeginsWithTheFirstPicture) {
  picturesAfter({4'000, 4'500, 5'900, 6'500});
  EXPECT_EQ(record(), 0);
  EXPECT_EQ(recorded(), 3U);
}

TEST_F(RecordFramesTest, AFolderThatHoldsAnythingIsRefusedBeforeTheCameraStreams) {
  std::filesystem::create_directories(options.out);
  std::ofstream(options.out / "thesis.tex") << "years";
  EXPECT_THAT(refusal(), HasSubstr("spot: is not empty; a recording needs a folder of its own"));
  options.out /= "thesis.tex";
  EXPECT_THAT(refusal(), HasSubstr("thesis.tex: is no folder, and the recording needs one"));
  EXPECT_EQ(video.count(VIDIOC_STREAMON), 0);
  options.out = temp_.path() / "empty";
  std::filesystem::create_directories(options.out);
  picturesAfter({100});
  EXPECT_EQ(record(), 0);
}

}  // namespace
}  // namespace kerfbench::live
