// SPDX-License-Identifier: Apache-2.0
// Files that other programs accept, or crash on. Each must be refused with its line.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/hil/source/vcd_sample.h"

namespace kerfbench::source {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kWires =
    "$var wire 1 ! galvo_x_pul $end\n$var wire 1 \" galvo_x_dir $end\n$var wire 1 # galvo_y_pul $end\n"
    "$var wire 1 + laser_gate $end\n";

std::string header(const std::string& more = "") {
  // The header has 8 lines and those of `more`.
  return "$timescale 100 ps $end\n$scope module pins $end\n" + std::string(kWires) + more +
         "$upscope $end\n$enddefinitions $end\n";
}

std::string refusal(const std::filesystem::path& path) {
  try {
    (void)readVcd(path, sampleMap());
  } catch (const std::runtime_error& fault) {
    return fault.what();
  }
  return "accepted";
}

struct BadVcd {
  const char* name;
  std::string content;
  const char* words;
};
void PrintTo(const BadVcd& c, std::ostream* out) { *out << c.name; }

class HostileVcd : public VcdTest, public ::testing::WithParamInterface<BadVcd> {};

TEST_P(HostileVcd, IsRefused) {
  EXPECT_THAT(refusal(put("hostile.vcd", GetParam().content)), HasSubstr(GetParam().words));
}

TEST_F(VcdTest, NoWordOfAForeignFileIsShown) {
  EXPECT_THAT(refusal(put("shadow.vcd", "root:secret:19000:0\n")), Not(HasSubstr("secret")));
}

INSTANTIATE_TEST_SUITE_P(
    Corpus, HostileVcd,
    ::testing::Values(
        BadVcd{"empty", "", "no $enddefinitions"},
        BadVcd{"binary",
               std::string("\x7f"
                           "ELF\0\0\1",
                           7),
               "it is no VCD recording"},
        BadVcd{"no_header", "#0\n1!\n#10\n", ":1: begins with no section of a header"},
        BadVcd{"half_a_header", "$timescale 1 ns $end\nwords\n",
               ":2: a VCD header was expected, not 'words'"},
        BadVcd{"no_timescale", std::string(kWires) + "$enddefinitions $end\n#0\n", "no $timescale"},
        BadVcd{"bad_timescale",
               "$timescale 7 lightyears $end\n" + std::string(kWires) + "$enddefinitions $end\n#0\n",
               ":1: $timescale"},
        BadVcd{"no_definitions_end", "$timescale 1 ns $end\n" + std::string(kWires), "no $enddefinitions"},
        BadVcd{"open_section", "$timescale 1 ns\n", "no $end"},
        BadVcd{"time_back", header() + "#0\n#20\n1!\n#10\n0!\n", ":12: time goes back to 10"},
        BadVcd{"stamp_text", header() + "#zero\n", ":9: a stamp"},
        BadVcd{"stamp_negative", header() + "#-5\n", ":9: a stamp"},
        BadVcd{"stamp_overflow", header() + "#99999999999999999999999\n", ":9: a stamp"},
        BadVcd{"unknown_id", header() + "#0\n1Z\n#1\n", ":10: unknown identifier"},
        BadVcd{"no_id", header() + "#0\n1\n#1\n", ":10: a change without"},
        BadVcd{"level_x", header() + "#0\nx!\n#1\n", ":10: galvo_x_pul has the level 'x'"},
        BadVcd{"level_z", header() + "#0\n1!\n#5\nz!\n#6\n", ":12: galvo_x_pul has the level 'z'"},
        BadVcd{"vector_x", header() + "#0\nbx !\n#1\n", ":10: galvo_x_pul has the level 'x'"},
        BadVcd{"vector_on_bit", header() + "#0\nb101 !\n#1\n", ":10: a wire of 1 bit"},
        BadVcd{"vector_cut", header() + "#0\nb1", "truncated"},
        BadVcd{"huge_width", header("$var wire 2000000000 q big $end\n") + "#0\n",
               ":7: a wire of 2000000000 bits"},
        BadVcd{"zero_width", header("$var wire 0 q none $end\n") + "#0\n", ":7: $var needs"},
        BadVcd{"wide_pul", "$timescale 1 ns $end $var wire 8 ! galvo_x_pul $end $enddefinitions $end #0",
               "1 bit"},
        BadVcd{"twice", header("$var wire 1 q galvo_x_pul $end\n") + "#0\n",
               ":7: the wire galvo_x_pul is there twice"},
        BadVcd{"missing_wire", "$timescale 1 ns $end $var wire 1 ! galvo_x_pul $end $enddefinitions $end #0",
               "no wire galvo_x_dir"},
        BadVcd{"no_stamps", header(), "no time stamps"},
        BadVcd{"glitch", header() + "#0\n1!\n0!\n#1\n", ":11: a wire changes twice"},
        BadVcd{"high_already", header() + "#0\n1!\n#1\n1!\n#2\n",
               ":12: galvo_x_pul changes to 1, which it is"},
        BadVcd{"low_already", header() + "#0\n0!\n#1\n0!\n#2\n",
               ":12: galvo_x_pul changes to 0, which it is"},
        BadVcd{"noise", header() + "#0\nhello\n", ":10: neither"},
        BadVcd{"section", header() + "#0\n$include /etc/passwd $end\n", ":10: unknown section"},
        BadVcd{"tick_zero", "$comment kerfbench tick 1/0 $end\n" + header() + "#0\n", ":1: a tick"},
        BadVcd{"tick_nonsense", "$comment kerfbench tick 1/-4 $end\n" + header() + "#0\n", ":1: a tick"},
        BadVcd{"off_tick", "$comment kerfbench tick 1/16000000 $end\n" + header() + "#0\n#624\n",
               "not on a tick"},
        BadVcd{"problem_cut", "$comment kerfbench problem 100 %4 $end\n" + header() + "#0\n",
               ":1: a problem makes"},
        BadVcd{"problem_no_hex", "$comment kerfbench problem %x9 $end\n" + header() + "#0\n",
               ":1: a problem makes"},
        BadVcd{"uart_half_a_byte", header() + "#0\n#1\n$comment kerfbench uart 5 a5b $end\n",
               ":11: bytes of a UART"},
        BadVcd{"uart_no_hex", header() + "#0\n#1\n$comment kerfbench uart 5 a5g0 $end\n",
               ":11: bytes of a UART"},
        BadVcd{"uart_goes_back",
               header() + "#0\n#1\n$comment kerfbench uart 5 a5 $end\n$comment kerfbench uart 5 a5 $end\n",
               ":12: bytes of a UART"},
        BadVcd{"uart_words_missing",
               "$comment kerfbench words 2 $end\n" + header() + "#0\n#1\n$comment kerfbench uart 5 a5 $end\n",
               "truncated"},
        BadVcd{"cut_at_end",
               "$comment kerfbench tick 1/16000000 $end\n$comment kerfbench end 9 $end\n" + header() +
                   "#0\n#625\n1!\n",
               "truncated"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_F(VcdTest, EveryTruncationOfAFileIsRefused) {
  auto recording = sampleRecording(6);
  recording.uart = {{8000, {0x00, 0xA5}}, {16000, {0x7F}}};
  writeVcd(file("whole.vcd"), recording, sampleMap());
  const auto whole = contentOf(file("whole.vcd"));
  recording = readVcd(file("whole.vcd"), sampleMap());
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    const auto path = put("cut.vcd", whole.substr(0, size));
    if (refusal(path) != "accepted") continue;
    // Only data after the end of the run may be missing.
    EXPECT_EQ(readVcd(path, sampleMap()).outputs, recording.outputs) << size;
    EXPECT_EQ(readVcd(path, sampleMap()).uart, recording.uart) << size;
  }
}

TEST_F(VcdTest, EveryFaultIsListedUpToTwenty) {
  const auto few = refusal(put("few.vcd", header() + "#0\n1Z\nx!\n#1\n"));
  EXPECT_THAT(few, HasSubstr(":10: "));
  EXPECT_THAT(few, HasSubstr(":11: "));
  std::string many = header() + "#0\n";
  for (int i = 0; i < 1000; ++i) many += "1Z\n";
  const auto text = refusal(put("many.vcd", many));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 20);
  EXPECT_THAT(text, HasSubstr("further faults left out"));
}

TEST_F(VcdTest, RandomDamageNeitherCrashesNorHangs) {
  writeVcd(file("whole.vcd"), sampleRecording(30), sampleMap());
  const auto whole = contentOf(file("whole.vcd"));
  std::uint64_t state = 99;
  for (int round = 0; round < 500; ++round) {
    auto damaged = whole;
    for (int i = 0; i < 3; ++i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      damaged[(state >> 33U) % damaged.size()] = static_cast<char>(state >> 20U);
    }
    (void)refusal(put("damaged.vcd", damaged));
  }
}

}  // namespace
}  // namespace kerfbench::source
