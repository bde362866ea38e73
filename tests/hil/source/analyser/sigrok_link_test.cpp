// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/sigrok_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <system_error>

#include "hil/source/analyser/analyser_stream.h"

namespace kerfbench::source {
namespace {

using Frame = analyser_stream::AnalyserFrame;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Io = ChildProcess::Io;

/// Messages of a child, and a record of the requests.
struct Script {
  std::string replies;
  Io at_end{Io::kClosed};
  Io on_write{Io::kDone};
  std::string asked;
};

class ScriptedLink final : public ByteLink {
 public:
  explicit ScriptedLink(Script& script) : script_(script) {}
  Io write(std::span<const std::uint8_t> bytes, Clock::time_point) override {
    script_.asked.append(bytes.begin(), bytes.end());
    return script_.on_write;
  }
  Io read(std::span<std::uint8_t> into, Clock::time_point) override {
    if (script_.replies.size() < into.size()) return script_.at_end;
    std::copy_n(script_.replies.begin(), into.size(), into.begin());
    script_.replies.erase(0, into.size());
    return Io::kDone;
  }
  std::string farewell() override { return "ended with exit status 2: it hurts"; }

 private:
  Script& script_;
};

std::string little(std::uint64_t value, unsigned bytes) {
  std::string text;
  for (unsigned i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}
std::string frame(Frame type, const std::string& payload) {
  return static_cast<char>(type) + little(payload.size(), 4) + payload;
}
std::string run(std::uint64_t samples, std::uint32_t levels) {
  return little(samples, 8) + little(levels, 4);
}

class SigrokLinkTest : public testing::Test {
 protected:
  SigrokLinkTest() : analysers(linkedAnalysers([this] { return std::make_unique<ScriptedLink>(script); })) {
    request.driver = "fx2lafw";
    request.samplerate_hz = 24'000'000;
    request.channels = {"D0", "D 1"};
    request.listen = {48'000'000, 240'000'000};
  }
  std::string refusal(const std::string& replies) {
    script.replies = replies;
    try {
      (void)analysers->acquire(request);
    } catch (const AnalyserError& e) {
      return e.what();
    }
    return {};
  }
  AnalyserEnd endAfter(const std::string& replies) {
    script.replies = frame(Frame::kStarted, "a device") + replies;
    const auto feed = analysers->acquire(request);
    runs.clear();
    while (feed->read(runs)) {
    }
    EXPECT_FALSE(feed->read(runs)) << "it stays over";
    return feed->end();
  }
  Script script;
  const std::shared_ptr<AnalyserSystem> analysers;
  AnalyserRequest request;
  std::vector<LevelRun> runs;
};

TEST_F(SigrokLinkTest, AWishIsAskedForLineByLine) {
  request.conn = "1.14";
  request.serial = "A7";
  request.settings = {{"voltage_threshold", "1.2-1.2"}};
  (void)endAfter(frame(Frame::kFinished, std::string(1, '\0')));
  EXPECT_EQ(script.asked,
            "acquire\ndriver fx2lafw\nconn 1.14\nserial A7\nsamplerate 24000000\nquiet 48000000\nlimit "
            "240000000\nchannel D0\nchannel D 1\nsetting voltage_threshold=1.2-1.2\n\n");
}

TEST_F(SigrokLinkTest, RunsNotesAndProblemsComeBack) {
  const AnalyserEnd end =
      endAfter(frame(Frame::kRuns, run(5, 1) + run(std::uint64_t{1} << 40U, 0x80000001)) +
               frame(Frame::kNote, "warm") + frame(Frame::kRuns, "") + frame(Frame::kProblem, "overflow") +
               frame(Frame::kFinished, std::string(1, '\2')));
  EXPECT_THAT(runs, ElementsAre(LevelRun{5, 1}, LevelRun{std::uint64_t{1} << 40U, 0x80000001}));
  EXPECT_THAT(end.notes, ElementsAre("warm"));
  EXPECT_THAT(end.problems, ElementsAre("overflow"));
  EXPECT_EQ(end.reason, AnalyserEnd::Reason::kDevice);
}

TEST_F(SigrokLinkTest, WhatItRefusesIsAnErrorInItsWords) {
  EXPECT_EQ(refusal(frame(Frame::kError, "no such device")), "no such device");
  EXPECT_THAT(refusal(""), HasSubstr("ended with exit status 2: it hurts"));
  EXPECT_THAT(refusal(frame(Frame::kRuns, "")), HasSubstr("talks nonsense"));
  script.at_end = Io::kTimedOut;
  EXPECT_THAT(refusal(""), HasSubstr("does not answer"));
  script.on_write = Io::kClosed;
  EXPECT_THAT(refusal(""), HasSubstr("ended with exit status 2"));
}

TEST_F(SigrokLinkTest, ALineBreakInAWishIsRefused) {
  request.conn = "x\nserial 5";
  EXPECT_THAT(refusal(""), HasSubstr("a conn with a line break"));
  EXPECT_EQ(script.asked, "");
}

// An exception while sampling is a problem: the samples so far are evidence.
TEST_F(SigrokLinkTest, AChildThatDiesHangsOrTalksNonsenseWhileSamplingIsAProblem) {
  const auto broken = [&](const std::string& replies, const std::string& words) {
    const AnalyserEnd end = endAfter(frame(Frame::kRuns, run(7, 1)) + replies);
    EXPECT_EQ(end.reason, AnalyserEnd::Reason::kBroken) << words;
    EXPECT_THAT(end.problems, ElementsAre(HasSubstr(words)));
    EXPECT_THAT(runs, ElementsAre(LevelRun{7, 1}));
  };
  broken("", "ended with exit status 2: it hurts");
  broken("r\x0c", "ended with exit status 2");
  broken(frame(Frame::kRuns, "123"), "half a run");
  broken(frame(Frame::kFinished, std::string(1, '\3')), "talks nonsense");
  broken(frame(Frame::kFinished, ""), "talks nonsense");
  broken(frame(Frame::kDevice, ""), "talks nonsense");
  broken("r" + little(0xFFFFFFFF, 4), "talks nonsense");
  script.at_end = Io::kTimedOut;
  broken("", "does not answer");
}

TEST_F(SigrokLinkTest, TheListHasDriversDevicesAndWhatCannotBeOpened) {
  script.replies = frame(Frame::kLibrary, "library libsigrok 0.5.2\ndriver demo\ndriver ols\n") +
                   frame(Frame::kDevice,
                         "driver ols\nname Dangerous Prototypes \nserial \nconn /dev/ttyUSB0\nrates 1 Hz\n"
                         "channel 0\nchannel A B\nfuture x\n") +
                   frame(Frame::kFault, "busy") + frame(Frame::kListed, "");
  const AnalyserList list = analysers->list();
  EXPECT_EQ(script.asked, "list\n\n");
  EXPECT_EQ(list.library, "libsigrok 0.5.2");
  EXPECT_THAT(list.drivers, ElementsAre("demo", "ols"));
  ASSERT_EQ(list.devices.size(), 1U);
  EXPECT_EQ(list.devices[0].conn, "/dev/ttyUSB0");
  EXPECT_EQ(list.devices[0].serial, "");
  EXPECT_EQ(list.devices[0].samplerates, "1 Hz");
  EXPECT_THAT(list.devices[0].channels, ElementsAre("0", "A B"));
  EXPECT_THAT(list.faults, ElementsAre("busy"));
}

TEST_F(SigrokLinkTest, AListThatDoesNotComeIsAnError) {
  for (const std::string& replies :
       {std::string(), frame(Frame::kError, "no library"), frame(Frame::kRuns, "")}) {
    script.replies = replies;
    EXPECT_THROW((void)analysers->list(), AnalyserError);
  }
}

TEST(SigrokChildProcess, ThatIsNotThereIsAnErrorThatNamesIt) {
  try {
    (void)sigrokAnalysers("/nowhere")->list();
    FAIL();
  } catch (const AnalyserError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("cannot be started"), HasSubstr("/nowhere/kerfbench-sigrok")));
  }
}

}  // namespace
}  // namespace kerfbench::source
