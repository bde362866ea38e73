// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/job_folder.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/file_content.h"

namespace kerfbench::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using State = JobFolder::State;

constexpr int kSchemaVersion = 1;
constexpr std::array kHowNames{"exited", "signal", "not started"};

/// Path in the folder -> "BYTES SHA-256" of a file, "-> TARGET" of a link.
using Content = std::map<std::string, std::string>;

Content contentOf(const fs::path& folder) {
  Content content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().lexically_relative(folder).generic_string();
    if (path == kJobRecord) continue;
    if (entry.is_symlink()) {
      content[path] = "-> " + fs::read_symlink(entry.path()).generic_string();
    } else if (entry.is_regular_file()) {
      content[path] = fmt::format("{} {}", entry.file_size(), base::sha256File(entry.path()));
    }
  }
  return content;
}

Json recordOf(const Job& job, const JobEnd& end) {
  Json files = Json::object();
  for (const auto& [path, sum] : contentOf(job.folder)) files[path] = sum;
  return {{"schema_version", kSchemaVersion},
          {"name", job.name},
          {"inputs", job.inputs},
          {"command", job.command},
          {"ended", kHowNames.at(static_cast<std::size_t>(end.how))},
          {"code", end.code},
          {"wall_s", end.wall_s},
          {"files", files}};
}

/// @throws Json::exception, std::out_of_range for what no job wrote.
JobEnd endIn(const Json& record) {
  const std::string how = record.at("ended").get<std::string>();
  JobEnd end;
  std::size_t i = 0;
  while (kHowNames.at(i) != how) ++i;
  end.how = static_cast<JobEnd::How>(i);
  end.code = record.at("code").get<int>();
  end.wall_s = record.at("wall_s").get<double>();
  return end;
}

/// The first difference of what is there from what was recorded; empty: none.
std::string differenceOf(const Content& there, const Content& recorded) {
  for (const auto& [path, sum] : recorded) {
    const auto found = there.find(path);
    if (found == there.end()) return fmt::format("'{}' is missing", path);
    if (found->second != sum) return fmt::format("'{}' was changed", path);
  }
  for (const auto& [path, sum] : there)
    if (!recorded.contains(path)) return fmt::format("'{}' was added", path);
  return {};
}

JobFolder judged(const Job& job, const Json& record) {
  const std::string place = job.folder.string();
  if (!record.is_object())
    return {State::kDamaged, fmt::format("{}: its {} is broken", place, kJobRecord), {}};
  if (record.value("schema_version", Json()) != kSchemaVersion) {
    return {State::kForeign,
            fmt::format("{}: its {} is of schema_version {}, and this bench reads {}", place, kJobRecord,
                        record.value("schema_version", Json()).dump(), kSchemaVersion),
            {}};
  }
  try {
    const JobEnd end = endIn(record);
    if (record.at("inputs").get<std::string>() != job.inputs)
      return {State::kOtherInputs, fmt::format("{}: is the result of other inputs", place), {}};
    const std::string difference = differenceOf(contentOf(job.folder), record.at("files").get<Content>());
    if (difference.empty()) return {State::kWhole, {}, end};
    return {State::kDamaged, fmt::format("{}: is not what the run left: {}", place, difference), {}};
  } catch (const Json::exception&) {
  } catch (const std::out_of_range&) {
  }
  return {State::kDamaged, fmt::format("{}: its {} lacks what a job records", place, kJobRecord), {}};
}

/// The first free number among NAME.1, NAME.2 …
int freeNumber(const fs::path& folder) {
  int number = 1;
  while (fs::exists(fs::symlink_status(fmt::format("{}.{}", folder.string(), number)))) ++number;
  return number;
}

}  // namespace

JobFolder lookAt(const Job& job) {
  const fs::file_status status = fs::symlink_status(job.folder);
  if (!fs::exists(status)) return {};
  if (!fs::is_directory(status))
    return {State::kForeign, fmt::format("{}: is no folder", job.folder.string()), {}};
  if (fs::is_empty(job.folder)) return {};
  if (fs::exists(job.folder / kJobRecord)) {
    const std::string text = base::fileContent(job.folder / kJobRecord).value_or("");
    return judged(job, Json::parse(text, nullptr, false));
  }
  // The log is there before the command begins.
  if (fs::exists(job.folder / kJobLog))
    return {State::kUnfinished, fmt::format("{}: was interrupted", job.folder.string()), {}};
  return {State::kForeign, fmt::format("{}: holds what no run wrote", job.folder.string()), {}};
}

void recordEnd(const Job& job, const JobEnd& end) {
  base::writeFileAtomically(job.folder / kJobRecord,
                            recordOf(job, end).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

fs::path setAside(const fs::path& folder) {
  fs::path place = fmt::format("{}.{}", folder.string(), freeNumber(folder));
  fs::rename(folder, place);
  return place;
}

int asideOf(const fs::path& folder) { return freeNumber(folder) - 1; }

}  // namespace kerfbench::batch
