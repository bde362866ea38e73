// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/doctor.h"
#include "hil/doctor/doctor_cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/analyser/scripted_analyser.h"

namespace kerfbench::doctor {
namespace {

using Grade = DoctorFinding::Grade;
using testing::AllOf;
using testing::HasSubstr;

class DoctorTest : public testing::Test {
 protected:
  DoctorTest() {
    state.kernel = "Linux 6.1";
    state.clock_source = "tsc";
    state.clock_resolution_ns = 1;
    source::GpioChipInfo chip{"/dev/gpiochip0", "gpiochip0", "sim", {}};
    for (std::uint32_t i = 0; i < 8; ++i) chip.lines.push_back({i, "", "", false, false, false});
    chip.lines[7] = {7, "LED", "heart \"beat\"", true, true, true};
    state.gpio.chips = {chip};
    state.cameras = {goodCamera()};
    state.analysers = {
        "libsigrok 0.5.2", {"demo", "fx2lafw"}, {{"demo", "Demo device", "", "", {"D0"}, "1 Hz"}}, {}};
    state.analysers.devices.push_back(
        {"fx2lafw", "Saleae Logic", "A7", "1.14", {"D0", "D1", "D2", "D3", "D4", "D5"}, ""});
    (void)temp.write("linecutter-avr.hex", ":00000001FF\n");
  }
  /// Camera that label-camera.yaml requires.
  static camera::CameraListing goodCamera() {
    camera::CameraListing camera{"/dev/video7", "", "Eye", "uvc", "usb-1", true, {}, {}};
    camera.formats = {{"GREY", "8-bit", true, "", {{800, 400, 800, 400, 0, 0, {{1.0 / 400, 1.0 / 400}}}}}};
    camera.controls.emplace_back();
    camera.controls.back().key = "exposure_time_absolute";
    camera.controls.back().name = "\xff";
    return camera;
  }
  std::string cameraNeeds() const {
    std::vector<DoctorFinding> findings;
    const scenario::Case test_case = scenario::readCase(base::fixture("scenarios/native/label-camera.yaml"),
                                                        KERFBENCH_BINARY_DIR "/firmware");
    addCameraNeeds(test_case, state.cameras, findings);
    return textsOf(findings, Grade::kMissing) + textsOf(findings, Grade::kGood);
  }
  scenario::Case onPins() const {
    const auto path =
        temp.write("s.yaml", "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
                                 "\nname: on-pins\n"
                                 "firmware: {source: gpio, chip: gpiochip0, stamp_err_us: 30, lines: "
                                 "{galvo_x_pul: 0, galvo_x_dir: 1, galvo_y_pul: 2, galvo_y_dir: 3, "
                                 "laser_gate: 4, laser_pwm: 5}}\n");
    return scenario::readCase(path, temp.path());
  }
  std::string missingByAnalyser(const std::string& keys, Grade grade = Grade::kMissing) const {
    const auto path =
        temp.write("s.yaml", "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
                                 "\nname: on-pins\n"
                                 "firmware: {source: analyser, samplerate_hz: 24000000, lines: "
                                 "{galvo_x_pul: D0, galvo_x_dir: D1, galvo_y_pul: D2, galvo_y_dir: D3, "
                                 "laser_gate: D4, laser_pwm: D5}, " +
                                 keys + "}\n");
    return textsOf(needsOf(scenario::readCase(path, temp.path()), state, temp.path()), grade);
  }
  static std::string textsOf(const std::vector<DoctorFinding>& findings, Grade grade) {
    std::string text;
    for (const DoctorFinding& finding : findings) {
      if (finding.grade == grade) text += finding.text + "\n";
    }
    return text;
  }
  std::string missing() const { return textsOf(needsOf(onPins(), state, temp.path()), Grade::kMissing); }
  ComputerState state;
  const base::TempFolder temp;
};

TEST_F(DoctorTest, AComputerWithoutFaultsHasNone) {
  const auto findings = findingsOf(state);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].grade, Grade::kGood);
}

