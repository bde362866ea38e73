// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/head_pictures.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

namespace kerfbench::test {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

std::unique_ptr<ScratchFolder> HeadPictures::shared_;
std::unique_ptr<head_service::HeadSetup> HeadPictures::setup_;
std::unique_ptr<SpoiledSheet> HeadPictures::clean_;

void writeText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string HeadPictures::options() {
  return fmt::format("--machine '{}' --seed 2 --grids {} --verify 20",
                     fixture("machines/two-mirror-100.yaml").string(), kGrid);
}

void HeadPictures::SetUpTestSuite() {
  shared_ = std::make_unique<ScratchFolder>();
  const ProgramRun run = kerfbench(
      fmt::format("calibrate head {} --keep-pictures --results-dir '{}'", options(), live().string()));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  setup_ = std::make_unique<head_service::HeadSetup>(
      head_service::readHeadSetup(fixture("machines/two-mirror-100.yaml"), kGrid));
  clean_ = std::make_unique<SpoiledSheet>(live() / "1-grid", *setup_);
  ASSERT_EQ(clean_->numbers().size(), static_cast<std::size_t>(kGrid * kGrid));
}

void HeadPictures::TearDownTestSuite() {
  clean_.reset();
  setup_.reset();
  shared_.reset();
}

fs::path HeadPictures::copy(const std::string& name) const {
  fs::copy(live() / "1-grid/pictures", path(name));
  return path(name);
}

fs::path HeadPictures::written(const SpoiledSheet& spoiled) const {
  spoiled.write(path("pictures"));
  return path("pictures");
}

ProgramRun HeadPictures::run(const fs::path& job_file, const fs::path& pictures, const fs::path& out) const {
  return kerfbench(fmt::format("calibrate head {} --job '{}' --pictures '{}' --results-dir '{}' --out '{}'",
                               options(), job_file.string(), pictures.string(), path("results").string(),
                               out.string()));
}

void HeadPictures::refused(const fs::path& pictures, int exit_code, const std::vector<std::string>& words,
                           const fs::path& job_file) const {
  writeText(path("old.csv"), "somebody works with this");
  fs::remove_all(path("results"));
  const ProgramRun got = run(job_file, pictures, path("old.csv"));
  EXPECT_EQ(got.exit_code, exit_code) << got.output;
  for (const std::string& word : words) EXPECT_THAT(got.output, HasSubstr(word));
  EXPECT_EQ(textOf(path("old.csv")), "somebody works with this");
  EXPECT_TRUE(fs::is_empty(path("results")));
  for (const auto& file : fs::directory_iterator(scratch_.path()))
    EXPECT_THAT(file.path().filename().string(), Not(HasSubstr("old.csv."))) << "half a table";
}

void HeadPictures::refused(const SpoiledSheet& spoiled, const std::vector<std::string>& words) const {
  std::vector<std::string> all = words;
  all.emplace_back("INVALID: no table is written");
  all.push_back(path("pictures").string() + ": job 1-grid: ");
  refused(written(spoiled), kInvalid, all);
}

}  // namespace kerfbench::test
