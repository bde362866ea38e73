// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "hil/source/analyser/sigrok_child/sigrok.h"
#include "tests/hil/source/analyser/sigrok_child/fake_libsigrok.h"

namespace kerfbench::sigrok_child {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Pair;

std::string runText(std::uint64_t samples, std::uint32_t levels) {
  std::string text;
  for (unsigned i = 0; i < 8; ++i) text += static_cast<char>(samples >> (8 * i));
  for (unsigned i = 0; i < 4; ++i) text += static_cast<char>(levels >> (8 * i));
  return text;
}

class SigrokChild : public testing::Test {
 protected:
  SigrokChild() {
    fake = FakeLibsigrok{};
    request.driver = "fakela";
    request.samplerate_hz = 1000;
    request.channels = {"D0", "D2"};
    request.listen = {4, 100};
    fake.packets = {{.samples = {0, 1, 5, 5}}, {.samples = {5, 5, 5, 5, 0}}, {.samples = {1}}};
  }
  ~SigrokChild() override {
    EXPECT_EQ(fake.contexts, 0);
    EXPECT_EQ(fake.sessions, 0);
    EXPECT_EQ(fake.opened, 0);
  }
  void run() {
    frames.clear();
    acquire(request,
            [this](Frame frame, const std::string& payload) { frames.emplace_back(frame, payload); });
  }
  std::string refusal() {
    try {
      run();
    } catch (const SigrokError& e) {
      EXPECT_THAT(frames, IsEmpty());
      return e.what();
    }
    return {};
  }
  AcquireRequest request;
  std::vector<std::pair<Frame, std::string>> frames;
};

TEST_F(SigrokChild, PacketsBecomeRunsUntilThePinsAreQuiet) {
  run();
  EXPECT_THAT(frames,
              ElementsAre(Pair(Frame::kStarted, "fakela Maker Model"),
                          Pair(Frame::kRuns, runText(1, 0) + runText(1, 1) + runText(2, 3)),
                          Pair(Frame::kRuns, runText(2, 3)), Pair(Frame::kFinished, std::string(1, '\0'))));
  EXPECT_TRUE(fake.stopped);
  EXPECT_THAT(fake.enabled, ElementsAre("D0", "D2"));
  EXPECT_THAT(fake.disabled, ElementsAre("D1"));
}

TEST_F(SigrokChild, EndsAtTheLimitOrWhenTheDeviceDoes) {
  request.listen = {50, 3};
  run();
  EXPECT_THAT(frames.back(), Pair(Frame::kFinished, std::string(1, '\1')));
  EXPECT_TRUE(fake.stopped);
  request.listen = {50, 300};
  fake.stopped = false;
  run();
  EXPECT_THAT(frames.back(), Pair(Frame::kFinished, std::string(1, '\2')));
  EXPECT_FALSE(fake.stopped);
}

TEST_F(SigrokChild, WhatTheDriverSaysWhileItSamplesIsToldOnce) {
  fake.packets[0].says = "transfer failed";
  fake.packets[1].says = "transfer failed";
  fake.packets.insert(fake.packets.begin(),
                      {.type = SR_DF_TRIGGER, .samples = {9, 9}, .says = "warm", .level = SR_LOG_WARN});
  run();
  EXPECT_THAT(frames,
              AllOf(Contains(Pair(Frame::kProblem, "the analyser's driver says: transfer failed")).Times(1),
                    Contains(Pair(Frame::kNote, "warm"))));
}

TEST_F(SigrokChild, ASessionThatBreaksIsAProblem) {
  fake.run_error = SR_ERR;
  run();
  EXPECT_THAT(frames, Contains(Pair(Frame::kProblem, "the analyser cannot be read: generic error")));
  fake.run_error = SR_OK;
  fake.start_error = SR_ERR_NA;
  run();
  EXPECT_THAT(frames, ElementsAre(Pair(Frame::kStarted, "fakela Maker Model"),
                                  Pair(Frame::kProblem, "the analyser cannot be read: not applicable"),
                                  Pair(Frame::kFinished, std::string(1, '\2'))));
}

// A listener that has gone, or packets that make no sense, leave the library first and raise then.
TEST_F(SigrokChild, NoExceptionPassesThroughTheLibrary) {
  fake.packets = {{.samples = {0, 1, 2}, .sample_bytes = 2}, {.samples = {1}}};
  EXPECT_THROW(run(), std::invalid_argument);
  EXPECT_TRUE(fake.stopped);
  EXPECT_EQ(frames.size(), 1U);
  fake.packets = {{.samples = {0, 1, 2}}};
  EXPECT_THROW(acquire(request,
                       [](Frame frame, const std::string&) {
                         if (frame == Frame::kRuns) throw std::runtime_error("nobody listens");
                       }),
               std::runtime_error);
}

TEST_F(SigrokChild, DevicesAreToldApartByConnAndSerial) {
  fake.devices = {{.serial = "A1", .conn = "1.4"}, {.serial = "B2", .conn = "1.5"}};
  EXPECT_THAT(refusal(), AllOf(HasSubstr("more than one analyser, name one by conn or serial"),
                               HasSubstr("\n  fakela Maker Model, serial A1, at 1.4"), HasSubstr("B2")));
  request.serial = "B2";
  run();
  EXPECT_THAT(frames.front(), Pair(Frame::kStarted, "fakela Maker Model, serial B2, at 1.5"));
  request.serial = "C3";
  EXPECT_THAT(refusal(), AllOf(HasSubstr("no analyser with the serial C3"), HasSubstr("B2")));
  request.conn = "1.5";
  fake.devices.clear();
  fake.scan_says = "permission denied";
  EXPECT_THAT(refusal(), AllOf(HasSubstr("no analyser at 1.5"), HasSubstr("is it plugged in"),
                               HasSubstr("permission denied")));
  EXPECT_EQ(fake.scanned_conn, "1.5");
}

TEST_F(SigrokChild, WhatTheLibraryRefusesIsSaid) {
  fake.init_error = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("libsigrok does not start: generic error"));
  fake.init_error = SR_OK;
  request.driver = "fakemeter";
  EXPECT_THAT(refusal(), AllOf(HasSubstr("no driver 'fakemeter' for logic analysers; it has fakela"),
                               Not(HasSubstr("has fakemeter"))));
  request.driver = "fakela";
  fake.driver_error = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("the driver fakela does not start"));
  fake.driver_error = SR_OK;
  fake.open_error = SR_ERR;
  EXPECT_THAT(refusal(), AllOf(HasSubstr("cannot be opened: generic error"), HasSubstr("allowed to use it")));
  fake.open_error = SR_OK;
  fake.enable_error = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("channel D0 cannot be used"));
  fake.enable_error = SR_OK;
  fake.session_error = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("cannot be read: generic error"));
  fake.session_error = SR_OK;
  fake.add_error = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("cannot be read: generic error"));
}

