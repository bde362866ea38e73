// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/device_list.h"

#include <cerrno>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_video.h"

namespace kerfbench::camera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

CameraListing onlyOne(FakeVideo& video) {
  const auto cameras = listCameras(video);
  EXPECT_EQ(cameras.size(), 1U);
  return cameras.at(0);
}

TEST(DeviceList, TellsAllThatACameraOffers) {
  FakeVideo video;
  video.fourccs = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12};
  video.sizes = {{64, 48}, {128, 96}};
  video.addControl(V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 5000, 157);
  video.addControl(V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 0, 3, 2, 0, V4L2_CTRL_TYPE_MENU);
  video.addControl(V4L2_CID_GAIN, "Gain", 0, 100, 7, V4L2_CTRL_FLAG_INACTIVE);
  video.addControl(V4L2_CID_USER_CLASS, "User Controls", 0, 0, 0, V4L2_CTRL_FLAG_READ_ONLY,
                   V4L2_CTRL_TYPE_CTRL_CLASS);
  const CameraListing camera = onlyOne(video);
  EXPECT_EQ(camera.card, "Fake camera");
  EXPECT_EQ(camera.driver, "fake");
  EXPECT_EQ(camera.bus, "memory:7");
  EXPECT_TRUE(camera.captures);
  EXPECT_EQ(camera.problem, "");
  ASSERT_EQ(camera.formats.size(), 3U);
  EXPECT_EQ(camera.formats[0].fourcc, "GREY");
  EXPECT_TRUE(camera.formats[1].is_readable);
  EXPECT_FALSE(camera.formats[2].is_readable);
  ASSERT_EQ(camera.formats[0].sizes.size(), 2U);
  EXPECT_EQ(camera.formats[0].sizes[1].max_width_px, 128);
  EXPECT_EQ(camera.formats[0].sizes[1].intervals.at(0).longest_s, 0.01);
  ASSERT_EQ(camera.controls.size(), 3U);
  EXPECT_EQ(camera.controls[0].key, "gain");
  EXPECT_TRUE(camera.controls[0].is_locked);
  EXPECT_THAT(camera.controls[1].menu, ElementsAre("0: choice", "2: choice"));
  EXPECT_EQ(camera.controls[2].key, "exposure_time_absolute");
  EXPECT_EQ(camera.controls[2].value, 157);
  EXPECT_EQ(video.count(VIDIOC_S_FMT) + video.count(VIDIOC_S_CTRL) + video.count(VIDIOC_S_PARM), 0);
}

TEST(DeviceList, IsWrittenInLinesForPeople) {
  FakeVideo video;
  video.fourccs = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_NV12};
  video.addControl(V4L2_CID_GAIN, "Gain", 0, 100, 7, V4L2_CTRL_FLAG_READ_ONLY);
  const std::string text = describe(onlyOne(video));
  for (const char* part :
       {"/dev/video7: Fake camera (driver fake, memory:7)", "GREY (format 0)\n    64 x 48 at 100 frames/s",
        "lossy", "NV12 (format 2): cannot be read", "gain [0 ... 100, step 1, default 7] = 7, locked"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(DeviceList, TellsRangesOfSizesAndRates) {
  FakeVideo video;
  video.has_stepwise_sizes = true;
  EXPECT_THAT(describe(onlyOne(video)),
              HasSubstr("16 x 16 ... 640 x 480 in steps of 8 x 4 at 5 ... 200 frames/s"));
}

TEST(DeviceList, SaysWhyADeviceCannotBeOpened) {
  const auto problem = [](int error) {
    FakeVideo video;
    video.open_error = error;
    return describe(onlyOne(video));
  };
  EXPECT_THAT(problem(EACCES), HasSubstr("/dev/video7: no permission: add the user to the group"));
  EXPECT_THAT(problem(EPERM), HasSubstr("no permission"));
  EXPECT_THAT(problem(EBUSY), HasSubstr("another program"));
  EXPECT_THAT(problem(ENODEV), HasSubstr("has gone"));
  EXPECT_THAT(problem(EMFILE), HasSubstr("open"));
}

TEST(DeviceList, SaysThatANodeIsNoVideoDevice) {
  FakeVideo video;
  video.failIoctl(VIDIOC_QUERYCAP, ENOTTY);
  EXPECT_THAT(onlyOne(video).problem, HasSubstr("VIDIOC_QUERYCAP"));
}

TEST(DeviceList, SaysThatANodeGivesNoPictures) {
  FakeVideo video;
  video.caps = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;  // The second node of a UVC camera.
  const CameraListing camera = onlyOne(video);
  EXPECT_FALSE(camera.captures);
  EXPECT_THAT(camera.formats, IsEmpty());
  EXPECT_THAT(describe(camera), HasSubstr("no pictures by streaming"));
}

TEST(DeviceList, BelievesTheOldCapabilitiesOfADriverThatHasNoOthers) {
  FakeVideo video;
  video.is_capability_per_device = false;
  EXPECT_TRUE(onlyOne(video).captures);
}

TEST(DeviceList, TakesWhatADeviceRefusesAsNotThere) {
  for (const unsigned long request : {VIDIOC_ENUM_FMT, VIDIOC_ENUM_FRAMESIZES, VIDIOC_ENUM_FRAMEINTERVALS,
                                      VIDIOC_QUERYCTRL, VIDIOC_QUERYMENU, VIDIOC_G_CTRL}) {
    FakeVideo video;
    video.addControl(V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 0, 3, 2, 0, V4L2_CTRL_TYPE_MENU);
    video.failIoctl(request, ENOTTY);
    const CameraListing camera = onlyOne(video);
    EXPECT_TRUE(camera.captures);
    EXPECT_EQ(camera.problem, "");
    EXPECT_FALSE(describe(camera).empty());
  }
}

TEST(DeviceList, OfTheKernelThrowsNothingWhateverThisMachineHas) {
  for (const CameraListing& camera : listCameras(kernelVideoCalls()))
    EXPECT_THAT(describe(camera), HasSubstr(camera.path));
}

}  // namespace
}  // namespace kerfbench::camera
