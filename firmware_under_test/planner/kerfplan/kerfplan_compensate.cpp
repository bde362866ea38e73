// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_compensate.h"

#include <array>
#include <filesystem>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/compensation/proof.h"
#include "firmware_under_test/planner/compensation/space_check.h"
#include "firmware_under_test/planner/compensation/space_file.h"
#include "firmware_under_test/planner/compensation/svg_sheet.h"
#include "firmware_under_test/planner/kerfplan/drawing_options.h"
#include "firmware_under_test/planner/kerfplan/input_text.h"
#include "firmware_under_test/planner/kerfplan/output_text.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "hil/base/terminal.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace kerfbench::planner {

struct CompensateCommand::Options {
  dieline::DrawingArguments drawing;
  std::string input;
  std::string output;
  JobParameters job;
  Side side{Side::kLeft};
  SpaceLimits limits;
  JointLaw joints{JointLaw::kOurs};
  double chord_error_mm{kChordErrorMm};
};

namespace {

std::string extensionOf(const std::string& path) {
  return CLI::detail::to_lower(std::filesystem::path(path).extension().string());
}

constexpr double kDegrees = 57.295779513082323;
/// Share of the radius from which a joint's fault is told.
constexpr double kShows = 1e-4;

std::string jointSentence(const SpaceJointReport& joint, const SpaceContour& contour) {
  const std::string where = joint.point < contour.file_lines.size()
                                ? fmt::format("line {}", contour.file_lines[joint.point])
                                : "joint";
  if (joint.joint == SpaceJoint::kPlanar) return where + ": planar\n";
  return fmt::format("{}: {}{}, alpha {:.2f} deg, beta {:.2f} deg, Omega {:.2f} deg{}\n", where,
                     nameOf(joint.joint), joint.number > 0 ? fmt::format(" (case {})", joint.number) : "",
                     joint.corner.alpha_rad * kDegrees, joint.corner.beta_rad * kDegrees,
                     joint.corner.omega_rad * kDegrees, joint.drawn_back ? ", drawn back" : "");
}

/// Sentence on what a joint of the paper's text does that it should not; empty if there is nothing.
std::string literalSentence(const SpaceCheck& check, double radius_mm) {
  std::string text;
  if (check.nearest_mm < radius_mm * (1.0 - kShows)) {
    text += fmt::format("  burns: it comes as near as {:.4f} mm to the contour, {:.2f} of the radius\n",
                        check.nearest_mm, check.nearest_mm / radius_mm);
  }
  if (check.missed_mm > radius_mm * kShows) {
    text += fmt::format("  departs: free places of the strict offset lie up to {:.4f} mm beside it\n",
                        check.missed_mm);
  }
  return text;
}

/// Sentences on the curves and joints of a path; joints between the chords of one curve are only counted.
std::string spaceSummary(const SpaceContour& contour, const SpacePath& path, JointLaw law, double radius_mm) {
  std::string text;
  for (const SpaceCurve& curve : contour.curves) {
    text += fmt::format("line {}: a curve of {} chord{}, no more than {:.4f} mm off it\n", curve.file_line,
                        curve.chords, curve.chords == 1 ? "" : "s", curve.error_mm);
  }
  for (const SpaceJointReport& joint : path.joints) {
    const SpaceCurve* curve = contour.curveOf(joint.point);
    const bool inside = curve != nullptr && joint.point > curve->first_point;
    std::string literal;
    if (law == JointLaw::kPaper && joint.joint != SpaceJoint::kPlanar) {
      literal = literalSentence(checkJoint(contour, path, joint, radius_mm), radius_mm);
    }
    if (!inside || !literal.empty()) text += jointSentence(joint, contour) + literal;
  }
  for (const std::string& burn : path.burns) text += burn + "\n";
  return text;
}

std::string planeSummary(const Compensated& done) {
  std::array<int, 4> kinds{};
  for (const Joint& joint : done.offset.joints) ++kinds[static_cast<std::size_t>(joint.kind)];
  std::string text =
      fmt::format("{} contour{}, {} path{}; joints: {} tangent, {} shortened, {} extended, {} inserted\n",
                  done.contours.size(), done.contours.size() == 1 ? "" : "s", done.offset.paths.size(),
                  done.offset.paths.size() == 1 ? "" : "s", kinds[0], kinds[1], kinds[2], kinds[3]);
  for (const BeamPath& path : done.offset.paths) {
    const Contour& contour = done.contours[path.contour];
    double length = 0.0;
    for (const Segment& segment : path.segments) length += segment.lengthMm();
    std::vector<int> entities;
    for (const Segment& segment : contour.segments) entities.push_back(segment.entity);
    const char* side = contour.side == Side::kLeft ? "left" : "right";
    text += fmt::format("  {:.3f} mm {}, {} of {}\n", length, contour.closed ? "closed" : "open", side,
                        entityNames(entities));
  }
  return text;
}

/// Refuses options that the kind of file makes no use of.
void refuseIdle(const CLI::App& command, bool in_space) {
  const std::vector<const char*> of_drawings{"--open-cuts", "--allow-lost", "--unit", "--page", "--scale",
                                             "--turn",      "--shift",      "--once", "--layer"};
  const std::vector<const char*> of_space{"--side", "--pierced", "--joints", "--chord-error"};
  std::string faults;
  for (const char* option : in_space ? of_drawings : of_space) {
    if (command.count(option) == 0) continue;
    faults += fmt::format("{}{} has no effect: it is for {}", faults.empty() ? "" : "\n", option,
                          in_space ? "drawings" : "contours in space (.xyz)");
  }
  if (!faults.empty()) throw PlanError(faults);
}

}  // namespace

