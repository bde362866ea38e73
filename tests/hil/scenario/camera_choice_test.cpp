// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/camera_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CameraChoiceTest : public testing::Test {
 protected:
  CameraChoice read(const std::string& lines) const {
    auto file = base::YamlReader::openFile(temp_.write("c.yaml", lines));
    CameraChoice choice = readCameraChoice(file.section("cameras"));
    file.finish();
    return choice;
  }
  std::string faultsOf(const std::string& lines) const {
    try {
      (void)read(lines);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  static camera::CameraListing listed(const std::string& path, const std::string& card,
                                      const std::string& bus) {
    return {path, "", card, "uvc", bus, true, {}, {}};
  }
  static constexpr const char* kGood =
      "cameras:\n"
      "  spot:\n"
      "    source: v4l2\n"
      "    device: Eye\n"
      "    format: Y10\n"
      "    exposure_us: 200\n"
      "    lit_us: 5\n"
      "    gain: -3\n"
      "    frames_per_s: 120\n"
      "    triggered: true\n"
      "    controls: {trigger_mode: 1}\n"
      "  kerf: {source: twin}\n";
  const base::TempFolder temp_;
};

TEST_F(CameraChoiceTest, WithoutAWordTheTwinLooks) {
  const CameraChoice choice = read("cameras: {}\n");
  EXPECT_FALSE(choice.spot.is_real);
  EXPECT_TRUE(choice.kerf.tiles.empty());
}

TEST_F(CameraChoiceTest, ARealOneIsReadWithItsPlaces) {
  const CameraChoice choice = read(kGood);
  EXPECT_TRUE(choice.spot.is_real);
  EXPECT_EQ(choice.spot.settings.format->name, "Y10");
  EXPECT_DOUBLE_EQ(choice.spot.settings.exposure_s.value_or(0.0), 200e-6);
  EXPECT_DOUBLE_EQ(choice.spot.lit_s, 5e-6);
  EXPECT_EQ(choice.spot.settings.gain, -3);
  EXPECT_EQ(choice.spot.settings.frame_rate_hz, 120.0);
  EXPECT_TRUE(choice.spot.is_triggered);
  ASSERT_EQ(choice.spot.settings.controls.size(), 1U);
  EXPECT_EQ(choice.spot.settings.controls[0].key, "trigger_mode");
  EXPECT_EQ(choice.spot.settings.controls[0].value, 1);
  EXPECT_THAT(choice.spot.places.at("trigger_mode"),
              HasSubstr("c.yaml:11: cameras.spot.controls.trigger_mode"));
  EXPECT_THAT(choice.spot.place, HasSubstr("c.yaml:4: cameras.spot.device"));
}

TEST_F(CameraChoiceTest, AWindowIsFirstColumnFirstRowColumnsAndRows) {
  EXPECT_FALSE(read(kGood).spot.settings.window);
  const std::string windowed = base::replaced(kGood, "gain: -3", "window_px: [16, 8, 640, 120]");
  const CameraChoice choice = read(windowed);
  EXPECT_EQ(choice.spot.settings.window, (PixelWindow{16, 8, 640, 120}));
  EXPECT_EQ(choice.spot.places.at("window").substr(choice.spot.places.at("window").find("cameras.")),
            "cameras.spot.window_px");
  EXPECT_THAT(faultsOf(base::replaced(windowed, "640, 120", "640, 0")), HasSubstr("window_px: has no pixel"));
}

TEST_F(CameraChoiceTest, EverythingWrongIsListed) {
  const std::string faults = faultsOf(
      "cameras:\n"
      "  spot:\n"
      "    source: v4l2\n"
      "    format: RGB3\n"
      "    controls: {mode: fast}\n"
      "    colour: 1\n");
  EXPECT_THAT(faults,
              AllOf(HasSubstr("cameras.spot.device"), HasSubstr("'RGB3' cannot be read; known are GREY"),
                    HasSubstr("mode: 'fast' is no whole number"), HasSubstr("exposure_us: say it"),
                    HasSubstr("cameras.spot: is real: say as well where the kerf's"), HasSubstr("colour")));
  EXPECT_THAT(faultsOf(base::replaced(kGood, "lit_us: 5", "lit_us: 500")),
              HasSubstr("c.yaml:7: cameras.spot.lit_us: is longer"));
  EXPECT_THAT(faultsOf(base::replaced(kGood, "{source: twin}", "{source: tiles, folder: lost}")),
              HasSubstr("c.yaml:12: cameras.kerf.folder: there is no folder"));
  EXPECT_THAT(faultsOf(base::replaced(kGood, "source: v4l2", "source: usb")),
              HasSubstr("'usb' is none of: twin, v4l2"));
}

TEST_F(CameraChoiceTest, TilesOfTheKerfComeFromAFolderBesideTheScenario) {
  std::filesystem::create_directory(temp_.path() / "tiles");
  EXPECT_EQ(read("cameras: {kerf: {source: tiles, folder: tiles}}\n").kerf.tiles, temp_.path() / "tiles");
}

TEST_F(CameraChoiceTest, TheDeviceIsFoundByPathNameOrBus) {
  SpotCameraChoice choice;
  choice.place = "c.yaml:4: device";
  const std::vector<camera::CameraListing> cameras{listed("/dev/video0", "Eye", "usb-1"),
                                                   listed("/dev/video2", "Eye", "usb-2"),
                                                   listed("/dev/video4", "Ear", "usb-3")};
  const auto find = [&](const std::string& device) {
    choice.device = device;
    try {
      return findCamera(choice, cameras);
    } catch (const base::ConfigError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(find("Ear"), "/dev/video4");
  EXPECT_EQ(find("usb-2"), "/dev/video2");
  EXPECT_EQ(find("/dev/video99"), "/dev/video99");
  std::filesystem::create_symlink("/dev/null", temp_.path() / "link");
  EXPECT_EQ(find((temp_.path() / "link").string()), "/dev/null");
  EXPECT_THAT(find("Eye"), HasSubstr("c.yaml:4: device: 2 cameras are 'Eye'"));
  EXPECT_THAT(find("Nose"),
              AllOf(HasSubstr("there is no camera 'Nose'"), HasSubstr("/dev/video4 (Ear, usb-3)")));
}

TEST_F(CameraChoiceTest, WhatTheCameraMadeOfASettingIsHeldAgainstIt) {
  const SpotCameraChoice choice = read(kGood).spot;
  camera::CameraSetup setup;
  setup.outcomes = {{"exposure_s", 200e-6, 200e-6},
                    {"frame_rate_hz", 120, 119.9},
                    {"gain", -3, -3},
                    {"trigger_mode", 1, 1}};
  EXPECT_EQ(kerfbench::scenario::faultsOf(choice, setup), "");
  setup.outcomes[1].got = 60;
  setup.outcomes[3].got = 0;
  EXPECT_THAT(kerfbench::scenario::faultsOf(choice, setup),
              AllOf(HasSubstr("c.yaml:9: cameras.spot.frames_per_s: frame_rate_hz = 120 was asked for, and "
                              "the camera made 60"),
                    HasSubstr("c.yaml:11: cameras.spot.controls.trigger_mode")));
}

}  // namespace
}  // namespace kerfbench::scenario
