// SPDX-License-Identifier: Apache-2.0
// All of a mark's stages: job, planner, release, machine with errors of millimetres, pictures, centre;
// compared with the place to which the model's head sends the beam. Only this test uses the model.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include "firmware_under_test/planner/head/axes.h"
#include "hil/calibrate/marks/field_marks.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/head_service/mark_case.h"
#include "hil/run/cut_on_twin.h"
#include "hil/scenario/camera_files.h"
#include "hil/vision/marks/constellation.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using testing::IsEmpty;

struct Field {
  const char* machine;
  double half_mm;  ///< Half the side of the field.
  int grid;        ///< Number of marks in each direction.
  double size_mm;  ///< Size of a mark.
  double beam_radius_mm;
  double print_mm;      ///< Distance of the print beyond the field.
  double least_raw_mm;  ///< Smallest largest error of the sampled machine: it must be off somewhere.
};

MarkJob jobFor(const Field& field) {
  MarkJob job;
  job.name = "marks";
  job.machine = field.machine;
  job.date = "2026-11-22";
  job.size_mm = field.size_mm;
  job.p_SW_mm = {-67.0, 0.0};
  const double at_mm = field.half_mm + field.print_mm;
  for (const double x : {-1.0, 0.1, 1.0}) {
    for (const double y : {-1.0, 1.0}) job.print.push_back({job.p_SW_mm + at_mm * Vector2d(x, y), 3.0});
  }
  const Vector2d half_mm = Vector2d::Constant(field.half_mm);
  job.marks = numbered(gridPlaces({-half_mm, half_mm}, field.grid), 0);
  return job;
}

/// Place to which the sampled head sends the beam for an aim of the planner, by its own configuration.
class Truth {
 public:
  Truth(const scenario::Case& test_case, const twin::SampledMachine& sampled)
      : axes_(scenario::plannerMachine(test_case), {}),
        step_rad_(test_case.machine.controller.mirror_step_rad),
        head_(sampled.machine.head, sampled.machine.beam),
        surface_(sampled.machine.surface) {}
  [[nodiscard]] Vector2d at(const Vector2d& p_W_mm) const {
    return head_.spotAt(step_rad_ * axes_.stepsAt(p_W_mm), Vector2d::Zero(), surface_, 0.0).value().p_WQ_mm;
  }

 private:
  planner::Axes axes_;
  double step_rad_;
  twin::ScanHead head_;
  twin::Surface surface_;
};

struct Errors {
  double raw_mm{};  ///< Largest error of the head.
  Vector2d bias_um{Vector2d::Zero()};
  double sigma_um{};  ///< Standard deviation per axis, about the best motion.
  double worst_um{};
  double mahalanobis{};  ///< Mean of e' C^-1 e, C own, pose and map; 2 if honest.
  double stated_um{};
};

Errors errorsOf(const Truth& truth, const MarkJob& job, const FieldPictures& pictures,
                const MarkedField& field) {
  Errors e;
  std::vector<vision::MarkPair> pairs;
  const auto n = static_cast<double>(field.points.size());
  for (const MarkPoint& point : field.points) {
    const Vector2d p_S_mm = truth.at(point.wanted.p_W_mm) + job.p_SW_mm;
    const Vector2d error = point.cut.p_S_mm - p_S_mm;
    pairs.push_back({p_S_mm, point.cut.p_S_mm, 0.0});
    e.raw_mm = std::max(e.raw_mm, point.error_mm(job).norm());
    e.bias_um += 1e3 / n * error;
    e.worst_um = std::max(e.worst_um, 1e3 * error.norm());
    const Matrix2d covariance = point.cut.covariance + pictures.poseCovariance(p_S_mm);
    e.mahalanobis += error.dot(covariance.inverse() * error) / n;
    e.stated_um += 1e6 * 0.5 * covariance.trace() / n;
  }
  const vision::PlaneMotion common = vision::fitMotion(pairs, 0.0);
  for (const vision::MarkPair& pair : pairs)
    e.sigma_um += 1e6 * 0.5 * (pair.q_mm - common * pair.p_mm).squaredNorm() / n;
  e.sigma_um = std::sqrt(e.sigma_um);
  e.stated_um = std::sqrt(e.stated_um);
  return e;
}