TEST_F(DoctorTest, EachTroubleIsTold) {
  state.gpio = {};
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kNote), HasSubstr("no gpiochip"));
  state.gpio.faults = {"/dev/gpiochip0: not allowed; udev"};
  EXPECT_EQ(textsOf(findingsOf(state), Grade::kTrouble), "/dev/gpiochip0: not allowed; udev\n");
  EXPECT_EQ(textsOf(findingsOf(state), Grade::kNote), "");
  state.gpio.faults.clear();
  state.gpio_troubles = {"/dev/gpiochip0: old"};
  EXPECT_EQ(textsOf(findingsOf(state), Grade::kTrouble), "/dev/gpiochip0: old\n");
  state.gpio_troubles.clear();
  state.clock_resolution_ns = 4'000'000;
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kTrouble), HasSubstr("4000000 ns"));
  state.clock_resolution_ns = 1;
  state.clock_source = "jiffies";
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kTrouble), HasSubstr("steps by milliseconds"));
  state.clock_source = "hpet";
  state.real_time_notes = {"no real-time priority"};
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kNote),
              AllOf(HasSubstr("hpet"), HasSubstr("no real-time priority")));
}

TEST_F(DoctorTest, WhatAScenarioOnPinsNeedsIsThereOrNamed) {
  EXPECT_EQ(missing(), "");
  state.gpio.chips[0].lines[2].used = true;
  state.gpio.chips[0].lines[2].consumer = "spi";
  EXPECT_EQ(missing(), "/dev/gpiochip0: line 2 for galvo_y_pul is taken by 'spi'\n");
  state.gpio.chips[0].lines[2].used = false;
  state.gpio_troubles = {"/dev/gpiochip0: old kernel", "/dev/gpiochip1: old kernel"};
  EXPECT_EQ(missing(), "/dev/gpiochip0: old kernel\n");
  state.gpio_troubles.clear();
  state.gpio.chips[0].lines.resize(5);
  EXPECT_THAT(missing(), HasSubstr("laser_pwm: /dev/gpiochip0 has no line 5"));
  state.gpio.chips.clear();
  EXPECT_THAT(missing(), HasSubstr("there is no gpiochip 'gpiochip0'"));
}

TEST_F(DoctorTest, WhatALiveScenarioDrivesIsLookedAtToo) {
  const auto path = temp.write("l.yaml",
                               "extends: s.yaml\nname: live\n"
                               "firmware: {outputs: {encoder_a: 6, print_mark: 7}, uart: " +
                                   (temp.path() / "tty").string() + "}\n");
  (void)onPins();
  const auto found = [&](Grade grade) {
    return textsOf(needsOf(scenario::readCase(path, temp.path()), state, temp.path()), grade);
  };
  EXPECT_THAT(found(Grade::kGood), HasSubstr("/dev/gpiochip0: line 6 for encoder_a is free"));
  EXPECT_THAT(found(Grade::kMissing),
              AllOf(HasSubstr("/dev/gpiochip0: line 7 for print_mark is taken by 'heart \"beat\"'"),
                    HasSubstr("tty, for the controller's UART: No such file")));
  state.gpio_troubles = {"/dev/gpiochip0: old kernel"};
  const std::string missing_now = found(Grade::kMissing);
  ASSERT_NE(missing_now.find("old kernel"), std::string::npos);
  EXPECT_EQ(missing_now.find("old kernel"), missing_now.rfind("old kernel"));
  (void)temp.write("tty", "");
  EXPECT_THAT(found(Grade::kGood), HasSubstr("tty is there"));
}

