// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/line_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <cerrno>

#include "tests/hil/source/gpio/scripted_kernel.h"
#include "tests/hil/source/words_of.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::chrono::milliseconds kWait{10};

class LineRequestTest : public testing::Test {
 protected:
  LineRequest open(std::vector<ChipLine> lines = {{4, "pul"}, {5, "dir"}}) {
    return {kernel, "/dev/gpiochip0", std::move(lines)};
  }
  std::string refusal(std::vector<ChipLine> lines = {{4, "pul"}, {5, "dir"}}) {
    return wordsOf<GpioError>([&] { open(std::move(lines)); });
  }
  std::string readFault() {
    LineRequest request = open();
    std::vector<KernelEdge> edges;
    return wordsOf<GpioError>([&] { request.read(kWait, edges); });
  }
  void TearDown() override { EXPECT_THAT(kernel->open_fds, IsEmpty()); }
  const std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
};

TEST_F(LineRequestTest, AsksForAllLinesInOneRequestWithBothEdgesAndTheLargestBuffer) {
  (void)open();
  EXPECT_EQ(kernel->request.num_lines, 2U);
  EXPECT_EQ(kernel->request.offsets[0], 4U);
  EXPECT_EQ(kernel->request.offsets[1], 5U);
  EXPECT_EQ(kernel->request.event_buffer_size, 1024U);
  EXPECT_EQ(kernel->request.config.flags,
            std::uint64_t{GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING |
                          GPIO_V2_LINE_FLAG_EDGE_FALLING});
  EXPECT_EQ(kernel->request.config.num_attrs, 0U);
  EXPECT_STREQ(kernel->request.consumer, "kerfbench");
}

TEST_F(LineRequestTest, ALineOfItsOwnWouldHideMergedEdges) {
  EXPECT_THAT(refusal({{4, "pul"}}), HasSubstr("must be 2 to 64"));
  EXPECT_THAT(refusal(std::vector<ChipLine>(65)), HasSubstr("must be 2 to 64"));
}

TEST_F(LineRequestTest, SaysWhyAChipCannotBeOpened) {
  const std::vector<std::pair<int, const char*>> cases{
      {ENOENT, "no such chip"}, {EACCES, "udev"},    {EPERM, "group gpio"},
      {ENODEV, "has gone"},     {ENXIO, "has gone"}, {EMFILE, "Too many open files"}};
  for (const auto& [error, words] : cases) {
    kernel->open_error = error;
    EXPECT_THAT(refusal(), AllOf(HasSubstr("/dev/gpiochip0: "), HasSubstr(words)));
  }
}

TEST_F(LineRequestTest, AFileThatIsNoChipIsCalledSo) {
  for (const int error : {ENOTTY, EINVAL}) {
    kernel->chip_error = error;
    EXPECT_EQ(refusal(), "/dev/gpiochip0: is no gpiochip");
  }
  kernel->chip_error = ENODEV;
  EXPECT_THAT(refusal(), HasSubstr("has gone"));
  kernel->chip_error = EIO;
  EXPECT_THAT(refusal(), HasSubstr("Input/output error"));
}

TEST_F(LineRequestTest, AnOldKernelIsRefusedBecauseItsFirstInterfaceLosesEdges) {
  for (const int error : {ENOTTY, EINVAL}) {
    kernel->line_info_error = error;
    EXPECT_THAT(refusal(), HasSubstr("second GPIO interface"));
  }
  kernel->line_info_error = ENODEV;
  EXPECT_THAT(refusal(), HasSubstr("has gone"));
  kernel->line_info_error = EIO;
  EXPECT_THAT(refusal(), HasSubstr("Input/output error"));
  kernel->line_info_error = 0;
  kernel->request_error = ENOTTY;
  EXPECT_THAT(refusal(), HasSubstr("second GPIO interface"));
}

TEST_F(LineRequestTest, EveryLineThatIsTakenIsNamedWithWhoHasIt) {
  kernel->taken = {{4, "spi0 CS0"}, {5, ""}, {6, "not ours"}};
  EXPECT_EQ(refusal(),
            "/dev/gpiochip0: line 4 for pul is taken by 'spi0 CS0'\n"
            "/dev/gpiochip0: line 5 for dir is taken by somebody who gives no name");
}

TEST_F(LineRequestTest, ALineBeyondTheChipIsRefused) {
  EXPECT_EQ(refusal({{4, "pul"}, {12, "dir"}}),
            "/dev/gpiochip0: there is no line 12 for dir, it has 12 lines");
}

