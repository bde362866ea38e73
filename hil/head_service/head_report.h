// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/head_service/head_procedure.h"

namespace kerfbench::head_service {

/// A file that the calibration wrote.
struct HeadFile {
  std::string path;  ///< Path from the report's folder; absolute if it lies elsewhere.
  std::string what;
};

/// Facts of the report in addition to the result.
struct HeadFacts {
  std::string machine;
  std::string command;
  std::string version;
  std::string camera;
  std::string source;  ///< Source of the pictures, in words.
  double mark_size_mm{};
  Eigen::AlignedBox2d field_W_mm;           ///< Field in which marks may lie.
  double unmodelled_share{};                ///< Share that the fit was configured with.
  std::optional<calibrate::AimGrid> table;  ///< The controller's before.
  std::vector<HeadFile> files;
};

/// head.json: the iterations, the parameters with their uncertainty, and a digest over all of it but the
/// command.
std::string headJson(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts);

/// One self-contained page: the verdict, the field before and after, what is left, iterations, parameters,
/// files.
std::string headHtml(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts);

}  // namespace kerfbench::head_service
