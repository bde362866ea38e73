// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/camera_settings.h"

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_video.h"

namespace kerfbench::camera {
namespace {

using testing::HasSubstr;

CameraSettings greySettings() { return {.format = findPixelFormat("GREY"), .width_px = 64, .height_px = 48}; }

CameraSetup setUp(FakeVideo& video, const CameraSettings& settings) {
  VideoDevice device(video, "/dev/video7");
  return setUpCamera(device, settings);
}

std::string whyNot(FakeVideo& video, const CameraSettings& settings) {
  try {
    (void)setUp(video, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "it is set";
}

/// A camera with the usual controls, all automatic.
void addControls(FakeVideo& video) {
  video.addControl(V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 0, 3, 3, 0, V4L2_CTRL_TYPE_MENU);
  video.addControl(V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 5000, 157);
  video.addControl(V4L2_CID_AUTOGAIN, "Gain, Automatic", 0, 1, 1);
  video.addControl(V4L2_CID_GAIN, "Gain", 0, 100, 7);
  video.addControl(V4L2_CID_LASTP1 + 0x1000, "Trigger Mode", 0, 1, 0);
}

TEST(CameraSettings, SetsAllAndTellsWhatCameOfIt) {
  FakeVideo video;
  addControls(video);
  CameraSettings settings = greySettings();
  settings.exposure_s = 0.00523;
  settings.frame_rate_hz = 59.94;
  settings.gain = 12;
  settings.controls = {{"trigger_mode", 1}};
  const CameraSetup setup = setUp(video, settings);
  EXPECT_EQ(setup.layout.width_px, 64);
  EXPECT_EQ(setup.layout.bits, 8);
  EXPECT_EQ(setup.layout.stride_bytes, 64U);
  ASSERT_EQ(setup.outcomes.size(), 4U);
  EXPECT_EQ(setup.outcomes[0].setting, "frame_rate_hz");
  EXPECT_NEAR(setup.outcomes[0].got, 59.94, 1e-9);
  EXPECT_EQ(setup.outcomes[1].setting, "exposure_s");
  EXPECT_EQ(setup.outcomes[1].wanted, 0.00523);
  EXPECT_NEAR(setup.outcomes[1].got, 0.0052, 1e-12);
  EXPECT_NEAR(setup.exposure_s.value(), 0.0052, 1e-12);
  EXPECT_EQ(setup.outcomes[2].got, 12.0);
  EXPECT_EQ(setup.outcomes[3].setting, "trigger_mode");
  EXPECT_NEAR(setup.frame_period_s.value(), 1.0 / 59.94, 1e-9);
  EXPECT_EQ(video.values[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(video.values[V4L2_CID_AUTOGAIN], 0);
}

CameraSettings windowSettings() {
  CameraSettings settings = greySettings();
  settings.window = PixelWindow{8, 12, 32, 20};
  return settings;
}

TEST(CameraSettings, AWindowIsReadOutAndFramesHaveItsSize) {
  FakeVideo video;
  video.sensor = v4l2_rect{0, 0, 64, 48};
  const CameraSetup setup = setUp(video, windowSettings());
  EXPECT_EQ(video.window->left, 8);
  EXPECT_EQ(video.window->top, 12);
  EXPECT_EQ(video.window->width, 32U);
  EXPECT_EQ(video.window->height, 20U);
  EXPECT_EQ(setup.layout.width_px, 32);
  EXPECT_EQ(setup.layout.height_px, 20);
  EXPECT_EQ(setup.layout.left_px, 8);
  EXPECT_EQ(setup.layout.top_px, 12);
}

TEST(CameraSettings, AWindowThatAnotherProgramLeftIsTakenAway) {
  FakeVideo video;
  video.sensor = v4l2_rect{0, 0, 64, 48};
  video.window = v4l2_rect{10, 10, 20, 20};
  const CameraSetup setup = setUp(video, greySettings());
  EXPECT_EQ(video.window->width, 64U);
  EXPECT_EQ(video.window->left, 0);
  EXPECT_EQ(setup.layout.left_px, 0);
  EXPECT_EQ(setup.layout.width_px, 64);
}

TEST(CameraSettings, ASensorThatIsLargerThanThePictureMayStillBeScaled) {
  FakeVideo video;
  video.sensor = v4l2_rect{8, 8, 128, 96};
  video.window = v4l2_rect{10, 10, 20, 20};
  const CameraSetup setup = setUp(video, greySettings());
  EXPECT_EQ(video.window->left, 8);
  EXPECT_EQ(video.window->width, 128U);
  EXPECT_EQ(setup.layout.left_px, 0);
  EXPECT_EQ(setup.layout.width_px, 64);
}

TEST(CameraSettings, AWindowThatCannotBeIsRefused) {
  FakeVideo video;
  EXPECT_THAT(whyNot(video, windowSettings()), HasSubstr("window: the camera reads whole pictures alone"));
  video.sensor = v4l2_rect{0, 0, 128, 96};
  EXPECT_THAT(whyNot(video, windowSettings()),
              HasSubstr("window: the sensor has 128 x 96 at (0, 0), the machine file's picture 64 x 48"));
  video.sensor = v4l2_rect{0, 0, 64, 48};
  video.window_step = 8;
  EXPECT_THAT(whyNot(video, windowSettings()),
              HasSubstr("window: 32 x 20 at (8, 12) became 32 x 20 at (8, 8)"));
  CameraSettings beyond = windowSettings();
  beyond.window->left = 40;
  EXPECT_THAT(whyNot(video, beyond), HasSubstr("window: 32 x 20 at (40, 12) is no part of 64 x 48"));
  video.window_step = 1;
  video.failIoctl(VIDIOC_S_SELECTION, EBUSY);
  EXPECT_THAT(whyNot(video, windowSettings()), HasSubstr("window: Device or resource busy"));
}

TEST(CameraSettings, TellsAValueThatTheDriverMadeAnother) {
  FakeVideo video;
  addControls(video);
  video.value_step = 10;
  CameraSettings settings = greySettings();
  settings.gain = 37;
  const CameraSetup setup = setUp(video, settings);
  EXPECT_EQ(setup.outcomes.at(0).wanted, 37.0);
  EXPECT_EQ(setup.outcomes.at(0).got, 30.0);
}

TEST(CameraSettings, ListsEverythingThatACameraHasNot) {
  FakeVideo video;
  video.can_set_interval = 0;
  CameraSettings settings = greySettings();
  settings.exposure_s = 0.001;
  settings.frame_rate_hz = 30.0;
  settings.gain = 12;
  settings.controls = {{"trigger_mode", 1}};
  const std::string why = whyNot(video, settings);
  for (const char* part :
       {"/dev/video7: ", "frame_rate_hz: the driver cannot set it", "exposure_s: the camera has no",
        "gain: the camera has no", "trigger_mode: the camera has no"})
    EXPECT_THAT(why, HasSubstr(part));
}

TEST(CameraSettings, RefusesValuesOutOfRangeAndControlsThatAreLocked) {
  FakeVideo video;
  addControls(video);
  video.addControl(V4L2_CID_BRIGHTNESS, "Brightness", 0, 9, 5, V4L2_CTRL_FLAG_READ_ONLY);
  video.addControl(V4L2_CID_CONTRAST, "Contrast", 0, 9, 5, V4L2_CTRL_FLAG_DISABLED);
  CameraSettings settings = greySettings();
  settings.exposure_s = 20e-6;  // The exposure is less than half of V4L2's unit.
  settings.gain = 101;
  settings.controls = {{"brightness", 3}, {"contrast", 3}};
  const std::string why = whyNot(video, settings);
  for (const char* part : {"0 (in 100 us) is not in 1 ... 5000", "101 is not in 0 ... 100",
                           "brightness: is read-only", "contrast: the camera has no such control"})
    EXPECT_THAT(why, HasSubstr(part));
}

TEST(CameraSettings, RefusesNumbersThatAreNoExposureAndNoRate) {
  FakeVideo video;
  addControls(video);
  CameraSettings settings = greySettings();
  for (const double bad : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    settings.exposure_s = bad;
    settings.frame_rate_hz = bad;
    const std::string why = whyNot(video, settings);
    EXPECT_THAT(why, HasSubstr("exposure_s: must be")) << bad;
    EXPECT_THAT(why, HasSubstr("frame_rate_hz: must be")) << bad;
  }
}

TEST(CameraSettings, RefusesAnotherFormatSizeOrInterlacing) {
  FakeVideo video;
  video.is_stubborn_format = true;
  CameraSettings settings = greySettings();
  settings.format = findPixelFormat("Y12");
  EXPECT_THAT(whyNot(video, settings), HasSubstr("format: Y12 became GREY"));
  settings = greySettings();
  settings.width_px = 100;
  EXPECT_THAT(whyNot(video, settings), HasSubstr("size: 100 x 48 became 64 x 48"));
  video.format.field = V4L2_FIELD_INTERLACED;
  EXPECT_THAT(whyNot(video, greySettings()), HasSubstr("interlaced"));
  video.format.field = V4L2_FIELD_NONE;
  video.format.bytesperline = 63;
  EXPECT_THAT(whyNot(video, greySettings()), HasSubstr("rows of 63 bytes"));
}

TEST(CameraSettings, RefusesOddSizesWherePixelsComeInPairs) {
  FakeVideo video;
  video.fourccs = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_SRGGB8};
  CameraSettings settings = greySettings();
  settings.width_px = 63;
  for (const char* name : {"YUYV", "SRGGB8"}) {
    settings.format = findPixelFormat(name);
    EXPECT_THAT(whyNot(video, settings), HasSubstr("needs an even one")) << name;
  }
}

TEST(CameraSettings, RefusesDepthsThatTheFormatHasNot) {
  FakeVideo video;
  video.fourccs = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y16};
  CameraSettings settings = greySettings();
  settings.bits = 10;
  EXPECT_THAT(whyNot(video, settings), HasSubstr("bits: GREY has 8"));
  settings.format = findPixelFormat("Y16");
  EXPECT_EQ(setUp(video, settings).layout.bits, 10);
  settings.bits = 7;
  EXPECT_THAT(whyNot(video, settings), HasSubstr("bits: Y16"));
}

TEST(CameraSettings, KnowTheRangeOfBrightness) {
  FakeVideo video;
  video.fourccs = {V4L2_PIX_FMT_YUYV};
  CameraSettings settings = greySettings();
  settings.format = findPixelFormat("YUYV");
  EXPECT_FALSE(setUp(video, settings).layout.full_range);
  video.format.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  EXPECT_TRUE(setUp(video, settings).layout.full_range);
}

TEST(CameraSettings, SayThatAnAutomaticStaysOn) {
  FakeVideo video;
  addControls(video);
  video.failIoctl(VIDIOC_S_CTRL, EBUSY);
  CameraSettings settings = greySettings();
  settings.exposure_s = 0.001;
  settings.gain = 3;
  const std::string why = whyNot(video, settings);
  EXPECT_THAT(why, HasSubstr("automatic exposure stays on"));
  EXPECT_THAT(why, HasSubstr("automatic gain stays on"));
  EXPECT_THAT(why, HasSubstr("gain: Device or resource busy"));
}

TEST(CameraSettings, TakeTheAnalogueGainWhereThereIsNoOther) {
  FakeVideo video;
  video.addControl(V4L2_CID_ANALOGUE_GAIN, "Analogue Gain", 0, 480, 0);
  CameraSettings settings = greySettings();
  settings.gain = 100;
  EXPECT_EQ(setUp(video, settings).outcomes.at(0).got, 100.0);
}

TEST(CameraSettings, SayWhichCallWasRefused) {
  FakeVideo video;
  video.failIoctl(VIDIOC_S_FMT, EBUSY);
  EXPECT_THAT(whyNot(video, greySettings()),
              HasSubstr("format: Device or resource busy (another program has it"));
  FakeVideo other;
  other.failIoctl(VIDIOC_S_PARM, EINVAL);
  CameraSettings settings = greySettings();
  settings.frame_rate_hz = 30.0;
  EXPECT_THAT(whyNot(other, settings), HasSubstr("frame_rate_hz: Invalid argument"));
  FakeVideo silent;
  silent.failIoctl(VIDIOC_G_PARM, EINVAL);
  EXPECT_THAT(whyNot(silent, settings), HasSubstr("does not say what it is"));
  EXPECT_FALSE(setUp(silent, greySettings()).frame_period_s);
}

TEST(CameraSettings, TellACameraThatVanishesMeanwhile) {
  CameraSettings settings = greySettings();
  settings.exposure_s = 0.001;
  settings.frame_rate_hz = 30.0;
  for (const unsigned long request :
       {VIDIOC_S_FMT, VIDIOC_G_FMT, VIDIOC_S_PARM, VIDIOC_QUERYCTRL, VIDIOC_S_CTRL}) {
    FakeVideo video;
    addControls(video);
    video.failIoctl(request, ENODEV);
    EXPECT_THROW((void)setUp(video, settings), std::system_error) << request;
  }
}

TEST(CameraSettings, AreRefusedWithoutFormatOrSize) {
  FakeVideo video;
  EXPECT_THAT(whyNot(video, {}), HasSubstr("format and size"));
}

TEST(ControlKeys, AreThoseOfV4l2Ctl) {
  EXPECT_EQ(controlKey("Exposure Time, Absolute"), "exposure_time_absolute");
  EXPECT_EQ(controlKey("  White Balance (Auto) "), "white_balance_auto");
  EXPECT_EQ(controlKey("Gain"), "gain");
  EXPECT_EQ(controlKey(""), "");
}

}  // namespace
}  // namespace kerfbench::camera
