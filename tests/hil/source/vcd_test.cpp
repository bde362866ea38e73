// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "hil/base/digest.h"
#include "hil/source/open.h"
#include "tests/hil/source/vcd_sample.h"

namespace kerfbench::source {
namespace {

using ::testing::HasSubstr;

class VcdRates : public VcdTest, public ::testing::WithParamInterface<TickRate> {};

TEST_P(VcdRates, RoundTripIsExactToTheTickAndTheByte) {
  const auto recording = sampleRecording(2000, GetParam());
  writeVcd(file("a.vcd"), recording, sampleMap());
  const auto back = readVcd(file("a.vcd"), sampleMap());
  EXPECT_EQ(back.rate, recording.rate);
  EXPECT_EQ(back.end, recording.end);
  EXPECT_TRUE(back.own);
  EXPECT_EQ(back.outputs, recording.outputs);
  EXPECT_TRUE(sameSensors(back.sensors, recording.sensors));
  writeVcd(file("b.vcd"), back, sampleMap());
  EXPECT_EQ(contentOf(file("a.vcd")), contentOf(file("b.vcd")));
}
INSTANTIATE_TEST_SUITE_P(Clocks, VcdRates,
                         ::testing::Values(TickRate{1, 16'000'000}, TickRate{1, 12'000'000},
                                           TickRate{1, 1'000'000}, TickRate{1, 1'000'000'000},
                                           TickRate{1, 14'745'600}, TickRate{3, 1000}));

TEST_F(VcdTest, SixteenMegahertzIsWrittenIn100ps) {
  PinRecording recording;
  recording.outputs = {{1, 0, 5, 5, 0}, {3, 0, 4, 1, 0}};
  recording.sensors = {{2, Signal::kPrintMark, true}};
  recording.end = 3;
  writeVcd(file("tiny.vcd"), recording, sampleMap());
  const std::string before =
      "$version kerfbench $end\n$comment kerfbench tick 1/16000000 $end\n$comment kerfbench end 3 $end\n"
      "$comment kerfbench sum sha256 $end\n"
      "$timescale 100 ps $end\n$scope module pins $end\n$var wire 1 ! galvo_x_pul $end\n"
      "$var wire 1 \" galvo_x_dir $end\n$var wire 1 # galvo_y_pul $end\n$var wire 1 + laser_gate $end\n"
      "$var wire 1 - encoder_a $end\n$var wire 1 / print_mark $end\n$upscope $end\n$enddefinitions $end\n"
      "#0\n$dumpvars\n0!\n0\"\n0#\n0+\n0-\n0/\n$end\n#625\n1!\n1#\n#1250\n1/\n#1875\n0#\n#2500\n";
  EXPECT_EQ(contentOf(file("tiny.vcd")),
            before + "$comment kerfbench sum " + base::sha256(before) + " $end\n");
  EXPECT_EQ(readVcd(file("tiny.vcd"), sampleMap()).outputs, recording.outputs);
}

TEST_F(VcdTest, APinOfSeveralEnablesIsOneWire) {
  SignalMap map = sampleMap();
  map.assign(Signal::kGalvoXEnable, {1, 0});
  map.assign(Signal::kGalvoYEnable, {1, 0});
  map.assign(Signal::kFeedEnable, {1, 1});
  PinRecording recording;
  recording.outputs = {{1, 1, 3, 3, 0}, {3, 1, 1, 2, 0}};
  recording.sensors = {{2, Signal::kPrintMark, true}};
  recording.end = 3;
  writeVcd(file("enables.vcd"), recording, map);
  EXPECT_THAT(contentOf(file("enables.vcd")), testing::AllOf(HasSubstr("$var wire 1 5 galvo_x_enable $end\n"),
                                                             HasSubstr("$var wire 1 9 feed_enable $end\n"),
                                                             HasSubstr("$var wire 1 / print_mark $end\n"),
                                                             testing::Not(HasSubstr("galvo_y_enable"))));
  const PinRecording back = readVcd(file("enables.vcd"), map);
  EXPECT_EQ(back.outputs, recording.outputs);
  EXPECT_TRUE(sameSensors(back.sensors, recording.sensors));
}

TEST_F(VcdTest, AFileThatWasChangedHasAProblem) {
  writeVcd(file("whole.vcd"), sampleRecording(100), sampleMap());
  ASSERT_TRUE(readVcd(file("whole.vcd"), sampleMap()).problems.empty());
  const std::string whole = contentOf(file("whole.vcd"));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const auto at = text.rfind(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(file("changed.vcd"), std::ios::binary) << text.replace(at, from.size(), to);
    return readVcd(file("changed.vcd"), sampleMap()).problems.size();
  };
  EXPECT_EQ(changed("#", "#0"), 1U) << "a stamp is written otherwise";
  EXPECT_EQ(changed(" $end\n", " $end 1!\n"), 1U) << "an edge behind the sum";
  EXPECT_EQ(changed(" $end\n", " $end \n"), 0U) << "a blank behind the sum";
  EXPECT_EQ(changed("$comment kerfbench sum", "$comment nobody's sum"), 1U) << "the sum is taken away";
}

TEST_F(VcdTest, ReturnsTheSumThatTheFileEndsWith) {
  const std::string sum = writeVcd(file("whole.vcd"), sampleRecording(100), sampleMap());
  const std::string whole = contentOf(file("whole.vcd"));
  EXPECT_THAT(whole, testing::EndsWith("$comment kerfbench sum " + sum + " $end\n"));
  EXPECT_EQ(vcdSum(file("whole.vcd")), sum);
  EXPECT_TRUE(readVcd(file("whole.vcd"), sampleMap()).sealed);
  EXPECT_EQ(writeVcd(file("again.vcd"), readVcd(file("whole.vcd"), sampleMap()), sampleMap()), sum);
  for (const std::string& changed : {" " + whole, whole + "0!\n", whole.substr(0, whole.rfind("$comment"))})
    EXPECT_EQ(vcdSum(put("changed.vcd", changed)), std::nullopt);
}

TEST_F(VcdTest, AnEdgeThatIsLeftOutLeavesTwoOfOneKind) {
  writeVcd(file("whole.vcd"), sampleRecording(100), sampleMap());
  const std::string whole = contentOf(file("whole.vcd"));
  std::string missing = whole;
  missing.erase(missing.find("\n1!\n"), 3);
  EXPECT_THROW((void)readVcd(put("missing.vcd", missing), sampleMap()), std::runtime_error);
}

TEST_F(VcdTest, ADumpTellsLevelsThatAreAsTheyWere) {
  const auto path = put("dumped.vcd",
                        "$timescale 1 us $end $var wire 1 a galvo_x_pul $end $var wire 1 b galvo_x_dir $end\n"
                        "$var wire 1 c galvo_y_pul $end $var wire 1 d laser_gate $end $enddefinitions $end\n"
                        "#0 0a 0b 0c 0d #5 1a #7 $dumpall 1a 0b 0c 0d $end #9 0a #10\n");
  const auto recording = readVcd(path, sampleMap());
  EXPECT_EQ(recording.outputs, (std::vector<PinEvent>{{5, 0, 1, 1, 0}, {9, 0, 1, 0, 0}}));
  EXPECT_FALSE(recording.sealed);
}

TEST_F(VcdTest, EmptyRunIsAFileToo) {
  PinRecording recording;
  recording.end = 1000;
  writeVcd(file("empty.vcd"), recording, sampleMap());
  const auto back = readVcd(file("empty.vcd"), sampleMap());
  EXPECT_TRUE(back.outputs.empty());
  EXPECT_EQ(back.end, 1000U);
}

TEST_F(VcdTest, GapsSurvive) {
  auto recording = sampleRecording(100);
  std::vector<PinEvent> events(recording.outputs.begin(), recording.outputs.end());
  events[40].flags = PinEvent::kGap;
  events.insert(events.begin() + 60, PinEvent{events[59].tick + 1, 9, 2, 2, PinEvent::kGap});
  recording.outputs = PinEvents(events);
  writeVcd(file("gap.vcd"), recording, sampleMap());
  const auto back = readVcd(file("gap.vcd"), sampleMap());
  const std::vector<PinEvent> read = back.outputs.unpacked();
  ASSERT_EQ(read.size(), events.size());
  EXPECT_EQ(read[40], events[40]);
  EXPECT_EQ(read[60].tick, events[60].tick);
  EXPECT_EQ(read[60].flags, PinEvent::kGap);
}

TEST_F(VcdTest, ProblemsSurviveWhateverTheirWords) {
  auto recording = sampleRecording(10);
  recording.problems = {"a chip has gone", " $end of 100 %\n  #5 0! ", "30 µs; \"x\"\x7f%41",
                        std::string(3000, 'w'), "many " + [] {
                          std::string words;
                          for (int i = 0; i < 200; ++i) words += "words ";
                          return words + "long";
                        }()};
  writeVcd(file("problems.vcd"), recording, sampleMap());
  const auto back = readVcd(file("problems.vcd"), sampleMap());
  EXPECT_EQ(back.problems, recording.problems);
  EXPECT_EQ(back.outputs, recording.outputs);
}

TEST_F(VcdTest, TheControllersWordsSurvive) {
  auto recording = sampleRecording(10);
  recording.uart = {{8000, {0x00, 0xA5, 0xFF}}, {16000, {0x7F}}};
  writeVcd(file("uart.vcd"), recording, sampleMap());
  EXPECT_EQ(readVcd(file("uart.vcd"), sampleMap()).uart, recording.uart);
}

TEST_F(VcdTest, EventsOutOfOrderAreNotWritten) {
  PinRecording recording;
  recording.outputs = {{5, 0, 1, 1, 0}, {4, 0, 1, 0, 0}};
  EXPECT_THROW(writeVcd(file("no.vcd"), recording, sampleMap()), std::invalid_argument);
}

TEST_F(VcdTest, ForeignFileTakesItsTimeScaleForTheTick) {
  const auto path =
      put("foreign.vcd",
          "$date today $end $version analyser $end\n$timescale 10ns $end\n$scope module logic $end\n"
          "$var wire 1 a galvo_x_pul $end $var reg 1 b galvo_x_dir [0] $end\n"
          "$var wire 1 c galvo_y_pul $end $var wire 1 d laser_gate $end $var wire 8 e bus $end\n"
          "$upscope $end $enddefinitions $end\n#0 $dumpvars 0a 1b 0c 0d bxxxxxxxx e $end\n"
          "#100 1a 1c\n#105 0a b00001111 e 0c\n#200\n");
  const auto recording = readVcd(path, sampleMap());
  EXPECT_FALSE(recording.own);
  EXPECT_EQ(recording.rate, (TickRate{1, 100'000'000}));
  EXPECT_EQ(recording.end, 200U);
  EXPECT_EQ(recording.outputs,
            (std::vector<PinEvent>{{0, 0, 2, 2, 0}, {100, 0, 5, 7, 0}, {105, 0, 5, 2, 0}}));
  EXPECT_EQ(openVcd(path, sampleMap())->info().stamp_err_ticks, 1U);
}

class ForeignWires : public VcdTest {
 protected:
  /// A file with these names for the three outputs of the sample's first port, and its gate.
  void write(const std::string& x, const std::string& dir, const std::string& y, const std::string& gate) {
    std::ofstream(file("foreign.vcd")) << "$timescale 1 us $end $var wire 1 a " << x << " $end $var wire 1 b "
                                       << dir << " $end $var wire 1 c " << y << " $end $var wire 1 d " << gate
                                       << " $end $var wire 1 e SPARE $end $enddefinitions $end\n"
                                       << "#0 0a 0b 0c 0d 0e\n#5 1a\n#9 0a 1e\n#10\n";
  }
  [[nodiscard]] std::string faultOf(const ChannelNames& names) {
    try {
      (void)readVcd(file("foreign.vcd"), sampleMap(), names);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(ForeignWires, HaveTheNamesThatTheyAreGiven) {
  write("X_STEP", "X_DIR", "galvo_y_pul", "LASER");
  const ChannelNames names{
      {Signal::kGalvoXPul, "X_STEP"}, {Signal::kGalvoXDir, "X_DIR"}, {Signal::kLaserGate, "LASER"}};
  const auto recording = readVcd(file("foreign.vcd"), sampleMap(), names);
  const PinId pul = *sampleMap().pin(Signal::kGalvoXPul);
  ASSERT_EQ(recording.outputs.size(), 2U);
  EXPECT_EQ(recording.outputs.front().tick, 5U);
  EXPECT_EQ(recording.outputs.front().port, pul.port);
  EXPECT_EQ(recording.outputs.front().level, 1U << pul.bit);
}

TEST_F(ForeignWires, OfWhatTheMachineMakesNoUseOfMayBeMissing) {
  write("X_STEP", "galvo_x_dir", "galvo_y_pul", "laser_gate");
  EXPECT_THAT(faultOf({}), HasSubstr("no wire galvo_x_pul"));
  const SpareSignals spare{Signal::kGalvoXPul};
  EXPECT_TRUE(readVcd(file("foreign.vcd"), sampleMap(), ChannelNames(), spare).outputs.empty());
  // A file of Kerfbench's own has every wire.
  const auto own =
      put("own.vcd",
          "$comment kerfbench tick 1/1000000 $end $comment kerfbench end 10 $end $timescale 1 us $end\n"
          "$var wire 1 b galvo_x_dir $end $var wire 1 c galvo_y_pul $end $var wire 1 d laser_gate $end\n"
          "$enddefinitions $end\n#0 0b 0c 0d\n#10\n");
  try {
    (void)readVcd(own, sampleMap(), ChannelNames(), spare);
    ADD_FAILURE() << "it was read";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no wire galvo_x_pul"));
  }
}

TEST_F(ForeignWires, AWireThatIsMissedIsToldWithThoseThatAreNoSignals) {
  write("X_STEP", "galvo_x_dir", "galvo_y_pul", "laser_gate");
  EXPECT_THAT(faultOf({}),
              HasSubstr("no wire galvo_x_pul, which the machine has; wires of the file that are no "
                        "signal's (the scenario's key wires names them): X_STEP, SPARE"));
  EXPECT_THAT(faultOf({{Signal::kGalvoXPul, "X_PUL"}}),
              HasSubstr("no wire X_PUL (galvo_x_pul), which the machine has"));
}

TEST_F(ForeignWires, ASignalThatIsGivenAnotherNameIsNotOnItsOwn) {
  write("galvo_x_pul", "galvo_x_dir", "galvo_y_pul", "laser_gate");
  EXPECT_EQ(faultOf({}), "");
  EXPECT_THAT(faultOf({{Signal::kGalvoXPul, "NONE"}}), HasSubstr("no wire NONE (galvo_x_pul)"));
  // SPARE moves, and what is called galvo_x_pul is nobody's.
  const auto swapped = readVcd(file("foreign.vcd"), sampleMap(), {{Signal::kGalvoXPul, "SPARE"}});
  ASSERT_EQ(swapped.outputs.size(), 1U);
  EXPECT_EQ(swapped.outputs.front().tick, 9U);
}

TEST_F(ForeignWires, ManyAreNotAllTold) {
  std::string wires;
  for (int i = 0; i < 40; ++i)
    wires += "$var wire 1 w" + std::to_string(i) + " W" + std::to_string(i) + " $end ";
  std::ofstream(file("foreign.vcd")) << "$timescale 1 us $end " << wires << "$enddefinitions $end\n#0\n#1\n";
  EXPECT_THAT(faultOf({}), testing::AllOf(HasSubstr("W14, W15 …"), testing::Not(HasSubstr("W16"))));
}

TEST_F(ForeignWires, AFileOfOurOwnHasTheSignalsNames) {
  writeVcd(file("foreign.vcd"), sampleRecording(10), sampleMap());
  EXPECT_EQ(faultOf({{Signal::kGalvoXPul, "X_STEP"}}), "");
}

TEST_F(VcdTest, ReplayGivesTheRecordingInQuantaAndThenEnds) {
  const auto recording = sampleRecording(300);
  writeVcd(file("replay.vcd"), recording, sampleMap());
  for (const Tick quantum : {Tick{100}, Tick{8000}, Tick{10'000'000}}) {
    const auto source = openVcd(file("replay.vcd"), sampleMap());
    EXPECT_EQ(source->info().rate, recording.rate);
    EXPECT_FALSE(source->info().accepts_input);
    EXPECT_THAT(source->info().config_id, HasSubstr("sha256"));
    std::vector<PinEvent> events;
    Batch batch;
    Tick tick = 0;
    Stop stop = Stop::kReached;
    while (stop == Stop::kReached) {
      source->drive({0, 0}, true, tick + 1);
      stop = source->advance(tick += quantum, batch);
      for (const auto& event : batch.events) EXPECT_LE(event.tick, batch.watermark);
      events.insert(events.end(), batch.events.begin(), batch.events.end());
    }
    EXPECT_EQ(stop, Stop::kEnded);
    EXPECT_EQ(batch.watermark, recording.end);
    EXPECT_EQ(events, recording.outputs);
  }
}

TEST_F(VcdTest, MissingFileIsASystemError) {
  EXPECT_THROW((void)readVcd("/nonexistent/pins.vcd", sampleMap()), std::system_error);
}

}  // namespace
}  // namespace kerfbench::source
