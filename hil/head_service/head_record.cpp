// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "hil/base/input_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/head_service/measured_sheet.h"
#include "hil/head_service/sheet_on_twin.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr int kMostIterations = 100;

/// What head.json says; the faults are those of its content.
struct Head {
  std::string machine;
  bool good{};
  int best{};
  double unmodelled_share{};
};

Head readHead(const fs::path& path) {
  const base::InputContent content = base::readInput(path, base::kLargestRecord_bytes);
  if (!content.bytes) {
    throw base::ConfigError(fmt::format("{}: {}; `calibrate head` with the same --results-dir writes it",
                                        path.string(), content.refusal));
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(*content.bytes);
    return {json.at("machine"), json.at("good"), json.at("best_iteration"), json.at("unmodelled_share")};
  } catch (const nlohmann::json::exception& error) {
    throw base::ConfigError(
        fmt::format("{}: is not what `calibrate head` writes: {}", path.string(), error.what()));
  }
}

/// Whatever digest it has: it is the record's own.
MeasuredSheet readSheet(const fs::path& folder) {
  const fs::path measured = folder / kSheetMeasured;
  const calibrate::MarkJob job = calibrate::readMarkJob(folder / kSheetJob);
  base::YamlReader file = base::YamlReader::openFile(measured);
  const std::string digest = file.text("digest");
  return readMeasured(measured, job, digest).value();
}

}  // namespace

HeadRecord readHeadRecord(const fs::path& results, const HeadSetup& setup) {
  const fs::path json = results / "head.json";
  const Head head = readHead(json);
  std::vector<std::string> faults;
  const auto fault = [&](const std::string& what) {
    faults.push_back(fmt::format("{}: {}", json.string(), what));
  };
  if (head.machine != setup.name)
    fault(fmt::format("machine: is of {}; {} is {}", head.machine, setup.machine.string(), setup.name));
  if (!head.good) fault("good: false: this head was not calibrated well enough to be held against it");
  if (head.best < 1 || head.best > kMostIterations)
    fault(fmt::format("best_iteration: {} is none", head.best));
  if (!(head.unmodelled_share > 0.0)) fault("unmodelled_share: must be above 0");
  if (faults.empty() && !fs::exists(results / "1-grid" / kSheetMeasured))
    fault(
        "no sheets lie beside it: it was made from pictures alone, which cannot be held against; calibrate "
        "by hand");
  if (!faults.empty()) throw base::ConfigError(fmt::format("{}", fmt::join(faults, "\n")));

  HeadRecord record;
  record.iterations = head.best;
  record.unmodelled_share = head.unmodelled_share;
  record.table = results / fmt::format("correction-{}.csv", head.best);
  for (int iteration = 1; iteration <= head.best; ++iteration) {
    const fs::path folder = results / fmt::format("{}-grid", iteration);
    std::optional<calibrate::AimGrid> table;
    if (fs::exists(folder / kSheetTable)) table = readControllerTable(folder / kSheetTable);
    for (const calibrate::HeadObservation& seen : observationsOf(readSheet(folder), table, iteration))
      record.observations.push_back(seen);
  }
  return record;
}

}  // namespace kerfbench::head_service
