// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/job/target.h"
#include "hil/calibrate/tables/table_files.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {

bool gcodeText(Bytes bytes) {
  return takes<planner::PlanError>([&] { (void)planner::readGcode(std::string(textIn(bytes))); });
}

/// The file tells its format, of six.
bool correctionTable(Bytes bytes) {
  return takes<calibrate::TableFileError>([&] { (void)calibrate::readTable(asFile("table", bytes)); });
}

bool controllerTable(Bytes bytes) {
  return takes<planner::PlanError>(
      [&] { (void)planner::CorrectionTable::read(asFile("correction.csv", bytes).string()); });
}

/// Twice, because the ending says how it is read.
bool imageTarget(Bytes bytes) {
  bool found = false;
  for (const char* name : {"image.hex", "image.elf"}) {
    (void)takes<planner::PlanError>(
        [&] { found = planner::findTarget(asFile(name, bytes)).has_value() || found; });
  }
  return found;
}

}  // namespace kerfbench::fuzz
