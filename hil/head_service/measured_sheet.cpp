// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/measured_sheet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/head/spread.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr double kPrintOff_mm = 0.02;  // RMS of the printed marks; the camera's own calibration leaves 0.001

void readMarks(base::YamlReader& file, const calibrate::MarkJob& job, MeasuredSheet& sheet) {
  std::map<int, calibrate::WantedMark> wanted;
  for (const calibrate::WantedMark& mark : job.marks) wanted.emplace(mark.number, mark);
  for (base::YamlReader& mark : file.list("marks")) {
    const auto number = static_cast<int>(mark.integer("number", {.min = 0, .max = 1e6}));
    const auto p = mark.numbers("p_W_mm", 2, base::YamlReader::Range{.min = -1e4, .max = 1e4});
    const auto c = mark.numbers("covariance_mm2", 3, base::YamlReader::Range{.min = -1e4, .max = 1e4});
    MeasuredMark measured;
    measured.p_W_mm = {p[0], p[1]};
    measured.covariance_mm2 << c[0], c[1], c[1], c[2];
    if (!calibrate::isCovariance(measured.covariance_mm2)) mark.fault("covariance_mm2", "is no covariance");
    const auto at = wanted.find(number);
    if (at == wanted.end()) {
      mark.fault("number", "the job has no such mark, or it is here twice");
      continue;
    }
    measured.wanted = at->second;
    wanted.erase(at);
    sheet.marks.push_back(measured);
  }
}

Eigen::Matrix3d poseCovarianceIn(base::YamlReader& file) {
  const auto c = file.numbers("pose_covariance", 6, base::YamlReader::Range{.min = -1e4, .max = 1e4});
  Eigen::Matrix3d covariance;
  covariance << c[0], c[1], c[3], c[1], c[2], c[4], c[3], c[4], c[5];
  const SymmetricEigen<3> solver(covariance);
  const double rounding = 1e-12 * covariance.trace();
  if (!(solver.values.minCoeff() >= -rounding)) file.fault("pose_covariance", "is no covariance");
  return covariance;
}

/// Columns that move a place as the sheet's pose does, independent and of variance 1.
Eigen::Matrix<double, 2, 3> poseModes(const Eigen::Matrix3d& root, const Eigen::Vector2d& p_W_mm) {
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1.0, 0.0, -p_W_mm.y(), 0.0, 1.0, p_W_mm.x();
  return by_pose * root;
}

}  // namespace

SheetErrors errorsOf(std::span<const MeasuredSheet> sheets) {
  SheetErrors errors;
  double sum_mm2 = 0.0;
  for (const MeasuredSheet& sheet : sheets) {
    errors.marks += sheet.marks.size();
    for (const MeasuredMark& mark : sheet.marks) {
      errors.max_mm = std::max(errors.max_mm, mark.error_mm().norm());
      sum_mm2 += mark.error_mm().squaredNorm();
    }
  }
  if (errors.marks > 0) errors.rms_mm = std::sqrt(sum_mm2 / static_cast<double>(errors.marks));
  return errors;
}

calibrate::MarkJob readJobOf(const HeadSetup& setup, const fs::path& path) {
  calibrate::MarkJob job = calibrate::readMarkJob(path);
  if (job.machine != setup.name) {
    throw base::ConfigError(fmt::format("{}: machine: the job is for {}, {} is {}", path.string(),
                                        job.machine, setup.machine.string(), setup.name));
  }
  return job;
}

camera::TileFolder openPictures(const HeadSetup& setup, const fs::path& folder) {
  return camera::TileFolder(folder, camera::PictureSize{setup.camera.width_px, setup.camera.height_px});
}

MeasuredSheet measurePictures(const fs::path& folder, const calibrate::MarkJob& job, const HeadSetup& setup,
                              int threads) {
  camera::TileFolder tiles = openPictures(setup, folder);
  try {
    return measureSheet(tiles, job, setup, threads);
  } catch (const HeadEvidenceError& error) {
    throw HeadEvidenceError(fmt::format("{}: {}", folder.string(), error.what()));
  }
}

