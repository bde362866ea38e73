// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/sheet_by_hand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "firmware_under_test/planner/job/target.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/version.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/head_service/board_print.h"
#include "hil/head_service/frame_plan.h"
#include "hil/head_service/scanned_sheet.h"
#include "hil/scenario/case.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPictures = "pictures";
constexpr const char* kTileList = "tiles.yaml";

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

std::string tableWords(const SheetRequest& request) {
  return request.table.empty() ? "no correction table"
                               : fmt::format("the correction table {}", request.table.string());
}

Eigen::Vector2d originUnderHead(const calibrate::MarkJob& job) {
  return Eigen::Vector2d(0.0, 0.0) - job.p_SW_mm;
}

std::vector<std::string> cutting(const SheetRequest& request) {
  const Eigen::Vector2d rulers = rulersOf(request.job), origin = originUnderHead(request.job);
  return {
      fmt::format(
          "Print print.pdf or print.svg at 100 % on a board of at least its size, and measure both rulers: "
          "{:g} and {:g} mm. The printed marks hold the sheet's frame S.",
          rulers.x(), rulers.y()),
      fmt::format(
          "Lay it under the head, at rest: the origin of S at x = {:g}, y = {:g} mm of the machine, +x the "
          "way that the belt runs.",
          origin.x(), origin.y()),
      fmt::format("Give the controller {}; change nothing else.", tableWords(request)),
      "Cut marks.dxf: job.gcode, or program.txt as it goes to the reference controller."};
}

std::vector<std::string> photographing(const SheetRequest& request, const HeadSetup& setup) {
  return {fmt::format(
      "Photograph the whole sheet, printed marks included, against the back light with camera {}: the "
      "pictures that {} names, each where it says that the camera stands.",
      setup.camera.camera_id, (request.folder / kPictures / kTileList).string())};
}

/// Three lines for the board itself.
std::vector<std::string> onTheBoard(const SheetRequest& request) {
  const Eigen::Vector2d rulers = rulersOf(request.job), origin = originUnderHead(request.job);
  return {fmt::format("Printed at 100 %: the rulers measure {:g} and {:g} mm.", rulers.x(), rulers.y()),
          fmt::format("Under the head: origin at x = {:g}, y = {:g} mm of the machine, at rest.", origin.x(),
                      origin.y()),
          fmt::format("Cut job.gcode with {}, then photograph or scan all of it.",
                      request.table.empty() ? "no correction table" : kSheetTable)};
}

std::vector<std::string> wordsOf(const FolderOfFrames& frames, const fs::path& pictures) {
  std::vector<std::string> words;
  if (!frames.none()) {
    words.push_back(fmt::format("Of the {} pictures that {} names, {} are missing: {}.", frames.named,
                                (pictures / kTileList).string(), frames.missing.size(),
                                fmt::join(frames.missing, ", ")));
  }
  if (!frames.unnamed.empty()) {
    words.push_back(fmt::format("There are pictures that {} does not name: {}.",
                                (pictures / kTileList).string(), fmt::join(frames.unnamed, ", ")));
  }
  return words;
}

}  // namespace

MeasuredSheet SheetByHand::operator()(const SheetOrder& order) const {
  SheetRequest request{order.job, 0, results_ / order.job.name, {}};
  const fs::path pictures = request.folder / kPictures;
  fs::create_directories(pictures);
  if (!fs::exists(pictures / kTileList)) {
    const bool others = scanIn(pictures).empty() && !picturesIn(pictures).empty();
    if (others) {
      // Under their own names they might pass for those of the plan.
      want(order, std::move(request),
           {fmt::format("There are pictures in {}, but no {}.", pictures.string(), kTileList)});
    }
    base::writeFileAtomically(pictures / kTileList, tilesTemplate(order.job, setup_.camera,
                                                                  expectedFrames(order.job, setup_.camera)));
  }
  if (!fs::exists(pictures / kScanList))
    base::writeFileAtomically(pictures / kScanList, scanTemplate(setup_.scanner_file));
  const FolderOfFrames frames = framesIn(pictures);
  if (scanIn(pictures).empty() && !frames.whole()) want(order, std::move(request), wordsOf(frames, pictures));
  try {
    MeasuredSheet sheet = measured(order, request);
    steps_->measured(order, sheet);
    return sheet;
  } catch (const std::runtime_error& error) {
    steps_->refused(order, error.what());
    steps_->write();
    throw;
  }
}

