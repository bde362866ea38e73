// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include <fmt/format.h>

#include "firmware_under_test/planner/compensation/proof.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

/// A value that may be a rounding error either way.
std::string small(double value) { return value < 5e-13 ? "0" : fmt::format("{:.1e}", value); }

std::string conditionOf(int number) {
  switch (number) {
    case 1:
      return "α < β < 90°";
    case 2:
      return "α < 90° ≤ β, α + β < 180°";
    case 3:
      return "α < 90° ≤ β, α + β ≥ 180°";
    case 4:
      return "β < α < 90°";
    case 5:
      return "β < 90° ≤ α, α + β < 180°";
    case 6:
      return "β < 90° ≤ α, α + β ≥ 180°";
    case 7:
      return "90° ≤ α < β";
    case 8:
      return "90° ≤ β < α";
    default:
      return "α = β";
  }
}

std::string spaceTable(const Proof& proof) {
  std::string text =
      "| case | condition | joint | corners | drawn back | nearest / r | missed / r | points a side | text: "
      "formed | "
      "text: nearest / r, Ω ≤ 270° | at α, β, Ω | above 270° | text: missed / r |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const SpaceProofRow& row : proof.space) {
    const FoldCorner& worst = row.paper_worst;
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {:.9f} | {} | {} | {} | {:.3f} | {:g}°, {:g}°, {:g}° | {:.3f} | {:.3f} "
        "|\n",
        row.number == 0 ? "–" : std::to_string(row.number), conditionOf(row.number), nameOf(row.joint),
        row.corners, row.drawn_back, row.nearest, small(row.missed), row.most_points, row.paper_corners,
        row.paper_nearest, worst.alpha_rad / kDeg, worst.beta_rad / kDeg, worst.omega_rad / kDeg,
        row.paper_nearest_above, row.paper_missed);
  }
  return text;
}

std::string planeTable(const Proof& proof) {
  std::string text =
      "| pair | joint | joints | nearest − r, mm | farthest / r | missed, mm | failed |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const PlaneProofRow& row : proof.plane) {
    text += fmt::format("| {} | {} | {} | {:.1e} | {:.4f} | {:.1e} | {} |\n", row.pair, nameOf(row.kind),
                        row.joints, row.nearest_mm, row.farthest, row.missed_mm, row.failed);
  }
  return text;
}

std::string pictureTable(const std::vector<Picture>& pictures, const std::string& folder,
                         std::size_t columns) {
  std::string text;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    text += fmt::format("| ![{}]({}/{}.svg) ", pictures[i].title, folder, pictures[i].name);
    if ((i + 1) % columns != 0) continue;
    text += "|\n";
    if (i + 1 != columns) continue;
    for (std::size_t k = 0; k < columns; ++k) text += "|---";
    text += "|\n";
  }
  return text;
}

constexpr const char* kSpaceText =
    "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
    "# Spot-radius compensation: what is built, and its proof by brute force\n\n"
    "Written by `kerfplan prove-compensation`; after Chi, Shen, Zhou, Liu 2014. A beam of radius r runs "
    "beside a\n"
    "contour so that the edge of its cut lies on it.\n\n"
    "## In space\n\n"
    "AB lies in plane P1, BC in P2, both planes meet in the fold MN through B. Ω is the free angle between "
    "them "
    "on the head's\nside; above 180° the edge sticks out. The offsets of both lines meet the fold on the "
    "same side "
    "of B; α and β are the angles\nof BA and BC with the other half of the fold. Below 90° a line is "
    "offset over "
    "all of its length; above it ends |r cot α| early.\n\n"
    "Table 1 of the paper is a picture that is not in the text. The eight cases are those that its text "
    "names: "
    "which of α and β\nis larger, which are obtuse, and whether the obtuse line's offset meets the fold "
    "nearer to B "
    "than the other's (α + β < 180°).\n"
    "The paths follow from the three criteria, distances measured in space between the beam's focus and "
    "the "
    "contour:\n\n"
    "1. the strict offset wherever it is no nearer than r to both lines: it ends s = r max(0, ν·w)/(1 − "
    "v·w) before B "
    "(v, w: from B\n   along the line and along the other one, ν: towards the offset), in a plane the "
    "well-known "
    "r tan(θ/2);\n"
    "2. never nearer than r to either line: what is, is a convex set in each half plane, and tangents lead "
    "round "
    "it to the nearest\n   free point of the fold: r from B, or r/sin of the larger obtuse angle;\n"
    "3. short: at most one more point in each plane up to Ω = 270°, one more for each right angle turned "
    "above.\n\n"
    "*Radius* and *parallel* come out as the paper draws them. Its *intersection* and *fixed length* "
    "protect B, "
    "not BC: read\nliterally they come nearer to the second line than r, or leave the strict offset too "
    "soon, "
    "wherever the planes are two. They are\n*drawn back* here: the path leaves where the strict offset "
    "ends. The "
    "same holds for *radius* and *parallel* where the second\nline comes near. Blue in the pictures: the "
    "paper's "
    "text; red: what is cut.\n\n";

