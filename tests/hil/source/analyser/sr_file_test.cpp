// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/sr_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "hil/source/analyser/zip_archive.h"
#include "tests/hil/source/vcd_sample.h"

namespace kerfbench::source {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Parts = std::vector<std::pair<std::string, std::string>>;

bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

class SrFile : public testing::Test {
 protected:
  SrFile() : folder_(fs::path(testing::TempDir()) / ("sr_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    map_.assign(Signal::kGalvoXPul, {0, 3});
    map_.assign(Signal::kGalvoXDir, {0, 5});
    map_.assign(Signal::kLaserGate, {1, 0});
    map_.assign(Signal::kEncoderA, {2, 0});
  }
  ~SrFile() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name) const { return folder_ / name; }
  fs::path zip(const Parts& parts) const {
    ZipWriter writer(file("x.sr"));
    for (const auto& [name, content] : parts) writer.add(name, content);
    writer.commit();
    return file("x.sr");
  }
  std::string faultsOf(const fs::path& path, const ChannelNames& names = {}) const {
    try {
      (void)readSr(path, map_, names);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }
  static std::string metadata(const std::string& rate = "1 MHz", const std::string& size = "1") {
    return "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes=3\nsamplerate=" +
           rate +
           "\ntotal analog=0\nprobe1=galvo_x_pul\nprobe2=galvo_x_dir\nprobe4=laser_gate\nunitsize=" + size +
           "\n";
  }
  static Parts good() {
    return {{"version", "2"},
            {"metadata", metadata()},
            {"logic-1-1", std::string("\x02\x02\x03", 3)},
            {"logic-1-2", std::string("\x0A\x00", 2)}};
  }
  static Parts with(const std::string& part, const std::string& content) {
    Parts parts = good();
    for (auto& [name, old] : parts) {
      if (name == part) old = content;
    }
    return parts;
  }
  static Parts without(const std::string& part) {
    Parts parts = good();
    std::erase_if(parts, [&](const auto& p) { return p.first == part; });
    return parts;
  }
  fs::path folder_;
  SignalMap map_;
};

TEST_F(SrFile, SamplesBecomeEvents) {
  const PinRecording recording = readSr(zip(good()), map_, {});
  EXPECT_EQ(recording.rate, (TickRate{1, 1'000'000}));
  EXPECT_EQ(recording.stamp_err_ticks, 1U);
  EXPECT_FALSE(recording.own);
  EXPECT_EQ(recording.end, 4U);
  EXPECT_THAT(recording.outputs, ElementsAre(PinEvent{0, 0, 0x20, 0x20, 0}, PinEvent{2, 0, 0x08, 0x28, 0},
                                             PinEvent{3, 0, 0x08, 0x20, 0}, PinEvent{3, 1, 1, 1, 0},
                                             PinEvent{4, 0, 0x20, 0x00, 0}, PinEvent{4, 1, 1, 0, 0}));
}

TEST_F(SrFile, ChannelsMayHaveTheNamesOfTheScenario) {
  Parts parts = with("metadata",
                     "[device 1]\ncapturefile=logic-1\nsamplerate=500 kHz\nprobe1=D0\nprobe2=galvo_x_dir\n"
                     "probe3=unused\nunitsize=1\n");
  const ChannelNames names{{Signal::kGalvoXPul, "D0"}, {Signal::kGalvoXDir, "D1"}};
  const PinRecording recording = readSr(zip(parts), map_, names);
  EXPECT_EQ(recording.rate, (TickRate{1, 500'000}));
  EXPECT_EQ(recording.outputs.size(), 4U) << "the gate is none of the scenario's";
  EXPECT_THAT(faultsOf(zip(parts)),
              HasSubstr("no channel for galvo_x_pul, laser_gate; there are 'D0' 'galvo_x_dir' "
                        "'unused'"));
  EXPECT_THAT(faultsOf(zip(parts), {{Signal::kGalvoXPul, "D7"}}),
              HasSubstr("no channel for galvo_x_pul ('D7'); there are 'D0'"));
  EXPECT_THAT(faultsOf(zip(parts), {{Signal::kGalvoXDir, "D0"}}),
              HasSubstr("more than one channel for galvo_x_dir"));
}

TEST_F(SrFile, RatesAreExact) {
  for (const auto& [text, hz] :
       std::vector<std::pair<std::string, std::uint64_t>>{{"24 MHz", 24'000'000},
                                                          {"14.7456 MHz", 14'745'600},
                                                          {"1.5 GHz", 1'500'000'000},
                                                          {"12.50 kHz", 12'500},
                                                          {"999 Hz", 999},
                                                          {"1000 GHz", 1'000'000'000'000},
                                                          {"48000000", 48'000'000}})
    EXPECT_EQ(readSr(zip(with("metadata", metadata(text))), map_, {}).rate.den, hz) << text;
  for (const char* text : {"0 MHz", "fast", "1.5 Hz", "1..5 MHz", "-4 MHz", "3 parsec", "99999999999 GHz",
                           "1000.000000001 GHz", "18446744073709551615"})
    EXPECT_THAT(faultsOf(zip(with("metadata", metadata(text)))), HasSubstr("no rate in Hz, kHz")) << text;
}

TEST_F(SrFile, AllThatIsWrongIsTold) {
  EXPECT_THAT(
      faultsOf(zip(with("metadata", "[device 1]\nsamplerate=x\nunitsize=9\n"))),
      AllOf(HasSubstr("x.sr: metadata: no capturefile"), HasSubstr("samplerate=x"), HasSubstr("unitsize=9")));
  EXPECT_THAT(faultsOf(zip(with("metadata", metadata() + "probe9=D8\nprobex=1\n"))),
              AllOf(HasSubstr("probe9=D8: no channel of samples of 1 bytes"), HasSubstr("probex=1")));
  EXPECT_THAT(faultsOf(zip(with("metadata", metadata() + "[device 2]\n"))), HasSubstr("2 devices"));
  EXPECT_THAT(faultsOf(zip(with("metadata", "hello"))), HasSubstr("no [device 1]"));
  EXPECT_THAT(
      faultsOf(zip(with("metadata", "[device 1]\ncapturefile=logic-1\nsamplerate=1 Hz\nunitsize=1\n"))),
      HasSubstr("no channels of logic"));
  EXPECT_THAT(faultsOf(zip(with("version", "3"))), HasSubstr("another version"));
  for (const char* part : {"version", "metadata"})
    EXPECT_THAT(faultsOf(zip(without(part))), HasSubstr("no session of sigrok"));
  EXPECT_THAT(faultsOf(zip(without("logic-1-1"))), HasSubstr("no part 'logic-1-1' with samples"));
  Parts gap = without("logic-1-2");
  gap.emplace_back("logic-1-3", "\x01");
  EXPECT_THAT(faultsOf(zip(gap)), HasSubstr("no part 'logic-1-2' with samples: the file is truncated"));
  Parts long_gap = without("logic-1-2");
  long_gap.emplace_back("logic-1-4", "\x01");
  EXPECT_THAT(faultsOf(zip(long_gap)), HasSubstr("no part 'logic-1-2' with samples: the file is truncated"));
  EXPECT_THAT(faultsOf(zip(with("metadata", metadata("")))), HasSubstr("metadata: no samplerate"));
  EXPECT_THAT(faultsOf(zip(with("metadata", metadata("1 MHz", "")))), HasSubstr("metadata: no unitsize"));
  EXPECT_THAT(faultsOf(zip(with("metadata", "[device 1]\ncapturefile=\nsamplerate=1 Hz\nunitsize=1\n"))),
              HasSubstr("metadata: no capturefile"));
  EXPECT_THAT(faultsOf(zip(with("metadata", metadata("1 MHz", "2")))), HasSubstr("half a sample"));
  Parts empty = with("logic-1-1", "");
  empty.pop_back();
  EXPECT_THAT(faultsOf(zip(empty)), HasSubstr("has no samples"));
}

TEST_F(SrFile, ASampleMayLieInTwoParts) {
  Parts parts = with("metadata", metadata("1 MHz", "2"));
  parts[2].second = std::string("\x02\x00\x02", 3);
  parts[3].second = std::string("\x00\x03\x00", 3);
  const PinRecording recording = readSr(zip(parts), map_, {});
  EXPECT_THAT(recording.outputs, ElementsAre(PinEvent{0, 0, 0x20, 0x20, 0}, PinEvent{2, 0, 0x08, 0x28, 0}));
  EXPECT_EQ(recording.end, 2U);
}

TEST_F(SrFile, FilesThatAreNoArchiveOrADamagedOneAreRefused) {
  EXPECT_THAT(faultsOf(file("nowhere.sr")), AllOf(HasSubstr("nowhere.sr"), HasSubstr("no such file")));
  std::ofstream(file("empty.sr"));
  EXPECT_THAT(faultsOf(file("empty.sr")), HasSubstr("empty.sr"));
  std::ofstream(file("text.sr")) << std::string(1000, 'x');
  EXPECT_THAT(faultsOf(file("text.sr")), HasSubstr("no readable zip archive"));
  std::string noise;
  for (std::uint32_t i = 0, state = 7; i < 4000; ++i) {
    state = state * 1664525U + 1013904223U;
    noise += static_cast<char>(state >> 28U);
  }
  const fs::path path = zip(with("logic-1-1", noise));
  std::ifstream in(path, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  ASSERT_EQ(faultsOf(path), "");
  for (std::size_t size = 0; size < whole.size(); size += 41) {
    std::ofstream(file("cut.sr"), std::ios::binary) << whole.substr(0, size);
    EXPECT_NE(faultsOf(file("cut.sr")), "") << size;
  }
  // The damaged bit is within the samples: only the checksum shows it.
  const auto at = whole.find("logic-1-1") + 300;
  std::string damaged = whole;
  damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
  std::ofstream(file("damaged.sr"), std::ios::binary) << damaged;
  EXPECT_THAT(faultsOf(file("damaged.sr")), HasSubstr("logic-1-1: damaged"));
}

TEST_F(SrFile, WrittenAndReadAgainItIsTheSame) {
  PinRecording recording = sampleRecording(3000, {1, 16'000'000});
  writeSr(file("a.sr"), recording, sampleMap());
  const PinRecording back = readSr(file("a.sr"), sampleMap(), {});
  EXPECT_EQ(back.rate, recording.rate);
  EXPECT_EQ(back.end, recording.end);
  EXPECT_EQ(back.outputs, recording.outputs);
  ASSERT_EQ(back.sensors.size(), recording.sensors.size());
  for (std::size_t i = 0; i < back.sensors.size(); ++i) {
    EXPECT_EQ(back.sensors[i].tick, recording.sensors[i].tick);
    EXPECT_EQ(back.sensors[i].level, recording.sensors[i].level);
  }
  EXPECT_TRUE(back.problems.empty());
  writeSr(file("b.sr"), back, sampleMap());
  const auto bytes = [&](const char* name) {
    std::ifstream in(file(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_TRUE(bytes("a.sr") == bytes("b.sr"));
}

// The file has more than one part, and levels that last from one to the next.
TEST_F(SrFile, LongOnesAreWrittenInParts) {
  PinRecording recording;
  recording.rate = {1, 1'000'000};
  recording.outputs = {{2'097'151, 0, 8, 8, 0}, {2'097'152, 1, 1, 1, 0}, {5'000'000, 0, 8, 0, 0}};
  recording.end = 5'000'000;
  writeSr(file("long.sr"), recording, map_);
  EXPECT_TRUE(ZipReader(file("long.sr")).sizeOf("logic-1-3"));
  const PinRecording back = readSr(file("long.sr"), map_, {});
  EXPECT_EQ(back.outputs, recording.outputs);
  EXPECT_EQ(back.end, recording.end);
}

TEST_F(SrFile, WhatSpoiledARecordingStaysInIt) {
  PinRecording recording = sampleRecording(100);
  recording.problems = {"a chip has gone,\n 100 %"};
  std::vector<PinEvent> events(recording.outputs.begin(), recording.outputs.end());
  events[40].flags = PinEvent::kGap;
  recording.outputs = PinEvents(events);
  writeSr(file("spoiled.sr"), recording, sampleMap());
  EXPECT_THAT(readSr(file("spoiled.sr"), sampleMap(), {}).problems,
              ElementsAre("a chip has gone,\n 100 %", HasSubstr("pin events were lost before 0.00")));
}

TEST_F(SrFile, TicksThatAreNoRateAndFoldersThatAreNotThereAreRefused) {
  EXPECT_THROW(writeSr(file("a.sr"), sampleRecording(3, {3, 1000}), sampleMap()), std::invalid_argument);
  PinRecording endless = sampleRecording(3);
  endless.end = std::uint64_t{1} << 36U;
  EXPECT_THROW(writeSr(file("a.sr"), endless, sampleMap()), std::invalid_argument);
  EXPECT_THROW(writeSr(file("no/a.sr"), sampleRecording(3), sampleMap()), ZipError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

// Other programs read these files, and this program reads theirs.
TEST_F(SrFile, SigrokReadsWhatWeWriteAndWeWhatItWrites) {
  if (!have("sigrok-cli")) GTEST_SKIP() << "sigrok-cli is not installed";
  const PinRecording recording = sampleRecording(500);
  writeSr(file("ours.sr"), recording, sampleMap());
  const std::string copy =
      "sigrok-cli -i '" + file("ours.sr").string() + "' -o '" + file("copy.sr").string() + "'";
  ASSERT_EQ(std::system(copy.c_str()), 0);
  const PinRecording back = readSr(file("copy.sr"), sampleMap(), {});
  EXPECT_EQ(back.outputs, recording.outputs);
  EXPECT_EQ(back.rate, recording.rate);
  EXPECT_EQ(back.end, recording.end);
}

}  // namespace
}  // namespace kerfbench::source
