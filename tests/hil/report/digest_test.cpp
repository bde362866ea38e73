// SPDX-License-Identifier: Apache-2.0
// What the digests of a report bind, and what they do not.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/dieline/geometry.h"
#include "hil/report/run_report.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "tests/hil/report/sample_report.h"

namespace kerfbench::report {
namespace {

using test::htmlOf;
using test::jsonOf;
using test::reportOf;
using ::testing::HasSubstr;

TEST(Digest, IsStableAgainstOrderTimeAndPaths) {
  const inspect::testing::SyntheticRun run;
  const RunReport a = reportOf(run);
  RunReport b = a;
  std::mt19937 random(3);
  std::shuffle(b.result.entities.begin(), b.result.entities.end(), random);
  std::shuffle(b.result.cuts.begin(), b.result.cuts.end(), random);
  std::shuffle(b.result.checks.begin(), b.result.checks.end(), random);
  std::shuffle(b.kerf.entities.begin(), b.kerf.entities.end(), random);
  std::shuffle(b.pulses.begin(), b.pulses.end(), random);
  b.scenario_path = "elsewhere";
  dieline::Dieline moved = *a.dieline;
  moved.path = "elsewhere";
  b.dieline = std::make_shared<const dieline::Dieline>(std::move(moved));
  b.host = "bench-2";
  b.timing.clear();
  b.kerf.entities[3].calipers[7].offset_mm += 1e-10;
  EXPECT_EQ(digestOf(a), digestOf(b));
  EXPECT_EQ(digestOf(a).size(), 64U);
}

TEST(Digest, DoesNotDependOnWhatIsForPeopleAlone) {
  const RunReport a = reportOf(test::badRun());
  RunReport b = a;
  b.moments.push_back({{"path"}, 1.0, 0.995, 1.005, {{"laser_gate", true, {1.001}}}, {}});
  b.program = {{3, "G01 X1"}};
  for (inspect::Check& check : b.result.checks) check.where = {};
  for (inspect::CutResult& cut : b.result.cuts) cut.track.clear();
  EXPECT_EQ(digestOf(a), digestOf(b));
}

TEST(Digest, ChangesWithAnyMeasurement) {
  const inspect::testing::SyntheticRun run;
  const RunReport a = reportOf(run);
  const std::string digest = digestOf(a);
  RunReport b = a;
  b.kerf.entities[3].calipers[7].offset_mm += 3e-6;
  EXPECT_NE(digest, digestOf(b));
  b = a;
  b.result.cuts[0].residual_mm[0] += 3e-6;
  EXPECT_NE(digest, digestOf(b));
  b = a;
  b.result.verdict = inspect::Verdict::kFail;
  EXPECT_NE(digest, digestOf(b));
  b = a;
  ++b.pulses[0].setup_histogram[30];
  EXPECT_NE(digest, digestOf(b));
}

TEST(Digest, ChangesWithJointsPosesUncertaintiesAndWords) {
  const inspect::testing::SyntheticRun run;
  RunReport a = reportOf(run);
  a.result.joints.push_back({inspect::JointResult::Kind::kCorner, 0, 1, 2, {60, 40}, false, {0.01, 0.002}});
  a.result.problems = {"The list /home/me/tiles.yaml is short."};
  a.result.unjudged.push_back({"joints", "", true, "None was found."});
  const std::string digest = digestOf(a);
  const std::vector<std::function<void(RunReport&)>> changes{
      [](RunReport& r) { r.result.joints.back().mm.value += 3e-6; },
      [](RunReport& r) { r.result.joints.back().mm.U += 3e-6; },
      [](RunReport& r) { r.result.joints.back().p_S_mm.x() += 3e-6; },
      [](RunReport& r) { r.result.rms_mm.value += 3e-6; },
      [](RunReport& r) { r.result.problems[0] = "The list /home/me/tiles.yaml is long."; },
      [](RunReport& r) { r.result.unjudged.back().reason = "Many were found."; },
      [](RunReport& r) { r.kerf.entities[3].calipers[7].sigma_mm *= 1.001; },
      [](RunReport& r) { r.kerf.units[1].p_TS_mm.y() += 3e-6; },
      [](RunReport& r) { r.kerf.units[1].covariance(0, 2) += 1e-10; },
      [](RunReport& r) { r.spot.frames[9].sheet[0].angle_rad += 1e-7; },
      [](RunReport& r) { r.spot.frames[9].sheet[0].covariance(1, 1) += 1e-10; },
      [](RunReport& r) { r.spot.frames[9].mid_s += 1e-6; },
      [](RunReport& r) { r.spot.frames_lost += 1; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    RunReport b = a;
    changes[i](b);
    EXPECT_NE(digest, digestOf(b)) << "change " << i;
  }
  RunReport b = a;
  b.result.problems = {"The list /srv/elsewhere/tiles.yaml is short."};
  EXPECT_EQ(digest, digestOf(b));
}

TEST(InputsDigest, BindsTheBytesOfAllFilesAndNotTheirPlaces) {
  const inspect::testing::SyntheticRun run;
  RunReport a = reportOf(run);
  a.inputs = {{"label.dxf", std::string(64, 'a')}, {"machine.yaml", std::string(64, 'b')}};
  RunReport b = a;
  std::swap(b.inputs[0], b.inputs[1]);
  b.inputs[0].name = "elsewhere/machine.yaml";
  EXPECT_EQ(inputsDigestOf(a), inputsDigestOf(b));
  EXPECT_EQ(digestOf(a), digestOf(b));
  b.inputs[0].sha256[5] = 'c';
  EXPECT_NE(inputsDigestOf(a), inputsDigestOf(b));
  b = a;
  b.inputs.pop_back();
  EXPECT_NE(inputsDigestOf(a), inputsDigestOf(b));
  b = a;
  ++b.seed;
  EXPECT_NE(inputsDigestOf(a), inputsDigestOf(b));
  const auto json = nlohmann::json::parse(jsonOf(a));
  EXPECT_EQ(json["inputs_digest"], inputsDigestOf(a));
  EXPECT_EQ(json["inputs"][0]["file"], "label.dxf");
}

// An edge that no check looks at is evidence as well.
TEST(Digest, BindsTheEvidenceWhateverIsReadOfIt) {
  const inspect::testing::SyntheticRun run;
  RunReport a = reportOf(run);
  a.evidence = {{"pins", std::string(64, 'a')}, {"kerf pictures", std::string(64, 'b')}};
  RunReport b = a;
  std::swap(b.evidence[0], b.evidence[1]);
  EXPECT_EQ(digestOf(a), digestOf(b));
  b = a;
  b.evidence[1].sha256[5] = 'c';
  EXPECT_NE(digestOf(a), digestOf(b));
  b = a;
  b.evidence.pop_back();
  EXPECT_NE(digestOf(a), digestOf(b));
  const auto json = nlohmann::json::parse(jsonOf(a));
  EXPECT_EQ(json["evidence"][0]["name"], "pins");
  EXPECT_EQ(json["evidence"][1]["sha256"], std::string(64, 'b'));
  EXPECT_THAT(htmlOf(a), HasSubstr(std::string(64, 'b')));
}

TEST(Digest, KnowsNothingOfWhatTheModelAloneKnows) {
  const inspect::testing::SyntheticRun run;
  const RunReport a = reportOf(run);
  RunReport b = a;
  b.model.sampled[0].value = 0.1;
  b.model.lost_steps.push_back({"galvo_x", 1.0, 0.2, "rad", 4});
  b.model.imperfections = "dynamic";
  b.model.twin = "fast";
  EXPECT_EQ(digestOf(a), digestOf(b));
  EXPECT_NE(jsonOf(a), jsonOf(b));
}

}  // namespace
}  // namespace kerfbench::report
