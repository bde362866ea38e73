// SPDX-License-Identifier: Apache-2.0
// Programs in the second reader's place that break in every way that a program can: each is told in a
// sentence and witnesses nothing.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/exit_codes.h"
#include "tests/hil/witness/programs.h"

namespace kerfbench::witness {
namespace {

using testing::HasSubstr;
using Kind = Testimony::Kind;

/// A line of 30 mm on layer CUT.
const std::string kThirtyLong = dieline::dxf("0|LINE|8|CUT|10|0|20|0|11|30|21|0");

struct StandInCase {
  const char* name;
  std::string script;
  Kind kind;
  const char* words;
};

std::string sh(const std::string& commands) { return "#!/bin/sh\n" + commands + "\n"; }
std::string says(const std::string& text) { return sh("cat <<'END'\n" + text + "\nEND"); }
/// The true answer for kThirtyLong with another length and box.
std::string answer(const std::string& length, const std::string& box) {
  return R"({"reader": "stand-in", "mm_per_unit": 1, "groups": [{"names": ["CUT"], "colours": ["7"],
    "linetype": "CONTINUOUS", "plotted": true, "count": 1, "length_mm": )" +
         length + ", \"box_mm\": " + box + R"(}], "unread": [], "remarks": []})";
}

const StandInCase kStandIns[] = {
    {"TheTruth", says(answer("30.0", "[0, 0, 30, 0]")), Kind::kAgrees, "agrees on 1 layer, 30.000 mm"},
    {"WrongLength", says(answer("30.0011", "[0, 0, 30, 0]")), Kind::kParts,
     "layer 'CUT' (cut): this reader finds 30.000000 mm of lines, the second one 30.001100 mm"},
    {"WrongBox", says(answer("30.0", "[0, 0.0011, 30, 0.0011]")), Kind::kParts, "reach over"},
    {"Garbage", says("cut everything"), Kind::kBroken, "is no JSON"},
    {"Nothing", sh(":"), Kind::kBroken, "is no JSON"},
    {"Bytes", sh("head -c 4096 /bin/sh"), Kind::kBroken, "is no JSON"},
    {"Endless", sh("exec yes"), Kind::kBroken, "printed more than 65536 bytes"},
    {"EndlessComplaint", sh("yes >&2"), Kind::kBroken, "printed more than 65536 bytes"},
    {"NotANumber", says(answer("NaN", "[0, 0, 30, 0]")), Kind::kBroken, "is no JSON"},
    {"TooLargeANumber", says(answer("1e999", "[0, 0, 30, 0]")), Kind::kBroken, "is no JSON"},
    {"NegativeLength", says(answer("-30", "[0, 0, 30, 0]")), Kind::kBroken, "a length that is not > 0"},
    {"TextForALength", says(answer("\"30\"", "[0, 0, 30, 0]")), Kind::kBroken, "has no number for length_mm"},
    {"BoxOfThree", says(answer("30", "[0, 0, 30]")), Kind::kBroken, "not of four numbers"},
    {"BoxInsideOut", says(answer("30", "[30, 0, 0, 0]")), Kind::kBroken, "inside out"},
    {"Nested", sh("head -c 60000 /dev/zero | tr '\\0' '['"), Kind::kBroken, "nested too deeply"},
    {"Failing", sh("echo 'ImportError: something' >&2; exit 1"), Kind::kBroken,
     "ended with exit status 1: ImportError: something"},
    {"FailingInTheEnd", says(answer("30.0", "[0, 0, 30, 0]")) + "exit 1\n", Kind::kBroken, "exit status 1"},
    {"Killed", sh("kill -SEGV $$"), Kind::kBroken, "was ended by the signal"},
    {"Waiting", sh("exec sleep 1000"), Kind::kBroken, "did not end within 0.3 s"},
    {"WaitingDeafly", sh("exec >&- 2>&-; exec sleep 1000"), Kind::kBroken, "did not end within 0.3 s"},
    {"LeavingAChild", sh("sleep 1000 &\n") + "exit 0\n", Kind::kBroken, "did not end within 0.3 s"},
    {"MissingPackage", says(R"({"missing": "python3-ezdxf"})"), Kind::kMissing,
     "apt-get install python3-ezdxf"},
    {"MissingAndMore", says(R"({"missing": "python3-ezdxf", "groups": []})"), Kind::kBroken, "keys missing"},
    {"Refusing", says(R"({"refused": "DXFError: too new"})"), Kind::kParts, "cannot read the drawing"},
    {"NoProgram", "#!/nonexistent/python\n", Kind::kMissing, "cannot be started"},
};

class StandIns : public testing::TestWithParam<StandInCase> {};

TEST_P(StandIns, AreToldAndWitnessNothing) {
  const dieline::TempFile drawing(".dxf", kThirtyLong);
  const StandIn stand_in(GetParam().script);
  WitnessProgram program = stand_in.program();
  program.limits = {.cpu_s = 20, .deadline_s = 60, .memory_bytes = 512U << 20U, .output_bytes = 65536};
  if (std::string_view(GetParam().name).starts_with("Waiting") ||
      std::string_view(GetParam().name) == "LeavingAChild")
    program.limits.deadline_s = 0.3;
  const Testimony testimony =
      testimonyOf(dieline::readDieline(drawing.path(), dieline::DrawingOptions{}), {}, program);
  EXPECT_EQ(testimony.kind, GetParam().kind) << allSentences(testimony);
  ASSERT_FALSE(testimony.sentences.empty());
  EXPECT_THAT(testimony.sentences.front(), HasSubstr(GetParam().words));
  EXPECT_LT(allSentences(testimony).size(), 2000U);
}

INSTANTIATE_TEST_SUITE_P(All, StandIns, testing::ValuesIn(kStandIns),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(StandInLimits, OneThatComputesForEverIsStoppedByItsProcessorTime) {
  const dieline::TempFile drawing(".dxf", kThirtyLong);
  const StandIn stand_in(sh("while :; do :; done"));
  WitnessProgram program = stand_in.program();
  program.limits.cpu_s = 1;
  const Testimony testimony =
      testimonyOf(dieline::readDieline(drawing.path(), dieline::DrawingOptions{}), {}, program);
  EXPECT_EQ(testimony.kind, Kind::kBroken);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("took more than 1 s of processor"));
}

TEST(StandInLimits, OneThatWantsAllMemoryIsStopped) {
  const dieline::TempFile drawing(".dxf", kThirtyLong);
  const StandIn stand_in("#!/usr/bin/python3\nx = bytearray(1 << 30)\n");
  WitnessProgram program = stand_in.program();
  program.limits.memory_bytes = 256U << 20U;
  const Testimony testimony =
      testimonyOf(dieline::readDieline(drawing.path(), dieline::DrawingOptions{}), {}, program);
  EXPECT_EQ(testimony.kind, Kind::kBroken);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("wanted more than 256 MiB of memory"));
}

