// SPDX-License-Identifier: Apache-2.0
// The bench's reader of cameras on the kernel's real V4L2: a loop that the test writes into (v4l2loopback).
// Time is the guest's: a count of instructions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "hil/camera/v4l2/device_list.h"
#include "tests/guest/camera_reader.h"
#include "tests/guest/loop_camera.h"
#include "tests/guest/player.h"
#include "twin/base/image.h"

namespace kerfbench::guest {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth_px = 160;
constexpr int kHeight_px = 120;
constexpr std::uint32_t kRate_hz = 30;
constexpr std::uint64_t kPeriod_ns = 1'000'000'000 / kRate_hz;
const std::string kLoop = "/dev/video20";  // Device as init.sh numbers it.

class LoopTest : public testing::Test {
 protected:
  /// Records with a reader of `frames` frames, and a camera that starts when the reader streams.
  Taken record(std::uint64_t frames, const std::vector<Exposure>& script) {
    CameraReader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(frames));
    std::jthread camera([&] { writer.run(script); });
    return reader.takeAll();
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
  const std::vector<camera::CameraListing> cameras = camera::listCameras(camera::kernelVideoCalls());
  const auto found = std::ranges::find(cameras, kLoop, &camera::CameraListing::path);
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
  expectNumbered(taken.frames, 2);  // The first picture is discarded.
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
  CameraReader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(12));
  std::jthread camera([&] { writer.run(exposures(1, 40, kPeriod_ns)); });
  std::vector<Frame> frames = reader.take(4);
  sleepUntil_ns(now_ns() + 20 * kPeriod_ns);  // The frames have no reader meanwhile.
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
  CameraReader reader(kLoop, grey(kWidth_px, kHeight_px), optionsFor(7));
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
    camera::V4l2Stream(camera::kernelVideoCalls(), "/dev/video21", grey(kWidth_px, kHeight_px));
    ADD_FAILURE() << "a loop without a writer streams";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("/dev/video21: format: Device or resource busy"),
                                    HasSubstr("nobody writes into a loopback yet")));
  }
}

TEST(NoCamera, IsSaidInWords) {
  EXPECT_THROW(camera::V4l2Stream(camera::kernelVideoCalls(), "/dev/video99", grey(160, 120)),
               std::system_error);
}

}  // namespace
}  // namespace kerfbench::guest