void addKerfOptions(CLI::App& app, JobParameters& j) {
  using OpenCuts = JobParameters::OpenCuts;
  const std::map<std::string, OpenCuts> sides{
      {"line", OpenCuts::kOnTheLine}, {"left", OpenCuts::kLeft}, {"right", OpenCuts::kRight}};
  const std::string group = "Kerf";
  app.add_option(
         "--kerf-radius", j.kerf_radius_mm,
         "Half the width of a cut, mm: the beam runs beside the cuts by it, so that their edges lie on "
         "the dieline; 0: on the lines. Creases, half-cuts and perforations are not moved")
      ->group(group)
      ->capture_default_str();
  app.add_option("--open-cuts", j.open_cuts,
                 "Where the beam runs along open cuts: on the line, left or right of it as drawn")
      ->transform(CLI::CheckedTransformer(sides, CLI::ignore_case))
      ->default_str("line")
      ->group(group);
  app.add_option_function<std::string>(
         "--allow-lost",
         [&j](const std::string& list) { j.allow_lost = entityRangesFrom(list, "--allow-lost"); },
         "Entities of which features smaller than the kerf may be lost, by id: 12,13-15; without them the "
         "drawing is refused")
      ->group(group);
}

CompensateCommand::CompensateCommand(CLI::App& app) : options_(std::make_shared<Options>()) {
  sub_ = app.add_subcommand("compensate",
                            "Say how the beam runs beside a drawing at --kerf-radius, and draw it; or write "
                            "the path in X Y Z A C beside\n"
                            "a contour in space (.xyz: a point a line, x y z in mm and the axis i j k of the "
                            "line that begins there;\nbetween two points also via, centre or bezier, and "
                            "rows of spline)");
  sub_->add_option("FILE", options_->input,
                   "A drawing (.dxf, .svg, .pdf, .cf2), or a contour in space (.xyz)")
      ->required();
  sub_->add_option(
      "-o,--output", options_->output,
      "Of a drawing: an .svg picture of dieline, path and cut. Of a contour in space: G-code instead of "
      "standard output");
  options_->job.given_by = GivenBy::kCommandLine;
  addKerfOptions(*sub_, options_->job);
  addDrawingOptions(*sub_, options_->drawing);
  const std::map<std::string, Side> sides{{"left", Side::kLeft}, {"right", Side::kRight}};
  sub_->add_option("--side", options_->side, "Side of the beam, seen from the head (.xyz)")
      ->transform(CLI::CheckedTransformer(sides, CLI::ignore_case))
      ->default_str("left")
      ->group("In space");
  const std::map<std::string, JointLaw> laws{{"ours", JointLaw::kOurs}, {"paper", JointLaw::kPaper}};
  sub_->add_option(
          "--joints", options_->joints,
          "Joints over folds: ours, never nearer than the radius, or the paper's four as its text has "
          "them; where these\nburn or depart is told (.xyz)")
      ->transform(CLI::CheckedTransformer(laws, CLI::ignore_case))
      ->default_str("ours")
      ->group("In space");
  sub_->add_option("--chord-error", options_->chord_error_mm,
                   "Farthest that arcs and curves may lie from the chords that they become, mm (.xyz)")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str()
      ->group("In space");
  sub_->add_option(
          "--pierced", options_->limits.pierced_deg,
          "Refuse edges within so many degrees of 360, where the beam pierces the second plane (.xyz)")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str()
      ->group("In space");
}

