// SPDX-License-Identifier: Apache-2.0
// Command `kerfbench show`, as a user calls it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;

class Show : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (scratch_.path() / name).string(); }
  [[nodiscard]] bool isPng(const std::string& name) const {
    std::ifstream in(scratch_.path() / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return bytes.starts_with("\x89PNG\r\n") && bytes.size() > 1000;
  }
  [[nodiscard]] bool nothingWritten() const { return std::filesystem::is_empty(scratch_.path()); }
  const std::string machine_ = fixture("machines/two-mirror.yaml").string();
  const std::string scenario_ = fixture("scenarios/label-on-belt.yaml").string();
  ScratchFolder scratch_;
};

TEST_F(Show, DrawsEveryMachineAtRest) {
  for (const char* name : {"two-mirror", "strip-gantry"}) {
    const std::string machine = fixture(fmt::format("machines/{}.yaml", name)).string();
    const auto result = kerfbench(
        fmt::format("show '{}' --size 96x64 --out '{}'", machine, file(std::string(name) + ".png")));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, HasSubstr(std::string(name) + ".png"));
    EXPECT_TRUE(isPng(std::string(name) + ".png"));
  }
}

TEST_F(Show, DrawsARunAtEachTimeAskedFor) {
  const auto result = kerfbench(fmt::format("show '{}' --scenario '{}' -q --at 0.5 3 --size 96x64 --out '{}'",
                                            machine_, scenario_, file("run.png")));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(result.output, file("run-0.5000s.png") + "\n" + file("run-3.0000s.png") + "\n");
  EXPECT_TRUE(isPng("run-0.5000s.png"));
  EXPECT_TRUE(isPng("run-3.0000s.png"));
}

TEST_F(Show, FilmsARun) {
  const std::string options =
      fmt::format("show '{}' --film '{}' --from 1 --to 1.2 --slow 5 --fps 4 --size 96x64 -j 2",
                  fixture("scenarios/native/label-on-belt.yaml").string(), file("run.webm"));
  const auto result = kerfbench(options);
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.output, HasSubstr("apt-get install ffmpeg"));
    EXPECT_TRUE(nothingWritten());
    return;
  }
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("1.0000 … 1.2000 s, 5 times slower, 5 pictures"));
  EXPECT_GT(std::filesystem::file_size(scratch_.path() / "run.webm"), 500U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch_.path()), {}), 1);
}

TEST_F(Show, WrongOptionsOfAFilmAre64) {
  for (const char* options :
       {"--film a.gif", "--film a.mp4 --at 1", "--film a.mp4 --out b.png", "--film a.mp4 --from 2 --to 1",
        "--film a.mp4 --slow 0", "--from 1", "--fps 25", "--film a.mp4 --from 0 --to 1 --slow 1e5"}) {
    const auto result = kerfbench(fmt::format("show --scenario '{}' {}", scenario_, options));
    EXPECT_EQ(result.exit_code, 64) << options << ": " << result.output;
  }
}

TEST_F(Show, DrawsADrawingAsTheNameOfTheFileAsks) {
  const std::string drawing = fixture("dielines/tuck-end-carton.dxf").string();
  const auto png = kerfbench(fmt::format("show '{}' --size 500x80 --out '{}'", drawing, file("carton.png")));
  EXPECT_EQ(png.exit_code, 0) << png.output;
  EXPECT_TRUE(isPng("carton.png"));
  const auto svg = kerfbench(fmt::format("show '{}' --out '{}'", drawing, file("carton.svg")));
  EXPECT_EQ(svg.exit_code, 0) << svg.output;
  std::ifstream in(scratch_.path() / "carton.svg");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("tuck-end-carton.dxf: 142.00 x 136.00 mm"));
  EXPECT_THAT(text, HasSubstr("crease, layer CREASE"));
}

TEST_F(Show, OptionsOfMachinesAndOfDrawingsAreNotMixed) {
  const std::string drawing = fixture("dielines/label-60x40.dxf").string();
  const auto exitOf = [&](const std::string& options, const std::string& out) {
    return kerfbench(fmt::format("show '{}' {} --out '{}'", drawing, options, file(out))).exit_code;
  };
  EXPECT_EQ(exitOf("--view head", "a.svg"), 64);
  EXPECT_EQ(exitOf("", "a.jpg"), 64);
  EXPECT_EQ(exitOf("--layer CUT=banana", "a.svg"), 65);
  EXPECT_EQ(kerfbench(fmt::format("show '{}' --unit mm", machine_)).exit_code, 64);
  EXPECT_TRUE(nothingWritten());
}

TEST_F(Show, WrongCommandLineIs64) {
  EXPECT_EQ(kerfbench("show").exit_code, 64);
  EXPECT_EQ(kerfbench(fmt::format("show '{}' --at 1", machine_)).exit_code, 64);
  for (const char* time : {"-1", "soon", "nan", "inf"}) {
    EXPECT_EQ(
        kerfbench(fmt::format("show --scenario '{}' --out '{}' --at={}", scenario_, file("a.png"), time))
            .exit_code,
        64)
        << time;
  }
  EXPECT_EQ(kerfbench(fmt::format("show '{}' --view inside", machine_)).exit_code, 64);
  for (const char* size : {"1280", "x", "1280x", "20x20", "99999x800", "-5x100", "1e3x800"}) {
    const auto result =
        kerfbench(fmt::format("show '{}' --out '{}' --size={}", machine_, file("a.png"), size));
    EXPECT_EQ(result.exit_code, 64) << size;
    EXPECT_THAT(result.output, HasSubstr("--size")) << size;
  }
  const auto other =
      kerfbench(fmt::format("show '{}' --scenario '{}' --out '{}'",
                            fixture("machines/strip-gantry.yaml").string(), scenario_, file("a.png")));
  EXPECT_EQ(other.exit_code, 64);
  EXPECT_THAT(other.output, HasSubstr("two-mirror.yaml"));
  EXPECT_TRUE(nothingWritten());
}

TEST_F(Show, ABadMachineIs65) {
  EXPECT_EQ(kerfbench("show /nonexistent.yaml").exit_code, 65);
  EXPECT_TRUE(nothingWritten());
}

TEST_F(Show, WithoutPovrayIs2AndSaysWhatToInstall) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nonexistent", 1);
  const auto result = kerfbench(fmt::format("show '{}' --out '{}'", machine_, file("a.png")));
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("apt-get install povray"));
  EXPECT_TRUE(nothingWritten());
}

}  // namespace
}  // namespace kerfbench::test
