// SPDX-License-Identifier: Apache-2.0
#include "hil/compare/run_figures.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/compare/kept_verdict.h"

namespace kerfbench::compare {
namespace {

using testing::HasSubstr;

std::string refusalOf(const std::filesystem::path& folder) {
  try {
    (void)readRunFigures(folder);
  } catch (const base::InputError& e) {
    return e.what();
  }
  return "";
}

TEST(RunFigures, AreThoseOfTheVerdict) {
  const base::TempFolder temp;
  const RunFigures run = readRunFigures(keep(plainVerdict(), temp.path()));
  EXPECT_EQ(run.scenario, "label");
  EXPECT_EQ(run.firmware_sha256, "aa11");
  EXPECT_EQ(run.checks.at("path").verdict, "PASS");
  EXPECT_TRUE(run.not_judged.empty());
  const auto figure = [&](Figure::Of of, const std::string& place, const std::string& quantity) {
    const auto found = std::ranges::find_if(run.figures, [&](const Figure& f) {
      return f.of == of && f.place == place && f.quantity == quantity;
    });
    return found == run.figures.end() ? Figure{} : *found;
  };
  EXPECT_DOUBLE_EQ(figure(Figure::Of::kCheck, "path", "value").sigma, 0.002);
  EXPECT_EQ(figure(Figure::Of::kCheck, "pulse_timing", "value").better, Better::kLarger);
  EXPECT_DOUBLE_EQ(figure(Figure::Of::kCut, "unit 0, E0", "slope_mm_s").sigma, 0.002);
  EXPECT_DOUBLE_EQ(figure(Figure::Of::kEntity, "unit 0, E0", "width_mm").sigma, 0.005);
  EXPECT_DOUBLE_EQ(figure(Figure::Of::kJoint, "unit 0, E0, corner to E1 at its end", "value").sigma, 0.004);
  // What was not measured is no figure.
  EXPECT_EQ(figure(Figure::Of::kEntity, "unit 0, E0", "circularity_mm").quantity, "");
}

TEST(RunFigures, AFewFramesAreNoCut) {
  nlohmann::json verdict = plainVerdict();
  nlohmann::json fragment = verdict["cuts"]["list"][0];
  fragment["frames"] = 2;
  fragment["top_speed_mm_s"] = 46.0;
  verdict["cuts"]["list"].insert(verdict["cuts"]["list"].begin(), fragment);
  const base::TempFolder temp;
  for (const Figure& figure : readRunFigures(keep(verdict, temp.path())).figures) {
    if (figure.quantity == "top_speed_mm_s") {
      EXPECT_EQ(figure.value, 300.0) << figure.place;
    }
  }
}

TEST(RunFigures, DamagedFoldersAreRefusedWithTheReason) {
  const base::TempFolder temp;
  EXPECT_THAT(refusalOf(temp.path() / "nothing"), HasSubstr("no results folder"));
  const auto damaged = [&](int second, const std::function<void(const std::filesystem::path&)>& damage) {
    const auto folder = keep(plainVerdict(), temp.path(), second);
    damage(folder);
    return refusalOf(folder);
  };
  EXPECT_THAT(damaged(1, [](const auto& f) { std::ofstream(f / "verdict.json", std::ios::app) << " "; }),
              HasSubstr("verdict.json is not what the run wrote"));
  EXPECT_THAT(damaged(2, [](const auto& f) { std::filesystem::remove(f / "verdict.json"); }),
              HasSubstr("verdict.json is missing"));
  EXPECT_THAT(damaged(3, [](const auto& f) { std::ofstream(f / "notes.txt") << "x"; }),
              HasSubstr("notes.txt was added"));
  EXPECT_THAT(damaged(4, [](const auto& f) { std::filesystem::remove(f / "kerfbench-results.txt"); }),
              HasSubstr("has no kerfbench-results.txt"));
}

TEST(RunFigures, OtherVersionsAndWhatIsNoVerdictAreRefused) {
  const base::TempFolder temp;
  int second = 0;
  const auto kept = [&](const nlohmann::json& verdict) {
    return refusalOf(keep(verdict, temp.path(), ++second));
  };
  nlohmann::json verdict = plainVerdict();
  verdict["schema_version"] = 2;
  EXPECT_THAT(kept(verdict), HasSubstr("schema_version is 2, and this bench reads 1"));
  verdict.erase("schema_version");
  EXPECT_THAT(kept(verdict), HasSubstr("schema_version is missing"));
  for (const char* field : {"checks", "entities", "cuts", "joints", "versions", "seed", "model", "inputs"}) {
    verdict = plainVerdict();
    verdict.erase(field);
    EXPECT_THAT(kept(verdict), HasSubstr(field));
    verdict[field] = "a text";
    EXPECT_THAT(kept(verdict), HasSubstr("lacks what a verdict")) << field;
  }
}

}  // namespace
}  // namespace kerfbench::compare
