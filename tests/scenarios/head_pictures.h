// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/head_service/head_setup.h"
#include "tests/scenarios/scenario_runs.h"
#include "tests/scenarios/spoiled_sheet.h"

namespace kerfbench::test {

inline constexpr int kBadInput = 65;
inline constexpr int kInvalid = 3;
inline constexpr int kWaiting = 75;

void writeText(const std::filesystem::path& path, const std::string& text);

/// A head that was calibrated on the twin by 49 marks, with all pictures, once for all tests.
class HeadPictures : public testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  static std::string options();
  static std::filesystem::path live() { return shared_->path() / "live"; }
  static std::filesystem::path job() { return live() / "1-grid/marks.yaml"; }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return scratch_.path() / name; }
  /// Clean sheet, to be spoiled.
  static SpoiledSheet sheet() { return *clean_; }
  /// Copy of the clean pictures.
  [[nodiscard]] std::filesystem::path copy(const std::string& name) const;
  [[nodiscard]] std::filesystem::path written(const SpoiledSheet& spoiled) const;
  [[nodiscard]] ProgramRun run(const std::filesystem::path& job_file, const std::filesystem::path& pictures,
                               const std::filesystem::path& out) const;
  /// Expects a refusal with these words, and nothing written or changed.
  void refused(const std::filesystem::path& pictures, int exit_code, const std::vector<std::string>& words,
               const std::filesystem::path& job_file = job()) const;
  /// Expects a refusal because of the marks or the pictures.
  void refused(const SpoiledSheet& spoiled, const std::vector<std::string>& words) const;

  static constexpr int kGrid = 7;
  static constexpr double kPitch_mm = 100.0 / (kGrid - 1);

 private:
  static std::unique_ptr<ScratchFolder> shared_;
  static std::unique_ptr<head_service::HeadSetup> setup_;
  static std::unique_ptr<SpoiledSheet> clean_;
  ScratchFolder scratch_;
};

}  // namespace kerfbench::test
