// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/camera/camera.h"
#include "twin/five_axis/five_axis_description.h"

namespace kerfbench::fold {

/// How well a survey camera is calibrated, as its certificate has it: standard uncertainties.
struct SurveyCertificate {
  double turn_rad{};      ///< Turn of its pose in W, about each axis.
  double shift_mm{};      ///< Place of its pinhole in W, along each axis.
  double focal_share{};   ///< Relative, of both focal lengths alike.
  double principal_px{};  ///< Place of the principal point, per axis.
};

/// A survey camera of a five-axis machine.
struct SurveyCamera {
  std::string id;
  twin::CameraDescription camera;  ///< X_CP is the pose of W in the camera.
  SurveyCertificate certificate;
};

/// The kerf camera that looks at the faces, as the machine file that `inspection` names has it.
struct FoldKerfCamera {
  twin::CameraDescription camera;
  twin::InspectionTableDescription table;
  vision::CameraCalibration calibration;
  double table_sigma_mm{};
  double table_scale_sigma{};
  double scale_sigma{};
  double open_gray_sigma{};
};

/// A five-axis machine, read and checked. docs/reference/fold.md explains every key.
struct FoldMachine {
  std::string name;
  twin::FiveAxisDescription head;
  double beam_radius_sigma{};  ///< Relative standard uncertainty of the waist's radius, for the bench.
  std::vector<SurveyCamera> survey;
  FoldKerfCamera kerf;
  std::vector<std::filesystem::path> inputs;
  std::vector<base::YamlReader::Asked> keys;  ///< Every key that was asked for, the given and the others.
};

/// @throws base::ConfigError with every fault, each with file and line.
FoldMachine readFoldMachine(const std::filesystem::path& path);

/// Reads errors of a head; what is not given is as in `known`.
twin::FiveAxisErrors readErrors(base::YamlReader section, const twin::FiveAxisErrors& known);

}  // namespace kerfbench::fold
