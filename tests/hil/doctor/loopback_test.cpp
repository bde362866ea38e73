// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/loopback.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "tests/hil/source/gpio/jumper_kernel.h"

namespace kerfbench::doctor {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class DoctorBenchTest : public testing::Test {
 protected:
  DoctorBenchTest() {
    options.loop_back = "OUT=IN";
    options.rates_hz = {5'000, 1'000, 2'000};  // In any order.
    options.seconds = 0.01;
    kernel->set_takes_ns = 5'000;
    source::GpioChipInfo chip{"/dev/gpiochip0", "gpiochip0", "sim", {}};
    for (std::uint32_t i = 0; i < 8; ++i) chip.lines.push_back({i, "", "", false, false, false});
    chip.lines[0].used = true;
    chip.lines[1].output = true;
    chip.lines[4].name = "OUT";
    chip.lines[2].name = "IN";
    chips.chips = {chip};
  }
  std::string refusal() const {
    try {
      (void)chosenLines(options, chips);
    } catch (const source::GpioError& e) {
      return e.what();
    }
    return "no error";
  }
  BenchReport measured() {
    BenchReport report;
    report.kernel = "Linux 6.1";
    report.lines = chosenLines(options, chips);
    source::PromptTrain train(kernel);
    measureRates(kernel, train, options, report);
    return report;
  }
  void addSecondChip() {
    chips.chips.push_back(chips.chips.front());
    chips.chips.back().path = "/dev/gpiochip1";
    chips.chips.back().name = "gpiochip1";
  }
  LoopbackOptions options;
  source::GpioChipList chips;
  const std::shared_ptr<source::JumperKernel> kernel = std::make_shared<source::JumperKernel>();
};

TEST_F(DoctorBenchTest, LinesAreNamedOrNumberedAndAFreeInputIsReadBesides) {
  source::LoopBackLines lines = chosenLines(options, chips);
  EXPECT_EQ(lines.out_chip, "/dev/gpiochip0");
  EXPECT_EQ(lines.in_chip, "/dev/gpiochip0");
  EXPECT_EQ(lines.out.offset, 4U);
  EXPECT_EQ(lines.in.offset, 2U);
  EXPECT_EQ(lines.beside.offset, 3U) << "0 is used, 1 is an output, 2 is IN";
  options.loop_back = "3=2";
  EXPECT_EQ(chosenLines(options, chips).beside.offset, 4U) << "3 is OUT";
  EXPECT_EQ(chosenLines(options, chips).out.name, "OUT") << "a line without a name has its role's";
  options.beside = "7";
  EXPECT_EQ(chosenLines(options, chips).beside.offset, 7U);
}

TEST_F(DoctorBenchTest, TheOutputMayBeAnotherChips) {
  addSecondChip();
  EXPECT_THAT(refusal(), HasSubstr("there are 2 gpiochips: say by --chip"));
  options.chip = "gpiochip0";
  options.out_chip = "gpiochip1";
  options.loop_back = "2=2";
  const source::LoopBackLines lines = chosenLines(options, chips);
  EXPECT_EQ(lines.out_chip, "/dev/gpiochip1");
  EXPECT_EQ(lines.in_chip, "/dev/gpiochip0");
}

TEST_F(DoctorBenchTest, EverythingThatIsWrongWithTheLinesIsSaid) {
  options.loop_back = "4";
  EXPECT_EQ(refusal(), "--loop-back is to be OUT=IN, and is '4'");
  options.loop_back = "9=XY";
  options.beside = "10";
  EXPECT_EQ(refusal(),
            "OUT: /dev/gpiochip0 has no line 9: it has 8\n"
            "IN: /dev/gpiochip0 has no line of the name 'XY'\n"
            "beside: /dev/gpiochip0 has no line 10: it has 8");
  for (const auto& [wires, beside] : {std::pair{"4=4", "5"}, {"4=5", "5"}, {"4=5", "4"}}) {
    options.loop_back = wires;
    options.beside = beside;
    EXPECT_EQ(refusal(), "OUT, IN and the line that is read besides are to be three lines");
  }
  options.beside = "";
  options.loop_back = "4=5";
  chips.chips[0].lines.resize(6);
  chips.chips[0].lines[2].used = chips.chips[0].lines[3].used = true;
  EXPECT_THAT(refusal(), HasSubstr("has no further free input"));
  chips.chips.clear();
  chips.faults = {"/dev/gpiochip0: not allowed", "/dev/gpiochip1: the chip has gone"};
  EXPECT_EQ(refusal(),
            "this computer has no gpiochip that can be read\n/dev/gpiochip0: not allowed\n"
            "/dev/gpiochip1: the chip has gone");
}

TEST_F(DoctorBenchTest, RatesGrowUntilTheLastAndNothingIsLost) {
  const BenchReport report = measured();
  ASSERT_THAT(report.steps, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(report.steps[i].held());
  EXPECT_EQ(report.steps[0].driven, 10U);
  EXPECT_EQ(report.steps[2].driven, 50U);
  EXPECT_DOUBLE_EQ(sustained(report)->driven_hz, 5'000.0);
  EXPECT_EQ(stampBound(report)->edges, 80U);
  EXPECT_EQ(stampBound(report)->stamp_err_us, 4U) << "3 us, and more than the worst that was seen";
  EXPECT_EQ(kernel->real_time, 0) << "real time only while it measures";
  EXPECT_THAT(
      benchText(report),
      AllOf(HasSubstr("/dev/gpiochip0 line 4 (OUT) drives /dev/gpiochip0 line 2 (IN); /dev/gpiochip0 "
                      "line 3 (beside) is read besides"),
            HasSubstr("| 1000 | 1000 | 10 | 10 |"), HasSubstr("| 5000 | 50 | 0.0 to 3.0 | 0.0 to 3.0 |"),
            HasSubstr("5000 edges/s without loss; nothing faster was tried\n"),
            HasSubstr("stamp_err_us: 4   # Upper bound of the worst of 80 edges"), HasSubstr("3.8 %"),
            Not(HasSubstr("VIRTUAL"))));
}

TEST_F(DoctorBenchTest, TheFirstRateWithLossEndsIt) {
  kernel->merged = {30, 31};
  const BenchReport report = measured();
  ASSERT_THAT(report.steps, SizeIs(3));
  EXPECT_FALSE(report.steps[2].held());
  EXPECT_DOUBLE_EQ(sustained(report)->driven_hz, 2'000.0);
  EXPECT_EQ(stampBound(report)->edges, 30U);
  const std::string text = benchText(report);
  EXPECT_THAT(text,
              AllOf(HasSubstr("| 5000 | 5000 | 50 | 48 |"), Not(HasSubstr("| 5000 | 48 |")),
                    HasSubstr("2000 edges/s without loss; at 5000 edges/s:\n  2 edges lost in the kernel")));
  kernel->merged = {2, 3};
  EXPECT_THAT(measured().steps, SizeIs(1));
}

TEST_F(DoctorBenchTest, WithoutARateThatHoldsThereIsNoFigure) {
  kernel->silent = true;
  const BenchReport report = measured();
  EXPECT_EQ(sustained(report), nullptr);
  EXPECT_FALSE(stampBound(report));
  EXPECT_THAT(benchText(report),
              AllOf(HasSubstr("no rate was held; at 1000 edges/s:"),
                    HasSubstr("10 edges were driven, and 0 were read"), Not(HasSubstr("stamp_err_us"))));
  const auto json = nlohmann::json::parse(benchJson(report));
  EXPECT_FALSE(json.contains("sustained_hz"));
  EXPECT_FALSE(json.contains("stamp_err_us"));
  EXPECT_THAT(json["rates"][0]["problems"], SizeIs(1));
}

TEST_F(DoctorBenchTest, AnOutputThatIsTooSlowIsNoLoss) {
  kernel->set_takes_ns = 400'000;
  const BenchReport report = measured();
  ASSERT_THAT(report.steps, SizeIs(3));
  EXPECT_THAT(benchText(report),
              AllOf(HasSubstr("2500 edges/s without loss; the output cannot be driven at 5000\n"),
                    HasSubstr("| 5000 | 2500 | 50 | 50 |")));
}

TEST_F(DoctorBenchTest, WhereItWasMeasuredAndWhatWasNotAllowedIsSaid) {
  kernel->priority_error = EPERM;
  kernel->beside = 2;
  BenchReport report = measured();
  report.virtual_machine = "its maker is 'QEMU'";
  EXPECT_THAT(benchText(report),
              AllOf(HasSubstr("MEASURED IN A VIRTUAL MACHINE (its maker is 'QEMU'): no machine's figures\n"),
                    HasSubstr("note: no real-time priority"),
                    HasSubstr("line 3 (beside) had 6 edges of its own: name one by --beside")));
  const auto json = nlohmann::json::parse(benchJson(report));
  EXPECT_EQ(json["virtual_machine"], "its maker is 'QEMU'");
  EXPECT_EQ(json["real_time"], false);
  EXPECT_EQ(json["sustained_hz"], 5'000.0);
  EXPECT_EQ(json["rates"][1]["stamp_late"]["at_most"]["worst_us"], 3.0);
  EXPECT_EQ(json["out"]["line"], 4);
}

TEST_F(DoctorBenchTest, WithoutAJumperNothingIsMeasured) {
  kernel->plugged = false;
  try {
    (void)measured();
    ADD_FAILURE() << "no error";
  } catch (const source::GpioError& e) {
    EXPECT_THAT(e.what(), HasSubstr("the jumper is missing"));
  }
  EXPECT_EQ(kernel->real_time, 0);
}

TEST_F(DoctorBenchTest, AChipThatVanishesEndsItInWords) {
  kernel->vanishes_at = 12;
  try {
    (void)measured();
    ADD_FAILURE() << "no error";
  } catch (const source::GpioError& e) {
    EXPECT_THAT(e.what(), HasSubstr("the chip has gone while its lines were driven"));
  }
}

}  // namespace
}  // namespace kerfbench::doctor
