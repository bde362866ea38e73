// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/c_header.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "hil/base/atomic_file.h"
#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

namespace fs = std::filesystem;

AimGrid seeded(std::uint64_t seed, std::size_t columns = 33, std::size_t rows = 17,
               Between between = Between::kHermite, Outside outside = Outside::kRefused) {
  return SeededHead(seed, 150, 6).table(evenly(-150, 150, columns), evenly(-60, 75, rows), between, outside);
}

TEST(CHeader, ReadsBackToItsUnit) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    for (const auto outside : {Outside::kRefused, Outside::kClamped, Outside::kLinear}) {
      const AimGrid grid = seeded(seed, 33, 17, seed == 1 ? Between::kBilinear : Between::kHermite, outside);
      const AimGrid fine = parseCHeader(cHeader(grid, {.value = CHeaderOptions::Value::kInt32}), "a.h");
      EXPECT_EQ(fine.between(), grid.between());
      EXPECT_EQ(fine.outside(), outside);
      double largest = 0.0;
      for (std::size_t i = 0; i < grid.d_mm().size(); ++i) {
        largest = std::max(largest, grid.d_mm()[i].cwiseAbs().maxCoeff());
        EXPECT_LE((fine.d_mm()[i] - grid.d_mm()[i]).cwiseAbs().maxCoeff(), 0.5000001e-6);
      }
      const AimGrid coarse = parseCHeader(cHeader(grid), "a.h");
      const double unit_mm = 1e-6 * std::ceil(1e6 * largest / 32767);
      for (std::size_t i = 0; i < grid.d_mm().size(); ++i)
        EXPECT_LE((coarse.d_mm()[i] - grid.d_mm()[i]).cwiseAbs().maxCoeff(), 0.5000001 * unit_mm);
    }
  }
}

class CompiledHeader : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] int run(const std::string& command) const {
    return std::system(
        ("cd '" + folder_.string() + "' && " + command).c_str());  // NOLINT(concurrency-mt-unsafe)
  }
  [[nodiscard]] std::string text(const char* name) const {
    std::ostringstream all;
    all << std::ifstream(folder_ / name).rdbuf();
    return all.str();
  }
  void put(const char* name, const std::string& text) const {
    base::writeFileAtomically(folder_ / name, text);
  }

  fs::path folder_;
};

TEST_F(CompiledHeader, IsCAndCppWithoutAWarningAndHoldsTheNumbers) {
  const AimGrid grid = seeded(5);
  put("table.h", cHeader(grid, {.unit_nm = 500, .prefix = "HEAD_1"}));
  put("unused.c", "#include \"table.h\"\nint main(void) { return 0; }\n");
  put("show.c",
      "#include <stdio.h>\n#include \"table.h\"\nint main(void) {\n"
      "  for (int i = 0; i < HEAD_1_ROWS * HEAD_1_COLUMNS; ++i)\n"
      "    printf(\"%ld %ld %ld %ld\\n\", (long)HEAD_1_X_NM[i % HEAD_1_COLUMNS], "
      "(long)HEAD_1_Y_NM[i / HEAD_1_COLUMNS],\n"
      "           (long)HEAD_1_DX[i] * HEAD_1_UNIT_NM, (long)HEAD_1_DY[i] * HEAD_1_UNIT_NM);\n"
      "  return 0;\n}\n");
  const std::string flags = " -Wall -Wextra -Wpedantic -Wconversion -Werror ";
  EXPECT_EQ(run("gcc -std=c99" + flags + "-fsyntax-only unused.c"), 0);
  EXPECT_EQ(run("g++ -std=c++11" + flags + "-fsyntax-only -x c++ show.c"), 0);
  ASSERT_EQ(run("gcc -std=c99" + flags + "show.c -o show && ./show > shown"), 0);
  std::istringstream shown(text("shown"));
  for (std::size_t i = 0; i < grid.d_mm().size(); ++i) {
    double x = 0, y = 0, dx = 0, dy = 0;
    ASSERT_TRUE(shown >> x >> y >> dx >> dy);
    EXPECT_NEAR(x / 1e6, grid.x_mm()[i % 33], 0.51e-6);
    EXPECT_NEAR(y / 1e6, grid.y_mm()[i / 33], 0.51e-6);
    EXPECT_NEAR(dx / 1e6, grid.d_mm()[i].x(), 0.251e-3);
    EXPECT_NEAR(dy / 1e6, grid.d_mm()[i].y(), 0.251e-3);
  }
}

TEST_F(CompiledHeader, LiesInTheFlashOfAnAvr) {
  const std::string avr =
      std::string(KERFBENCH_AVR_GCC) + " -std=gnu11 -mmcu=atmega2560 -Os -Wall -Wextra -Werror ";
  put("table.h", cHeader(seeded(6, 65, 65)));
  put("use.c",
      "#include \"table.h\"\nint16_t use(uint16_t i) {\n"
      "  return (int16_t)pgm_read_word(&KB_CORRECTION_DX[i]) + "
      "(int16_t)pgm_read_word(&KB_CORRECTION_DY[i]);\n}\n");
  ASSERT_EQ(run(avr + "-c use.c -o use.o"), 0);
  // The program's memory holds read-only tables, 2 x 65 x 65 x 2 bytes; nothing is in RAM.
  ASSERT_EQ(run("avr-size -A use.o > sizes"), 0);
  std::istringstream sizes(text("sizes"));
  long flash = 0;
  for (std::string word; sizes >> word;) {
    long bytes = 0;
    if (word.starts_with(".progmem") && sizes >> bytes) flash += bytes;
    if (word == ".data" || word == ".bss" || word == ".rodata") {
      ASSERT_TRUE(sizes >> bytes);
      EXPECT_EQ(bytes, 0) << word;
    }
  }
  EXPECT_EQ(flash, 2 * 65 * 65 * 2);
}

TEST(CHeader, SaysWhatItCannotHold) {
  const AimGrid grid = seeded(1, 129, 129);
  EXPECT_THROW((void)cHeader(grid), std::invalid_argument);
  EXPECT_NO_THROW((void)cHeader(grid, {.most_array_bytes = 1U << 20U}));
  try {
    (void)cHeader(grid, {.unit_nm = 1, .prefix = "1 no"});
    FAIL();
  } catch (const std::invalid_argument& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("the prefix must be"), std::string::npos) << what;
    EXPECT_NE(what.find("129 x 129 nodes make an array of 33282 bytes, more than 32767"), std::string::npos)
        << what;
    EXPECT_NE(what.find("does not fit in units of 1 nm"), std::string::npos) << what;
  }
}

TEST(CHeader, AChangedNumberIsNoticed) {
  std::string text = cHeader(seeded(1, 5, 5));
  const auto at = text.find("_DY[");
  const auto digit = text.find_first_of("123456789", text.find('{', at));
  text[digit] = text[digit] == '1' ? '2' : '1';
  EXPECT_EQ(faultsOf([&] { (void)parseCHeader(text, "a.h"); }),
            "a.h: …_SHA256 is not that of the numbers: they were changed");
}

}  // namespace
}  // namespace kerfbench::calibrate