TEST_F(DoctorTest, WhatAScenarioOnAnAnalyserNeedsIsThereOrNamed) {
  EXPECT_EQ(missingByAnalyser("driver: fx2lafw"), "");
  EXPECT_EQ(missingByAnalyser("driver: fx2lafw, conn: 1.14, serial: A7"), "");
  EXPECT_THAT(missingByAnalyser("driver: fx2lafw", Grade::kGood),
              HasSubstr("fx2lafw: Saleae Logic, serial A7, at 1.14 has the channels"));
  EXPECT_THAT(
      missingByAnalyser("driver: ols"),
      HasSubstr("s.yaml:3: firmware.driver: libsigrok 0.5.2 has no driver 'ols' for logic analysers; it has "
                "demo fx2lafw"));
  EXPECT_THAT(missingByAnalyser("driver: fx2lafw, serial: B8"), HasSubstr("no analyser with the serial B8"));
  EXPECT_THAT(missingByAnalyser("driver: demo"), HasSubstr("has no channel 'D5'; it has D0"));
  EXPECT_THAT(missingByAnalyser("driver: fx2lafw, conn: /dev/ttyUSB0", Grade::kNote),
              HasSubstr("at /dev/ttyUSB0 shows when it is used"));
  state.analysers.devices.push_back(state.analysers.devices.back());
  EXPECT_THAT(missingByAnalyser("driver: fx2lafw"), HasSubstr("finds 2 analysers: name one"));
  state.analyser_trouble = "kerfbench-sigrok: no such file";
  EXPECT_THAT(missingByAnalyser("driver: fx2lafw"), HasSubstr("no such file"));
}

TEST_F(DoctorTest, AnalysersAreListedAndWhatIsWrongWithThemIsTold) {
  EXPECT_THAT(doctorText(state, {}),
              AllOf(HasSubstr("drivers for logic analysers: demo fx2lafw"),
                    HasSubstr("fx2lafw: Saleae Logic, serial A7, at 1.14\n  channels D0 D1 "
                              "D2 D3 D4 D5; does not tell its rates"),
                    HasSubstr("session files of sigrok (.sr)")));
  EXPECT_EQ(nlohmann::json::parse(doctorJson(state, {}, ""))["analysers"]["devices"][1]["conn"], "1.14");
  state.analysers.faults = {"ols: busy"};
  state.analysers.devices.pop_back();
  EXPECT_EQ(textsOf(findingsOf(state), Grade::kTrouble), "ols: busy\n");
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kNote), HasSubstr("no logic analyser is found"))
      << "the demo driver's is none";
  source::ScriptedAnalyser system;
  system.refusal = "cannot be started";
  lookAtAnalysers(system, state);
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kTrouble),
              HasSubstr("(kerfbench-sigrok): cannot be started"));
  system.refusal.reset();
  system.listed.library = "libsigrok 9";
  lookAtAnalysers(system, state);
  EXPECT_EQ(state.analysers.library, "libsigrok 9");
}

TEST_F(DoctorTest, AnEmulatedScenarioNeedsItsEmulator) {
  const scenario::Case test_case =
      scenario::readCase(base::fixture("scenarios/line-ok/plate.yaml"), temp.path());
  EXPECT_THAT(textsOf(needsOf(test_case, state, temp.path()), Grade::kMissing),
              HasSubstr("kerfbench-avr is not there"));
  (void)temp.write("kerfbench-avr", "");
  EXPECT_EQ(textsOf(needsOf(test_case, state, temp.path()), Grade::kMissing), "");
}