TEST_F(SigrokChild, ChannelsThatItDoesNotHaveAreAllNamed) {
  request.channels = {"D1", "D7", "A0"};
  fake.devices[0].analog = true;
  EXPECT_THAT(refusal(), HasSubstr("it has no channel 'D7', 'A0'; it has D0 D1 D2"));
}

TEST_F(SigrokChild, ARateThatIsNotGrantedIsAnErrorWithThoseThatAre) {
  fake.granted_hz = 500;
  EXPECT_THAT(refusal(), HasSubstr("does not sample at 1000 Hz: it grants 500 Hz; it has 10 Hz … 1000 Hz in "
                                   "steps of 10 Hz"));
  fake.set_errors[SR_CONF_SAMPLERATE] = SR_ERR_NA;
  fake.rates = {100, 500};
  EXPECT_THAT(refusal(), HasSubstr("does not sample at 1000 Hz: not applicable; it has 100 Hz, 500 Hz"));
  fake.lists_rates = false;
  EXPECT_THAT(refusal(), testing::EndsWith("does not sample at 1000 Hz: not applicable"));
  fake.set_errors.clear();
  fake.tells_rate = false;
  EXPECT_EQ(refusal(), "") << "it has taken it, and has no way to say so";
}

TEST_F(SigrokChild, OneThatDoesNotStreamIsToldHowMuchToTake) {
  run();
  EXPECT_FALSE(fake.set.contains(SR_CONF_LIMIT_SAMPLES));
  fake.continuous = false;
  run();
  EXPECT_EQ(fake.set[SR_CONF_LIMIT_SAMPLES], "100");
  request.listen.limit_samples = 5000;
  run();
  EXPECT_EQ(fake.set[SR_CONF_LIMIT_SAMPLES], "4096") << "all that its memory holds";
  fake.limits = {0, 0};
  run();
  EXPECT_EQ(fake.set[SR_CONF_LIMIT_SAMPLES], "5000");
  fake.set_errors[SR_CONF_LIMIT_SAMPLES] = SR_ERR;
  EXPECT_THAT(refusal(), HasSubstr("does not take 5000 samples"));
  fake.has_limit = false;
  EXPECT_EQ(refusal(), "");
}

