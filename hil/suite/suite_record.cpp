// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/suite_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr int kSuiteRecordSchema = 1;

OrderedJson toJson(const SuiteRecord& record) {
  OrderedJson runs = OrderedJson::array();
  for (const auto& [name, run] : record.runs)
    runs.push_back({{"name", name}, {"inputs", run.inputs}, {"expected", run.expected}});
  OrderedJson files = OrderedJson::object();
  for (const auto& [path, sum] : record.files) files[path.string()] = sum;
  const Selection& selection = record.selection;
  return {{"schema_version", kSuiteRecordSchema},
          {"suite", record.name},
          {"kerfbench", record.bench_version},
          {"program_sha256", record.program_sha256},
          {"image", record.image.string()},
          {"tags", selection.tags},
          {"patterns", selection.patterns},
          {"names", selection.names ? OrderedJson(*selection.names) : OrderedJson()},
          {"part", record.part},
          {"left_out", record.left_out},
          {"runs", runs},
          {"files", files}};
}

SuiteRecord fromJson(const OrderedJson& json) {
  SuiteRecord record;
  record.name = json.at("suite").get<std::string>();
  record.bench_version = json.at("kerfbench").get<std::string>();
  record.program_sha256 = json.at("program_sha256").get<std::string>();
  record.image = json.at("image").get<std::string>();
  record.selection.tags = json.at("tags").get<std::vector<std::string>>();
  record.selection.patterns = json.at("patterns").get<std::vector<std::string>>();
  if (!json.at("names").is_null()) record.selection.names = json.at("names").get<std::vector<std::string>>();
  record.part = json.at("part").get<std::string>();
  record.left_out = json.at("left_out").get<std::size_t>();
  for (const OrderedJson& run : json.at("runs")) {
    record.runs.emplace_back(
        run.at("name").get<std::string>(),
        SuiteRecord::Run{run.at("inputs").get<std::string>(), run.at("expected").get<std::string>()});
  }
  for (const auto& [path, sum] : json.at("files").items()) record.files[path] = sum.get<std::string>();
  return record;
}

/// Files that are other ones now, a line each.
std::string changedFiles(const SuiteRecord& begun, const SuiteRecord& now) {
  std::string lines;
  for (const auto& [path, sum] : begun.files) {
    const auto found = now.files.find(path);
    if (found == now.files.end())
      lines += fmt::format("  {} is no longer used\n", path.string());
    else if (found->second != sum)
      lines += fmt::format("  {} has changed\n", path.string());
  }
  return lines;
}

std::string changedRuns(const SuiteRecord& begun, const SuiteRecord& now) {
  const std::map<std::string, SuiteRecord::Run> before(begun.runs.begin(), begun.runs.end());
  const std::map<std::string, SuiteRecord::Run> after(now.runs.begin(), now.runs.end());
  std::string lines;
  for (const auto& [name, run] : before) {
    const auto found = after.find(name);
    if (found == after.end())
      lines += fmt::format("  the plan has no run {} any more\n", name);
    else if (found->second.expected != run.expected)
      lines += fmt::format("  of {} something else is expected, or its tags have changed\n", name);
    else if (found->second.inputs != run.inputs)
      lines += fmt::format("  run {} has other options or files\n", name);
  }
  for (const auto& [name, run] : after)
    if (!before.contains(name)) lines += fmt::format("  the plan has a new run {}\n", name);
  if (lines.empty() && begun.runs != now.runs) lines = "  the runs of the plan have another order\n";
  return lines;
}

}  // namespace

std::string inputsOf(const PlannedRun& run, const std::string& program_sha256) {
  const RunChoices& choices = run.choices;
  OrderedJson files = OrderedJson::array();
  for (const auto& [path, sum] : run.files) files.push_back({path.filename().string(), sum});
  const OrderedJson json{
      {"program", program_sha256},
      {"seed", choices.seed ? OrderedJson(*choices.seed) : OrderedJson()},
      {"imperfections", choices.imperfections.value_or("")},
      {"twin", choices.twin.value_or("")},
      {"time_limit_s", choices.time_limit_s ? OrderedJson(*choices.time_limit_s) : OrderedJson()},
      {"limits", choices.limits},
      {"files", files}};
  return base::sha256(json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
}

SuiteRecord recordOf(const Plan& plan, const std::string& bench_version, const std::string& program_sha256) {
  SuiteRecord record;
  record.name = plan.name;
  record.bench_version = bench_version;
  record.program_sha256 = program_sha256;
  for (const PlannedRun& run : plan.runs) {
    record.runs.emplace_back(
        run.name, SuiteRecord::Run{inputsOf(run, program_sha256),
                                   fmt::format("{}; {}", describe(run.expect), fmt::join(run.tags, ", "))});
    record.files.insert(run.files.begin(), run.files.end());
  }
  return record;
}

void writeRecord(const SuiteRecord& record, const fs::path& folder) {
  base::writeFileAtomically(folder / kSuiteRecord,
                            toJson(record).dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

SuiteRecord readRecord(const fs::path& folder) {
  const fs::path path = folder / kSuiteRecord;
  const auto text = base::fileContent(path);
  if (!text)
    throw base::InputError(fmt::format("{}: holds no suite: it has no {}", folder.string(), kSuiteRecord));
  const OrderedJson json = OrderedJson::parse(*text, nullptr, false);
  if (!json.is_object()) throw base::InputError(fmt::format("{}: is broken", path.string()));
  if (const OrderedJson version = json.value("schema_version", OrderedJson());
      version != kSuiteRecordSchema) {
    throw base::InputError(
        fmt::format("{}: schema_version is {}, and this bench reads {}: go on with the one that "
                    "began the suite, or begin anew",
                    path.string(), version.dump(), kSuiteRecordSchema));
  }
  try {
    return fromJson(json);
  } catch (const OrderedJson::exception&) {
    throw base::InputError(fmt::format("{}: lacks what a suite records", path.string()));
  }
}

void refuseChanged(const SuiteRecord& begun, const SuiteRecord& now, const fs::path& folder) {
  std::string lines;
  if (begun.name != now.name)
    lines += fmt::format("  it is the suite {}, and the plan's name is {}\n", begun.name, now.name);
  if (begun.program_sha256 != now.program_sha256)
    lines += fmt::format("  it was begun by another build of kerfbench ({}; this is {})\n",
                         begun.bench_version, now.bench_version);
  lines += changedFiles(begun, now);
  // Other files and another program are other inputs as well: that is told once.
  if (lines.empty()) lines += changedRuns(begun, now);
  if (lines.empty()) return;
  lines.pop_back();
  throw base::InputError(fmt::format(
      "{}: cannot be resumed, its results would be of different inputs:\n{}\nBegin the suite anew",
      folder.string(), lines));
}

}  // namespace kerfbench::suite