/// Nothing of the user's environment reaches the second reader.
TEST(StandInLimits, TheEnvironmentIsItsOwn) {
  const dieline::TempFile drawing(".dxf", kThirtyLong);
  const StandIn stand_in(sh("env | tr '\\n' ' ' >&2; exit 3"));
  ::setenv("PYTHONPATH", "/tmp/evil", 1);
  const Testimony testimony =
      testimonyOf(dieline::readDieline(drawing.path(), dieline::DrawingOptions{}), {}, stand_in.program());
  ::unsetenv("PYTHONPATH");
  EXPECT_THAT(testimony.sentences.front(), testing::Not(HasSubstr("PYTHONPATH")));
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("PATH=/usr/bin:/bin"));
}

TEST(StandInLimits, WithoutPythonOrScriptTheMissingIsNamed) {
  const dieline::TempFile drawing(".dxf", kThirtyLong);
  const dieline::Dieline read = dieline::readDieline(drawing.path(), dieline::DrawingOptions{});
  WitnessProgram program = realWitness();
  program.python = "/nonexistent/python3";
  Testimony testimony = testimonyOf(read, {}, program);
  EXPECT_EQ(testimony.kind, Kind::kMissing);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("apt-get install python3"));
  program = realWitness();
  program.script = "/nonexistent/second_reader.py";
  testimony = testimonyOf(read, {}, program);
  EXPECT_EQ(testimony.kind, Kind::kMissing);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("./bench setup"));
}

/// The real script in a Python that finds no packages.
TEST(StandInLimits, AMissingLibraryIsNamedByItsPackage) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not installed";
  const StandIn bare(sh("shift 2; exec /usr/bin/python3 -I -S -B \"$@\""));
  WitnessProgram program = realWitness();
  program.python = bare.program().python;
  const dieline::TempFile dxf(".dxf", kThirtyLong);
  Testimony testimony = testimonyOf(dieline::readDieline(dxf.path(), dieline::DrawingOptions{}), {}, program);
  EXPECT_EQ(testimony.kind, Kind::kMissing);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("apt-get install python3-ezdxf"));
  const dieline::TempFile svg(".svg", dieline::svg("<path d='M0 0L9 9' stroke='#ff0000'/>"));
  testimony = testimonyOf(dieline::readDieline(svg.path(), dieline::DrawingOptions{}), {}, program);
  EXPECT_EQ(testimony.kind, Kind::kMissing);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("apt-get install python3-svgelements"));
}

TEST(StandInLimits, ExitCodesAreThoseOfThePage) {
  EXPECT_EQ(exitCodeOf(Kind::kAgrees), 0);
  EXPECT_EQ(exitCodeOf(Kind::kParts), base::kExitInput);
  EXPECT_EQ(exitCodeOf(Kind::kMissing), base::kExitBroken);
  EXPECT_EQ(exitCodeOf(Kind::kBroken), base::kExitBroken);
}

}  // namespace
}  // namespace kerfbench::witness
