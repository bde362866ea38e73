// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "hil/gauge/artefact.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/camera/camera.h"
#include "twin/sheet/board_description.h"

namespace kerfbench::gauge {

/// What an artefact is cut from, cut with and looked at with, where the bench knows data sheets alone.
struct World {
  twin::BoardDescription board;  ///< As it is; the bench is told told_thickness_mm.
  double told_thickness_mm{};
  double radius{1.0};  ///< Radius of the beam over that of the data sheet.
  twin::BlurFoot foot{};
  twin::BoardTexture texture{};
  twin::EdgeRoughness roughness{};
  PrintLayout print;  ///< Marks where they were printed.
  /// Turn of a telecentric lens about the picture's x and y since it was calibrated: it shifts what is seen
  /// of walls, and no view of a flat target shows it.
  Eigen::Vector2d lean_rad{Eigen::Vector2d::Zero()};
  CornerAngle corner{CornerAngle::k90};
  /// The kerf camera as it is set up: its light through an open kerf, and the scale of its pictures over that
  /// of its calibration.
  double open_gray{twin::kOpenKerfGray};
  double scale{1.0};
};

/// A world as the data sheets have it.
World toldWorld(const twin::BoardDescription& board, const twin::CameraDescription& camera);

/// Leans the camera as far as its calibration leaves open; an entocentric one stays.
void lean(const vision::CameraCalibration& calibration, std::uint64_t seed, World& world);

/// In a line, for people.
std::string textOf(const World& world);

/// What the bench is told of otherWorld(): standard deviations of radius and print.
inline constexpr double kToldRadius = 0.115;
inline constexpr double kToldPrint_mm = 0.0015;

/// A world that is not the bench's own, each part sampled from a stream of `seed`: board of 0.1 to 0.5
/// mm, 2.5 % (standard deviation) off what is told, that lets 5 to 30 % of the light through by one of three
/// laws, whose walls are steep or not (the depth curve begins anywhere between none and 0.6 of the fluence
/// that cuts), with or without scorch and grain; a beam of 0.8 to 1.2 times its radius; a lens that scatters
/// up to 15 % of the light beyond its blur; marks printed 1.5 um (standard deviation, each way) off; a corner
/// of another angle.
World otherWorld(const twin::BoardDescription& board, const twin::CameraDescription& camera,
                 std::uint64_t seed);

}  // namespace kerfbench::gauge
