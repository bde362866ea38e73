// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/sheet_by_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "firmware_under_test/planner/job/target.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/version.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/scenario/case.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPictures = "pictures";
constexpr const char* kTileList = "tiles.yaml";
constexpr double kSvgBorder_mm = 5.0;

/// All files of a folder by name, so that another picture is another digest.
std::string digestOfFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  std::string all;
  for (const fs::path& file : files) all += file.filename().string() + " " + base::sha256File(file) + "\n";
  return base::sha256(all);
}

}  // namespace

MeasuredSheet SheetByHand::operator()(const SheetOrder& order) const {
  const calibrate::MarkJob& job = order.job;
  const std::optional<calibrate::AimGrid>& table = order.table;
  SheetRequest request{job, 0, results_ / job.name, {}};
  const fs::path pictures = request.folder / kPictures;
  fs::create_directories(request.folder);
  const bool there = fs::exists(pictures / kTileList);
  const std::string digest = there ? digestOf(job, table, pictures) : "";
  if (there) {
    calibrate::writeMarkJob(request.folder / kSheetJob, job);
    const calibrate::MarkJob as_filed = calibrate::readMarkJob(request.folder / kSheetJob);
    if (auto measured = readMeasured(request.folder / kSheetMeasured, as_filed, digest)) return *measured;
    MeasuredSheet sheet = measurePictures(pictures, as_filed, setup_, bench_.threads);
    sheet.digest = digest;
    base::writeFileAtomically(request.folder / kSheetMeasured, measuredText(sheet));
    return sheet;
  }
  if (table) {
    request.table = request.folder / kSheetTable;
    base::writeFileAtomically(request.table, calibrate::csvTable(*table));
  }
  writeFiles(request);
  const std::string text = instructions(request);
  base::writeFileAtomically(request.folder / "NEXT.txt", text + "\n");
  if (fs::exists(pictures) && !fs::is_empty(pictures))
    throw SheetWanted(
        fmt::format("{}\nThere are pictures in {}, but no {}.", text, pictures.string(), kTileList));
  throw SheetWanted(text);
}

std::string SheetByHand::digestOf(const calibrate::MarkJob& job,
                                  const std::optional<calibrate::AimGrid>& table,
                                  const fs::path& pictures) const {
  return base::sha256(fmt::format("by hand {} {} {} {} {} {}", setup_.digest, calibrate::markJobDigest(job),
                                  table ? base::sha256(calibrate::csvTable(*table)) : "-",
                                  digestOfFolder(pictures), base::version(), kMeasuredVersion));
}

void SheetByHand::writeFiles(const SheetRequest& request) const {
  const scenario::Case test_case = sheetCase(setup_, bench_, request);
  planner::MachineParameters machine = scenario::plannerMachine(test_case);
  machine.target = planner::findTarget(test_case.scenario.firmware.image).value_or(planner::Target{});
  const planner::Plan plan = planner::plan(*test_case.dieline, machine, scenario::plannerJob(test_case));
  base::writeFileAtomically(request.folder / "job.gcode", plan.gcode);
  base::writeFileAtomically(request.folder / "program.txt", planner::programText(plan.program));
  base::writeFileAtomically(request.folder / "print.svg", printSvg(request.job));
}

std::string SheetByHand::instructions(const SheetRequest& request) const {
  const std::string folder = request.folder.string();
  const calibrate::MarkJob& job = request.job;
  const std::string table = request.table.empty()
                                ? "no correction table"
                                : fmt::format("the correction table {}", request.table.string());
  return fmt::format(
      "{0}: a sheet is to be cut, {1} marks of {2:g} mm. Everything is in {3}.\n"
      "  1. Take a board with the printed marks of print.svg (100 %); they hold its frame S.\n"
      "  2. Lay it under the head, at rest: the origin of S at x = {4:g}, y = {5:g} mm of the machine, axes "
      "parallel.\n"
      "  3. Give the controller {6}; change nothing else.\n"
      "  4. Cut marks.dxf: job.gcode, or program.txt as it goes to the reference controller.\n"
      "  5. Photograph the whole sheet, printed marks included, against the back light with camera {7}. "
      "Pictures go\n"
      "     to {3}/{8}, with {9}, a line for each:\n"
      "         version: 1\n"
      "         tiles:\n"
      "           - {{file: tile-0000.png, p_TV_mm: [-12.5, 40]}}    # where the camera stood on its table\n"
      "  6. Run again: {10}",
      job.name, job.marks.size(), job.size_mm, folder, -job.p_SW_mm.x(), -job.p_SW_mm.y() + 0.0, table,
      setup_.camera.camera_id, kPictures, kTileList, command_);
}

std::string printSvg(const calibrate::MarkJob& job) {
  Eigen::AlignedBox2d box;
  for (const RegistrationMark& mark : job.print) box.extend(mark.p_SM_mm);
  const Eigen::Vector2d border = Eigen::Vector2d::Constant(kSvgBorder_mm);
  box = {box.min() - border, box.max() + border};
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 "
      "{0:.3f} {1:.3f}\">\n",
      box.sizes().x(), box.sizes().y());
  for (const RegistrationMark& mark : job.print) {
    // y upwards, seen from above, as in S.
    text +=
        fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3f}\"/>\n", mark.p_SM_mm.x() - box.min().x(),
                    box.max().y() - mark.p_SM_mm.y(), 0.5 * mark.diameter_mm);
  }
  return text + "</svg>\n";
}

std::string firmwareOf(const fs::path& name) {
  if (name.empty()) return "";
  const fs::path image = fs::exists(name)
                             ? fs::absolute(name)
                             : name;  // Path of the user's image, or the name of one of the bench's.
  if (image.extension() == ".hex")
    return fmt::format("{{source: avr, image: '{}', mcu: atmega2560, clock_hz: 16000000}}", image.string());
  return fmt::format("{{source: native, image: '{}', mcu: native}}", image.string());
}

}  // namespace kerfbench::head_service