MeasuredSheet measureSheet(camera::TileSource& tiles, const calibrate::MarkJob& job, const HeadSetup& setup,
                           int threads) {
  calibrate::FieldSearchOptions search;
  search.size_mm = job.size_mm;
  search.open_gray = setup.open_gray;
  search.beam_radius_mm = setup.beam_radius_mm;
  search.board_thickness_mm = kMarkBoard_mm;
  search.table_sigma_mm = setup.table_sigma_mm;
  search.threads = threads;
  const calibrate::FieldPictures pictures = calibrate::findFieldMarks(tiles, setup.camera, job.print, search);
  const calibrate::MarkedField field = calibrate::matchField(job, pictures);
  if (!field.problems.empty()) {
    std::vector<std::string> lines = field.problems;
    lines.insert(lines.end(), field.remarks.begin(), field.remarks.end());
    throw HeadEvidenceError(fmt::format("job {}: {}", job.name, fmt::join(lines, "\n  ")));
  }
  MeasuredSheet sheet;
  // Symmetrical to the last bit, as its file has it.
  const Eigen::Matrix3d pose = pictures.poseCovarianceAbout(job.p_SW_mm);
  sheet.pose_covariance = 0.5 * (pose + pose.transpose());
  for (const calibrate::MarkPoint& point : field.points) {
    const Eigen::Matrix2d& c = point.cut.covariance;
    sheet.marks.push_back({point.wanted, point.cut.p_S_mm - job.p_SW_mm, 0.5 * (c + c.transpose())});
  }
  sheet.missing = static_cast<int>(field.missing.size());
  sheet.false_marks = static_cast<int>(field.doubled.size() + field.foreign.size());
  sheet.remarks = field.remarks;
  if (pictures.pose.residual_mm > kPrintOff_mm) {
    sheet.remarks.push_back(
        fmt::format("the printed marks lie {:.3f} mm RMS beside their places: the print is not true, or the "
                    "camera's scale",
                    pictures.pose.residual_mm));
  }
  return sheet;
}

std::vector<calibrate::HeadObservation> observationsOf(const MeasuredSheet& sheet,
                                                       const std::optional<calibrate::AimGrid>& table,
                                                       int number) {
  const SymmetricEigen<3> pose(sheet.pose_covariance);
  const Eigen::Matrix3d root = pose.vectors * pose.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  std::vector<calibrate::HeadObservation> observations;
  std::string outside;
  for (const MeasuredMark& mark : sheet.marks) {
    const Eigen::Vector2d& wanted_W_mm = mark.wanted.p_W_mm;
    const auto d_mm = table ? table->at_mm(wanted_W_mm) : Eigen::Vector2d(0.0, 0.0);
    if (!d_mm) {
      outside +=
          fmt::format("{}mark {} at ({:.3f}, {:.3f}) mm lies outside of the correction table",
                      outside.empty() ? "" : "\n", mark.wanted.number, wanted_W_mm.x(), wanted_W_mm.y());
      continue;
    }
    observations.push_back({mark.wanted.number, wanted_W_mm + *d_mm, mark.p_W_mm, mark.covariance_mm2,
                            calibrate::SharedError{number, poseModes(root, mark.p_W_mm)}});
  }
  if (!outside.empty()) throw HeadEvidenceError(outside);
  return observations;
}

std::string measuredText(const MeasuredSheet& sheet) {
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Where the marks of the job beside this file lie, by their pictures.\n"
      "version: {}\n"
      "digest: '{}'   # Of machine, table, job and pictures.\n"
      "missing: {}\n"
      "false: {}\n"
      "remarks:\n",
      kMeasuredVersion, sheet.digest, sheet.missing, sheet.false_marks);
  if (sheet.remarks.empty()) text = text.substr(0, text.size() - 1) + " []\n";
  for (std::string remark : sheet.remarks) {
    std::ranges::replace(remark, '\'', '"');
    text += fmt::format("  - {{text: '{}'}}\n", remark);
  }
  const Eigen::Matrix3d& pose = sheet.pose_covariance;
  text +=
      "# Of the sheet's place: xx, xy, yy (mm2), x turn, y turn (mm rad), turn turn (rad2); about W's "
      "origin.\n";
  text += fmt::format("pose_covariance: [{}, {}, {}, {}, {}, {}]\n", pose(0, 0), pose(0, 1), pose(1, 1),
                      pose(0, 2), pose(1, 2), pose(2, 2));
  text += "marks:   # In W; covariances without that of the sheet's place.\n";
  for (const MeasuredMark& mark : sheet.marks) {
    const Eigen::Matrix2d& c = mark.covariance_mm2;
    text += fmt::format("  - {{number: {}, p_W_mm: [{}, {}], covariance_mm2: [{}, {}, {}]}}\n",
                        mark.wanted.number, mark.p_W_mm.x(), mark.p_W_mm.y(), c(0, 0), c(0, 1), c(1, 1));
  }
  return text;
}

std::optional<MeasuredSheet> readMeasured(const fs::path& path, const calibrate::MarkJob& job,
                                          const std::string& digest) {
  if (!fs::exists(path)) return std::nullopt;
  auto file = base::YamlReader::openFile(path);
  MeasuredSheet sheet;
  sheet.digest = file.text("digest");
  if (sheet.digest != digest) return std::nullopt;
  if (file.integer("version", {.min = 1, .max = 1e6}) != kMeasuredVersion) {
    file.fault("version", fmt::format("this program reads version {}; calibrate again", kMeasuredVersion));
    file.finish();
  }
  sheet.missing = static_cast<int>(file.integer("missing", {.min = 0, .max = 1e6}));
  sheet.false_marks = static_cast<int>(file.integer("false", {.min = 0, .max = 1e6}));
  for (base::YamlReader& remark : file.list("remarks")) sheet.remarks.push_back(remark.text("text"));
  sheet.pose_covariance = poseCovarianceIn(file);
  readMarks(file, job, sheet);
  file.finish();
  return sheet;
}

}  // namespace kerfbench::head_service