TEST_F(DoctorTest, ASpotCameraIsThereOrWhatItLacksIsNamed) {
  EXPECT_EQ(cameraNeeds(), "/dev/video7 (Eye) has what the spot camera needs\n");
  camera::CameraListing& camera = state.cameras[0];
  camera.formats[0].sizes[0].intervals[0] = {0.04, 0.04};
  EXPECT_THAT(
      cameraNeeds(),
      HasSubstr("label-camera.yaml:17: cameras.spot.frames_per_s: /dev/video7 gives no 400 frames/s"));
  camera.formats[0].sizes[0].max_width_px = camera.formats[0].sizes[0].width_px = 640;
  camera.controls.clear();
  EXPECT_THAT(
      cameraNeeds(),
      AllOf(HasSubstr("cameras.spot.device: /dev/video7 gives no 800 x 400 in GREY"),
            HasSubstr("cameras.spot.exposure_us: /dev/video7 has no control exposure_time_absolute")));
  camera.formats[0].fourcc = "YUYV";
  EXPECT_THAT(cameraNeeds(), HasSubstr("cameras.spot.format: /dev/video7 has no GREY, it offers YUYV"));
  camera.captures = false;
  EXPECT_THAT(cameraNeeds(), HasSubstr("/dev/video7: gives no pictures by streaming"));
  camera.problem = "no permission";
  EXPECT_THAT(cameraNeeds(), HasSubstr("/dev/video7: no permission"));
  state.cameras.clear();
  EXPECT_THAT(cameraNeeds(), HasSubstr("cameras.spot.device: there is no /dev/video7"));
}

TEST_F(DoctorTest, TroubleWithCamerasIsTold) {
  state.cameras.push_back({"/dev/video8", "no permission: group", "", "", "", false, {}, {}});
  state.cameras.push_back({"/dev/video9", "", "Odd", "x", "y", true, {}, {}});
  EXPECT_THAT(
      textsOf(findingsOf(state), Grade::kTrouble),
      AllOf(HasSubstr("/dev/video8: no permission"), HasSubstr("/dev/video9: gives pictures in no format")));
  state.cameras.clear();
  EXPECT_THAT(textsOf(findingsOf(state), Grade::kNote), HasSubstr("no camera"));
}

TEST_F(DoctorTest, CamerasAreInTextAndJson) {
  EXPECT_THAT(doctorText(state, {}), AllOf(HasSubstr("/dev/video7: Eye (driver uvc, usb-1)"),
                                           HasSubstr("800 x 400 at 400 frames/s")));
  const auto json = nlohmann::json::parse(doctorJson(state, {}, ""));
  EXPECT_EQ(json["cameras"][0]["formats"][0]["sizes"][0]["size_px"][1], 400);
  EXPECT_EQ(json["cameras"][0]["controls"][0]["key"], "exposure_time_absolute");
}

TEST_F(DoctorTest, TheTextHasEveryLineWithItsUser) {
  const std::string text = doctorText(state, findingsOf(state));
  EXPECT_THAT(
      text, AllOf(HasSubstr("/dev/gpiochip0 (sim), 8 lines"), HasSubstr("  0  -                    input\n"),
                  HasSubstr("output, active low, taken by 'heart \"beat\"'"), HasSubstr("by tsc")));
}

TEST_F(DoctorTest, TheJsonSaysTheSame) {
  const auto json = nlohmann::json::parse(doctorJson(state, findingsOf(state), "s"));
  EXPECT_EQ(json["scenario"], "s");
  EXPECT_EQ(json["gpio"]["chips"][0]["lines"][7]["consumer"], "heart \"beat\"");
  EXPECT_EQ(json["gpio"]["chips"][0]["lines"][7]["direction"], "output");
  EXPECT_EQ(json["clock"]["resolution_ns"], 1);
  EXPECT_EQ(json["real_time"]["allowed"], true);
  EXPECT_EQ(json["findings"][0]["grade"], "good");
}

// Drivers give names in any encoding.
TEST_F(DoctorTest, NamesThatAreNoUtf8DoNotStopIt) {
  state.gpio.chips[0].lines[0].name = "\xff\xfe";
  EXPECT_TRUE(nlohmann::json::accept(doctorJson(state, {}, "")));
}

TEST_F(DoctorTest, LookingAtThisComputerWorksWhateverItHas) {
  const ComputerState here = lookAtComputer(source::linuxGpioSystem(), camera::kernelVideoCalls());
  EXPECT_THAT(here.kernel, testing::StartsWith("Linux "));
  EXPECT_GT(here.clock_resolution_ns, 0U);
  EXPECT_FALSE(findingsOf(here).empty());
}

}  // namespace
}  // namespace kerfbench::doctor