TEST_F(SigrokChild, SettingsGoToTheDeviceOrToTheGroupThatHasThem) {
  const int can_set = static_cast<int>(SR_CONF_GET | SR_CONF_SET | SR_CONF_LIST);
  fake.settings = {{SR_CONF_PATTERN_MODE, {true, can_set}},
                   {SR_CONF_CAPTURE_RATIO, {false, static_cast<int>(SR_CONF_SET)}},
                   {SR_CONF_RLE, {false, can_set}},
                   {SR_CONF_OUTPUT_FREQUENCY, {false, can_set}},
                   {SR_CONF_VOLTAGE_THRESHOLD, {false, can_set}}};
  request.settings = {{"pattern", "x"},
                      {"captureratio", "5"},
                      {"rle", "on"},
                      {"output_frequency", "2.5"},
                      {"voltage_threshold", "-0.5-1.4"}};
  run();
  EXPECT_EQ(fake.set[SR_CONF_PATTERN_MODE], "'x' @group");
  EXPECT_EQ(fake.set[SR_CONF_CAPTURE_RATIO], "5");
  EXPECT_EQ(fake.set[SR_CONF_RLE], "true");
  EXPECT_EQ(fake.set[SR_CONF_OUTPUT_FREQUENCY], "2.5");
  EXPECT_EQ(fake.set[SR_CONF_VOLTAGE_THRESHOLD], "(-0.5, 1.3999999999999999)");
}

TEST_F(SigrokChild, SettingsThatMakeNoSenseAreRefused) {
  const int can_set = static_cast<int>(SR_CONF_SET);
  for (const std::uint32_t key : {SR_CONF_CAPTURE_RATIO, SR_CONF_RLE, SR_CONF_OUTPUT_FREQUENCY,
                                  SR_CONF_VOLTAGE_THRESHOLD, SR_CONF_MEASURED_QUANTITY})
    fake.settings[key] = {false, can_set};
  for (const auto& [key, text] :
       std::vector<std::pair<std::string, std::string>>{{"captureratio", "many"},
                                                        {"rle", "yes"},
                                                        {"output_frequency", "2.5x"},
                                                        {"voltage_threshold", "1.4"},
                                                        {"voltage_threshold", "a-b"},
                                                        {"measured_quantity", "1"}}) {
    request.settings = {{key, text}};
    EXPECT_THAT(refusal(), HasSubstr(fmt::format("setting {}: {}: no value for it", key, text)));
  }
  request.settings = {{"colour", "red"}};
  EXPECT_THAT(refusal(), HasSubstr("knows no setting of this name"));
  request.settings = {{"pattern", "x"}};
  EXPECT_THAT(refusal(), HasSubstr("has no such setting"));
  fake.settings[SR_CONF_PATTERN_MODE] = {false, static_cast<int>(SR_CONF_GET)};
  EXPECT_THAT(refusal(), HasSubstr("has no such setting")) << "it can be read only";
  request.settings = {{"rle", "off"}};
  fake.set_errors[SR_CONF_RLE] = SR_ERR_NA;
  EXPECT_THAT(refusal(), HasSubstr("setting rle: off: not taken: not applicable"));
}

TEST_F(SigrokChild, TheListHasEachDeviceOrWhyItCannotBeOpened) {
  const auto listed = [&] {
    frames.clear();
    listAnalysers([this](Frame frame, const std::string& payload) { frames.emplace_back(frame, payload); });
    return frames;
  };
  fake.devices = {{.version = "v2", .serial = "A1", .conn = "1.4"}};
  EXPECT_THAT(listed(),
              ElementsAre(Pair(Frame::kLibrary, "library libsigrok 0.5.2-fake\ndriver fakela\n"),
                          Pair(Frame::kDevice,
                               "driver fakela\nname Maker Model v2\nserial A1\nconn 1.4\nrates 10 Hz … 1000 "
                               "Hz in steps of 10 Hz\nchannel D0\nchannel D1\nchannel D2\n"),
                          Pair(Frame::kListed, "")));
  fake.open_error = SR_ERR;
  EXPECT_THAT(listed()[1], Pair(Frame::kFault, HasSubstr("serial A1, at 1.4: cannot be opened")));
  fake.driver_error = SR_ERR;
  EXPECT_THAT(listed()[1], Pair(Frame::kFault, HasSubstr("the driver fakela does not start")));
}

}  // namespace
}  // namespace kerfbench::sigrok_child