MeasuredSheet SheetByHand::measured(const SheetOrder& order, const SheetRequest& request) const {
  const fs::path pictures = request.folder / kPictures;
  calibrate::writeMarkJob(request.folder / kSheetJob, order.job);
  const calibrate::MarkJob as_filed = calibrate::readMarkJob(request.folder / kSheetJob);
  const std::string digest = digestOf(order.job, order.table, pictures);
  if (auto before = readMeasured(request.folder / kSheetMeasured, as_filed, digest)) return *before;
  MeasuredSheet sheet = scanIn(pictures).empty() ? measurePictures(pictures, as_filed, setup_, bench_.threads)
                                                 : measureScan(pictures, as_filed, setup_, bench_.threads);
  sheet.digest = digest;
  base::writeFileAtomically(request.folder / kSheetMeasured, measuredText(sheet));
  return sheet;
}

void SheetByHand::want(const SheetOrder& order, SheetRequest request,
                       const std::vector<std::string>& missing) const {
  if (order.table) {
    request.table = request.folder / kSheetTable;
    base::writeFileAtomically(request.table, calibrate::csvTable(*order.table));
  }
  const std::vector<std::string> cut = cutting(request), photograph = photographing(request, setup_);
  writeFiles(order, request);
  std::string text =
      fmt::format("{}: a sheet is to be cut, {} marks of {:g} mm. Everything is in {}.", order.job.name,
                  order.job.marks.size(), order.job.size_mm, request.folder.string());
  int number = 0;
  for (const auto* steps : {&cut, &photograph}) {
    for (const std::string& step : *steps) text += fmt::format("\n  {}. {}", ++number, step);
  }
  text += fmt::format("\n  {}. Run again: {}", ++number, command_);
  base::writeFileAtomically(request.folder / "NEXT.txt", text + "\n");
  steps_->wanted(order, cut, photograph, missing);
  steps_->write();
  for (const std::string& line : missing) text += "\n" + line;
  throw SheetWanted(text);
}

std::string SheetByHand::digestOf(const calibrate::MarkJob& job,
                                  const std::optional<calibrate::AimGrid>& table,
                                  const fs::path& pictures) const {
  return base::sha256(fmt::format("by hand {} {} {} {} {} {}", setup_.digest, calibrate::markJobDigest(job),
                                  table ? base::sha256(calibrate::csvTable(*table)) : "-",
                                  digestOfFolder(pictures), base::version(), kMeasuredVersion));
}

void SheetByHand::writeFiles(const SheetOrder& order, const SheetRequest& request) const {
  const scenario::Case test_case = sheetCase(setup_, bench_, request);
  planner::MachineParameters machine = scenario::plannerMachine(test_case);
  machine.target = planner::findTarget(test_case.scenario.firmware.image).value_or(planner::Target{});
  const planner::Plan plan = planner::plan(*test_case.dieline, machine, scenario::plannerJob(test_case));
  base::writeFileAtomically(request.folder / "job.gcode", plan.gcode);
  base::writeFileAtomically(request.folder / "program.txt", planner::programText(plan.program));
  const PrintPage print = boardPrint(request.job, {order.sheet + 1, onTheBoard(request)});
  base::writeFileAtomically(request.folder / "print.svg", svgOf(print));
  base::writeFileAtomically(request.folder / "print.pdf", pdfOf(print));
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
