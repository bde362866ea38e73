// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/offset.h"
#include "firmware_under_test/planner/compensation/space_joint.h"

namespace kerfbench::planner {

/// Grid of corners to be tried. Corners with equal angles alpha and beta are one-point joints.
struct ProofGrid {
  double fold_step_deg{7.5};  ///< Step of alpha and beta, from half a step to 180°.
  double turn_step_deg{2.5};  ///< Step of joints in the plane.
  std::vector<double> omegas_deg{90.0,  95.0,  110.0, 135.0, 160.0, 179.0, 179.98, 180.02, 181.0, 200.0,
                                 225.0, 250.0, 270.0, 280.0, 290.0, 300.0, 315.0,  330.0,  340.0, 349.9};
  std::vector<double> refused_deg{0.0,    1.0,   30.0,  60.0,  89.0,   89.99,
                                  350.01, 352.0, 355.0, 359.0, 359.99, 360.0};
  std::vector<double> radii_mm{0.05, 0.11, 0.25};
};

/// Extremes over the corners of one case; lengths in radii.
struct SpaceProofRow {
  int number{};  ///< 1 … 8; 0: one point.
  SpaceJoint joint{};
  std::size_t corners{};
  std::size_t drawn_back{};
  double nearest{};             ///< Least distance of the path from the contour.
  double missed{};              ///< Largest distance of a free point of the strict offset from the path.
  std::size_t most_points{};    ///< Most points in either plane, the fold's not counted.
  std::size_t paper_corners{};  ///< Number of corners where the joint of the paper's text can be formed.
  double paper_nearest{};       ///< Least distance of the paper's joint, up to Omega = 270°.
  FoldCorner paper_worst;       ///< Corner with that distance.
  double paper_nearest_above{};
  double paper_missed{};
};

struct PlaneProofRow {
  std::string pair;  ///< Kinds of the two neighbours, e.g. "line-arc".
  JointKind kind{};
  std::size_t joints{};
  double nearest_mm{};  ///< Least of distance minus radius.
  double farthest{};    ///< Largest distance in radii.
  double missed_mm{};
  std::size_t failed{};  ///< Number of checks that failed.
};

struct Proof {
  ProofGrid grid;
  std::vector<SpaceProofRow> space;
  std::vector<PlaneProofRow> plane;
  std::size_t space_samples{};
  std::size_t plane_samples{};
  std::size_t refused{};      ///< Number of corners beyond the limits that were refused, as required.
  std::size_t not_refused{};  ///< Number of corners beyond the limits that were not refused.
  std::vector<std::string> unexpected;  ///< Corners within the limits that were refused.
  [[nodiscard]] bool holds() const;
};

/// Tries the whole grid on both sides; checks by samples (plane_check.h, space_check.h).
Proof prove(const ProofGrid& grid);

/// Result as a page; `pictures` is the folder of the pictures as seen from it.
std::string proofPage(const Proof& proof, const std::string& pictures);

/// Pictures: name and SVG text, one for each case in space and each joint in the plane.
struct Picture {
  std::string name;
  std::string title;
  std::string svg;
};
std::vector<Picture> planePictures();
std::vector<Picture> spacePictures();

/// Two neighbours that meet at the origin, the first along +x there. The sweeps are those of arcs; 0: a line.
Contour planeJoint(double turn_rad, double first_sweep_rad, double second_sweep_rad, Side side);

}  // namespace kerfbench::planner