constexpr const char* kPlaneText =
    "## In the plane\n\n"
    "*Shortened* where the contour turns to the beam's side, *extended* along both tangents where it turns "
    "away by "
    "up to 90°,\n*inserted* (an arc of radius r round the corner) beyond, or where an extension would meet "
    "something else. The path is then the\nborder of the places that the beam's centre may take: parts "
    "that come "
    "too near to any part of any contour are cut away, and\nwhat that leaves uncut is reported by entity, "
    "place and "
    "depth.\n\n";

std::string spaceSection(const Proof& proof, const std::string& pictures) {
  const ProofGrid& grid = proof.grid;
  std::string text = kSpaceText;
  text += pictureTable(spacePictures(), pictures, 2);
  text += fmt::format(
      "\nα and β in steps of {:g}° from {:g}°, {} values of Ω from {:g}° to {:g}°, r = {:g} … {:g} mm, left "
      "and right: "
      "{} samples. *nearest*:\nleast distance of the path from the contour. *missed*: farthest any free "
      "point of the "
      "strict offset lies from the path.\n\n",
      grid.fold_step_deg, 0.5 * grid.fold_step_deg, grid.omegas_deg.size(), grid.omegas_deg.front(),
      grid.omegas_deg.back(), grid.radii_mm.front(), grid.radii_mm.back(), proof.space_samples);
  text += spaceTable(proof);
  text += fmt::format(
      "\nRefused, as they must be (Ω below 90°: no room for the head; above 350°: the beam pierces the "
      "second plane, "
      "the paper gives\nno figure): {} corners of {}. Refused within the limits: {}.\n"
      "Also refused, with line and place: lines along the fold (within 0.1°), axes askew to their line "
      "(0.5°) or on "
      "the other face, lines\nshorter than their joints take, paths that come nearer than r to a line "
      "farther on.\n\n"
      "What the beam does below its focus is not judged: above Ω = 270° it passes under the edge into what "
      "lies "
      "there.\n\n",
      proof.refused, proof.refused + proof.not_refused, proof.unexpected.size());
  return text;
}

std::string planeSection(const Proof& proof, const std::string& pictures) {
  const ProofGrid& grid = proof.grid;
  std::string text = kPlaneText;
  text += pictureTable(planePictures(), pictures, 3);
  text += fmt::format(
      "\nTurns in steps of {:g}°, arcs of both senses, both sides, r = {:g} … {:g} mm: {} samples, chords "
      "4e-6 mm off "
      "their curves.\n\n",
      grid.turn_step_deg, 2.0 * grid.radii_mm.front(), 2.0 * grid.radii_mm.back(), proof.plane_samples);
  text += planeTable(proof);
  return text;
}

}  // namespace

std::string proofPage(const Proof& proof, const std::string& pictures) {
  std::string text = spaceSection(proof, pictures) + planeSection(proof, pictures);
  text += fmt::format("\nVerdict: the proof {}.\n", proof.holds() ? "holds" : "**does not hold**");
  for (const std::string& corner : proof.unexpected) text += "- " + corner + "\n";
  return text;
}

}  // namespace kerfbench::planner