TEST_F(LineRequestTest, SaysWhyLinesCannotBeHad) {
  const std::vector<std::pair<int, const char*>> cases{{EBUSY, "taken by someone else"},
                                                       {EACCES, "may not be used"},
                                                       {EPERM, "may not be used"},
                                                       {ENXIO, "interrupts on both"},
                                                       {EINVAL, "interrupts on both"},
                                                       {EOPNOTSUPP, "interrupts on both"},
                                                       {ENODEV, "has gone"},
                                                       {ENOMEM, "Cannot allocate memory"}};
  for (const auto& [error, words] : cases) {
    kernel->request_error = error;
    EXPECT_THAT(refusal(), HasSubstr(words));
  }
}

TEST_F(LineRequestTest, EdgesComeAsTheKernelTellsThem) {
  kernel->toggle(1'000'000'100, 5);
  kernel->toggle(1'000'000'200, 4);
  LineRequest request = open();
  std::vector<KernelEdge> edges;
  while (edges.size() < 2) ASSERT_TRUE(request.read(kWait, edges));
  EXPECT_EQ(edges[0].stamp_ns, 1'000'000'100U);
  EXPECT_EQ(edges[0].line, 1U);
  EXPECT_TRUE(edges[0].level);
  EXPECT_EQ(edges[1].line, 0U);
  EXPECT_EQ(edges[1].seqno, 2U);
  EXPECT_EQ(edges[1].line_seqno, 1U);
  EXPECT_FALSE(request.read(kWait, edges));
}

TEST_F(LineRequestTest, AnInterruptedWaitOrReadIsNoError) {
  LineRequest request = open();
  std::vector<KernelEdge> edges;
  kernel->poll_error = EINTR;
  EXPECT_FALSE(request.read(kWait, edges));
  for (const int error : {EINTR, EAGAIN}) {
    kernel->toggle(1'000'000'100, 4);
    kernel->read_error = error;
    EXPECT_FALSE(request.read(kWait, edges));
    EXPECT_TRUE(request.read(kWait, edges));
  }
  EXPECT_EQ(edges.size(), 2U);
}

TEST_F(LineRequestTest, AChipThatVanishesIsTold) {
  for (const int revents : {POLLERR, POLLHUP, POLLERR | POLLHUP, POLLNVAL}) {
    kernel->poll_revents = static_cast<short>(revents);
    EXPECT_THAT(readFault(), HasSubstr("the chip has gone while"));
  }
  kernel->poll_revents = POLLPRI;
  EXPECT_THAT(readFault(), HasSubstr("can no longer be read"));
  kernel->poll_revents = POLLIN | POLLHUP;
  kernel->read_error = ENODEV;
  EXPECT_THAT(readFault(), HasSubstr("the chip has gone while"));
  kernel->poll_revents = 0;
  kernel->poll_error = ENOMEM;
  EXPECT_THAT(readFault(), HasSubstr("Cannot allocate memory"));
}

TEST_F(LineRequestTest, LevelsAreThoseOfTheLinesAsAskedFor) {
  kernel->level_bits = 0b10;
  EXPECT_THAT(open().levels(), ElementsAre(false, true));
  kernel->levels_error = ENODEV;
  EXPECT_THAT(wordsOf<GpioError>([&] { open().levels(); }), HasSubstr("the chip has gone"));
}

TEST_F(LineRequestTest, HalfAnEdgeIsNone) {
  for (const int bytes : {0, 1, 47, 49}) {
    kernel->poll_revents = POLLIN;
    kernel->read_bytes = {bytes};
    EXPECT_THAT(readFault(), HasSubstr("no whole number of edges")) << bytes;
  }
}

TEST_F(LineRequestTest, EdgesThatNobodyAskedForAreRefused) {
  kernel->edge(1'000'000'100, 7, true, 1, 1, 1'000'000'100);
  EXPECT_THAT(readFault(), HasSubstr("on line 7, which nobody asked for"));
  // The answer has 48 bytes of zeros: an edge of no kind on line 0.
  kernel->poll_revents = POLLIN;
  kernel->read_bytes = {48};
  EXPECT_THAT(readFault(), HasSubstr("of kind 0 on line 0"));
}

TEST_F(LineRequestTest, TheDoctorCanAskWhetherAChipsEdgesCanBeRead) {
  EXPECT_EQ(edgeTrouble(*kernel, "/dev/gpiochip0"), "");
  kernel->line_info_error = ENOTTY;
  EXPECT_THAT(edgeTrouble(*kernel, "/dev/gpiochip0"), HasSubstr("second GPIO interface"));
  kernel->open_error = EACCES;
  EXPECT_THAT(edgeTrouble(*kernel, "/dev/gpiochip0"), HasSubstr("udev"));
}

}  // namespace
}  // namespace kerfbench::source
