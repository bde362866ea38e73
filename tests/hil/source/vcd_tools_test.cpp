// SPDX-License-Identifier: Apache-2.0
// Programs of others must read these files and see the same edges.
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>

#include "tests/hil/source/vcd_sample.h"

namespace kerfbench::source {
namespace {

bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

class VcdTools : public VcdTest {
 protected:
  void SetUp() override {
    recording_ = sampleRecording(500);
    path_ = file("tools.vcd");
    writeVcd(path_, recording_, sampleMap());
    for (const auto& event : recording_.outputs) {
      if (event.port == 0 && (event.changed & event.level & 1) != 0) ++rises_;
    }
    ASSERT_EQ(rises_, 500);
  }
  PinRecording recording_;
  std::filesystem::path path_;
  int rises_{};
};

TEST_F(VcdTools, SigrokSeesEveryPulse) {
  if (!have("sigrok-cli")) GTEST_SKIP() << "sigrok-cli is not installed";
  // The sample rate is one tick: without downsample=625 sigrok expands a second into 10 G samples.
  const std::string command = "sigrok-cli -I vcd:downsample=625 -i '" + path_.string() +
                              "' -C galvo_x_pul -O bits:width=0 2>/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  bool high = false;
  int rises = 0;
  std::string line;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    if (line.starts_with("galvo_x_pul:")) {
      for (const char sample : line) {
        if (sample != '0' && sample != '1') continue;
        if (sample == '1' && !high) ++rises;
        high = sample == '1';
      }
    }
    line.clear();
  }
  EXPECT_EQ(::pclose(pipe), 0);
  EXPECT_EQ(rises, rises_);
}

TEST_F(VcdTools, GtkwaveSeesEveryChange) {
  if (!have("vcd2fst") || !have("fst2vcd")) GTEST_SKIP() << "vcd2fst and fst2vcd (gtkwave) are not installed";
  const auto fst = file("tools.fst");
  const auto again = file("again.vcd");
  const std::string command = "vcd2fst -v '" + path_.string() + "' -f '" + fst.string() +
                              "' >/dev/null 2>&1 && fst2vcd -f '" + fst.string() + "' -o '" + again.string() +
                              "' >/dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  // The tool drops the comments, so a tick is 100 ps now.
  const auto back = readVcd(again, sampleMap());
  std::vector<PinEvent> expected = recording_.outputs.unpacked();
  for (PinEvent& event : expected) event.tick *= 625;
  EXPECT_EQ(back.outputs, expected);
}

}  // namespace
}  // namespace kerfbench::source
