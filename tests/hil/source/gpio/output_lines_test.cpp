// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/output_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/hil/source/gpio/scripted_kernel.h"
#include "tests/hil/source/words_of.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OutputLinesTest : public testing::Test {
 protected:
  OutputLines open(std::vector<ChipLine> lines = {{4, "a"}, {5, "b"}, {7, "mark"}},
                   const std::vector<bool>& levels = {true, false, true}) {
    return {kernel, "/dev/gpiochip1", std::move(lines), levels};
  }
  void TearDown() override { EXPECT_THAT(kernel->open_fds, IsEmpty()); }
  const std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
};

TEST_F(OutputLinesTest, AsksForAllLinesInOneRequestWithTheirLevelsAtTheStart) {
  (void)open();
  const gpio_v2_line_request& request = kernel->output_request;
  ASSERT_EQ(request.num_lines, 3U);
  EXPECT_EQ(request.offsets[2], 7U);
  EXPECT_EQ(request.config.flags, std::uint64_t{GPIO_V2_LINE_FLAG_OUTPUT});
  ASSERT_EQ(request.config.num_attrs, 1U);
  EXPECT_EQ(request.config.attrs[0].attr.id, std::uint32_t{GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES});
  EXPECT_EQ(request.config.attrs[0].mask, 0b111U);
  EXPECT_EQ(request.config.attrs[0].attr.values, 0b101U);
  EXPECT_STREQ(request.consumer, "kerfbench");
}

TEST_F(OutputLinesTest, LinesThatChangeTogetherDoSoInOneCall) {
  OutputLines lines = open();
  lines.set({{0, false}, {2, true}});
  lines.set({{1, true}});
  EXPECT_THAT(kernel->driven, ElementsAre(ScriptedKernel::Driven{ScriptedKernel::kStart_ns, 0b101, 0b100},
                                          ScriptedKernel::Driven{ScriptedKernel::kStart_ns, 0b010, 0b010}));
}

TEST_F(OutputLinesTest, EveryLineThatIsTakenOrNotThereIsRefused) {
  kernel->taken = {{4, "spi0 CS0"}, {7, ""}};
  EXPECT_EQ(wordsOf<GpioError>([&] { open(); }),
            "/dev/gpiochip1: line 4 for a is taken by 'spi0 CS0'\n"
            "/dev/gpiochip1: line 7 for mark is taken by somebody who gives no name");
  EXPECT_THAT(wordsOf<GpioError>([&] {
                open({{12, "a"}}, {false});
              }),
              HasSubstr("there is no line 12 for a"));
  EXPECT_THAT(wordsOf<GpioError>([&] { open({}, {}); }), HasSubstr("must be 1 to 64"));
  kernel->open_error = EACCES;
  EXPECT_THAT(wordsOf<GpioError>([&] { open(); }), HasSubstr("udev"));
}

TEST_F(OutputLinesTest, SaysWhyLinesCannotBeOutputs) {
  const std::vector<std::pair<int, const char*>> cases{
      {EBUSY, "taken by someone else"},      {EACCES, "may not be used as outputs"},
      {EPERM, "may not be used as outputs"}, {EINVAL, "cannot be an output"},
      {EOPNOTSUPP, "cannot be an output"},   {ENXIO, "cannot be an output"},
      {ENOTTY, "second GPIO interface"},     {ENODEV, "has gone"},
      {ENOMEM, "Cannot allocate memory"}};
  for (const auto& [error, words] : cases) {
    kernel->output_error = error;
    EXPECT_THAT(wordsOf<GpioError>([&] { open(); }), AllOf(HasSubstr("/dev/gpiochip1: "), HasSubstr(words)));
  }
}

TEST_F(OutputLinesTest, AChipThatVanishesIsTold) {
  OutputLines lines = open();
  kernel->set_error = ENODEV;
  EXPECT_THAT(wordsOf<GpioError>([&] {
                lines.set({{0, false}});
              }),
              HasSubstr("has gone while its lines were driven"));
  kernel->set_error = EIO;
  EXPECT_THAT(wordsOf<GpioError>([&] { lines.set({{0, false}}); }), HasSubstr("can no longer be driven"));
}

}  // namespace
}  // namespace kerfbench::source