bool CompensateCommand::run() const {
  if (!sub_->parsed()) return false;
  const Options& o = *options_;
  if (!(o.job.kerf_radius_mm > 0.0)) throw PlanError("compensate needs a --kerf-radius > 0");
  const bool in_space = extensionOf(o.input) == ".xyz";
  refuseIdle(*sub_, in_space);
  if (in_space) {
    try {
      SpaceContour contour = readSpaceContour(inputText(o.input), o.input, o.chord_error_mm);
      contour.side = o.side;
      const SpacePath path = offsetInSpace(contour, o.job.kerf_radius_mm, o.limits, o.joints);
      base::toTerminal(stderr, spaceSummary(contour, path, o.joints, o.job.kerf_radius_mm));
      writeOutput(o.output, writePoses(posesOf(path.points)));
    } catch (const CompensationError& error) {
      throw PlanError(o.input + ":\n" + error.what());
    }
    return true;
  }
  const dieline::Dieline dieline = dieline::readDieline(o.input, dieline::drawingOptionsFrom(o.drawing));
  const Compensated done = compensate(dieline, o.job);
  base::toTerminal(stdout, planeSummary(done));
  for (const std::string& note : done.notes) base::toTerminal(stdout, note + "\n");
  if (o.output.empty()) return true;
  std::vector<std::vector<Segment>> contours;
  std::vector<std::vector<Segment>> paths;
  for (const Contour& contour : done.contours) contours.push_back(contour.segments);
  for (const BeamPath& path : done.offset.paths) paths.push_back(path.segments);
  writeOutput(o.output, kerfPicture(contours, paths, o.job.kerf_radius_mm));
  return true;
}

ProveCommand::ProveCommand(CLI::App& app) : folder_(std::make_shared<std::string>("docs/explanation")) {
  sub_ = app.add_subcommand(
      "prove-compensation",
      "Try the compensation on all joints, in the plane and in space, check it by samples, and "
      "write compensation.md with its pictures");
  sub_->add_option("-o,--output", *folder_, "Folder to write to; the pictures go to its compensation/")
      ->capture_default_str();
}

bool ProveCommand::run() const {
  if (!sub_->parsed()) return false;
  const std::filesystem::path folder(*folder_);
  std::filesystem::create_directories(folder / "compensation");
  const Proof proof = prove({});
  writeOutput((folder / "compensation.md").string(), proofPage(proof, "compensation"));
  for (const auto& pictures : {planePictures(), spacePictures()}) {
    for (const Picture& picture : pictures) {
      writeOutput((folder / "compensation" / (picture.name + ".svg")).string(),
                  "<!-- SPDX-License-Identifier: Apache-2.0 -->\n" + picture.svg);
    }
  }
  if (!proof.holds())
    throw std::runtime_error("the proof does not hold, see " + (folder / "compensation.md").string());
  base::toTerminal(stdout, fmt::format("the proof holds: {}\n", (folder / "compensation.md").string()));
  return true;
}

}  // namespace kerfbench::planner