class MarksOnTwin : public testing::TestWithParam<Field> {};

TEST_P(MarksOnTwin, AreMeasuredWhereTheHeadPutThemToAFewMicrometres) {
  const Field& field = GetParam();
  const base::TempFolder folder;
  const std::filesystem::path binary = KERFBENCH_BINARY_DIR;
  const MarkJob job = jobFor(field);
  writeMarkJob(folder.path() / "marks.yaml", job);
  head_service::MarkCutting cutting;
  cutting.machine = base::fixture(std::string("machines/") + field.machine + ".yaml");
  cutting.beam_radius_mm = field.beam_radius_mm;
  scenario::Case test_case = scenario::readCase(
      folder.write("run.yaml", head_service::markScenario(job, "marks.dxf", cutting)), binary / "firmware");
  test_case.scenario.fidelity = twin::Fidelity::kFast;
  test_case.scenario.seed = 3;

  const run::CutSheet cut = run::cutOnTwin(test_case, binary / "bin", [](double, const std::string&) {});
  ASSERT_THAT(cut.run.problems, IsEmpty());
  const scenario::BenchCameras cameras = scenario::readCalibrations(test_case);
  ASSERT_TRUE(cameras.kerf) << cameras.problems.front();
  camera::TwinTileOptions tile_options;
  tile_options.threads = 2;
  tile_options.border_mm = 15.0;  // The head may be off by that.
  tile_options.overlap_mm = 0.6 * job.size_mm;
  tile_options.everything = false;
  camera::TwinTileSource tiles =
      run::kerfTiles(test_case, test_case.machine, cut.machine->sheet(), tile_options);
  FieldSearchOptions search;
  search.size_mm = job.size_mm;
  search.beam_radius_mm = field.beam_radius_mm;
  search.threads = 2;
  const FieldPictures pictures = findFieldMarks(tiles, *cameras.kerf, job.print, search);
  const MarkedField found = matchField(job, pictures);
  EXPECT_THAT(found.problems, IsEmpty());
  EXPECT_THAT(found.remarks, IsEmpty());
  ASSERT_EQ(found.points.size(), job.marks.size());

  const Errors e = errorsOf(Truth(test_case, cut.sampled), job, pictures, found);
  std::printf(
      "  %s: %zu tiles, head off by %.2f mm; bias %.2f %.2f um, sigma %.2f um, worst %.2f um, stated %.2f "
      "um, "
      "Mahalanobis %.2f of 2\n  %s\n",
      field.machine, tiles.size(), e.raw_mm, e.bias_um.x(), e.bias_um.y(), e.sigma_um, e.worst_um,
      e.stated_um, e.mahalanobis, cut.summary.c_str());
  EXPECT_GT(e.raw_mm, field.least_raw_mm);
  EXPECT_LT(e.bias_um.norm(), 2.0);
  EXPECT_LT(e.sigma_um, 2.0);
  EXPECT_LT(e.mahalanobis, 8.0);  // Most of it is one sample of the pose: beyond 8 in 2 % of all runs.
}

INSTANTIATE_TEST_SUITE_P(Heads, MarksOnTwin,
                         testing::Values(Field{"two-mirror-100", 50.0, 5, 5.0, 0.105, 10.0, 0.5},
                                         Field{"two-mirror-300", 150.0, 4, 7.0, 0.15, 18.0, 1.0},
                                         Field{"two-mirror-800", 400.0, 3, 14.0, 0.3, 26.0, 2.0},
                                         Field{"f-theta-300-mounted", 150.0, 4, 7.0, 0.2, 18.0, 1.0}),
                         [](const auto& test) {
                           std::string name = test.param.machine;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace kerfbench::calibrate
