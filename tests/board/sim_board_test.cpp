// SPDX-License-Identifier: Apache-2.0
// Test of SimBoard. The files are ordinary ones here, the terminal is the kernel's.
#include "tests/board/sim_board.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace kerfbench::board {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class SimBoardTest : public testing::Test {
 protected:
  SimBoardTest() : folder(fs::path(testing::TempDir()) / ("sim_board_" + std::to_string(::getpid()))) {
    fs::create_directories(folder / "sim_gpio3");
    fs::create_directories(folder / "sim_gpio4");
    write("sim_gpio3/value", "0\n");
    write("sim_gpio4/pull", "pull-down\n");
  }
  ~SimBoardTest() override { fs::remove_all(folder); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  std::string textOf(const std::string& name) const {
    std::ifstream file(folder / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const fs::path folder;
  const std::map<Signal, unsigned> lines{{Signal::kPrintMark, 3}, {Signal::kGalvoXPul, 4}};
};

TEST_F(SimBoardTest, OutputsPullLinesAndInputsAreTheirLevels) {
  SimBoard board(folder, lines, folder / "tty");
  EXPECT_FALSE(board.level(Signal::kPrintMark));
  write("sim_gpio3/value", "1\n");
  EXPECT_TRUE(board.level(Signal::kPrintMark));
  board.put(Signal::kGalvoXPul, true);
  EXPECT_TRUE(textOf("sim_gpio4/pull").starts_with("pull-up"));
  board.put(Signal::kGalvoXPul, false);
  EXPECT_TRUE(textOf("sim_gpio4/pull").starts_with("pull-down"));
}

TEST_F(SimBoardTest, TheUartIsATerminalThatCarriesBytesAsTheyAre) {
  SimBoard board(folder, lines, folder / "tty");
  EXPECT_THAT(board.receive(), IsEmpty());
  const int bench = ::open((folder / "tty").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(bench, 0);
  const std::vector<std::uint8_t> bytes{0, 3, 10, 13, 17, 255};
  ASSERT_EQ(::write(bench, bytes.data(), bytes.size()), 6);
  EXPECT_EQ(board.receive(), bytes);
  board.send(bytes);
  std::vector<std::uint8_t> seen(16);
  ASSERT_EQ(::read(bench, seen.data(), seen.size()), 6);
  seen.resize(6);
  EXPECT_EQ(seen, bytes);
  ::close(bench);
  // The bench may go and come again.
  EXPECT_THAT(board.receive(), IsEmpty());
}

TEST_F(SimBoardTest, ALineThatTheChipDoesNotHaveIsNamed) {
  try {
    const SimBoard board(folder, {{Signal::kGalvoXPul, 9}}, folder / "tty");
    FAIL();
  } catch (const std::system_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("sim_gpio9/pull"));
  }
}

}  // namespace
}  // namespace kerfbench::board
