// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/dxf_tags.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

void cutIntoTags(DxfFile& file, FaultList& faults, base::ShareProgress& progress) {
  std::string_view rest = file.text;
  if (rest.starts_with("AutoCAD Binary DXF")) faults.fatal(0, "binary DXF is not read; save it as ASCII DXF");
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  // Counted first: a vector that grows would hold the largest file's groups twice.
  file.tags.reserve(static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '\n')) / 2 + 1);
  int line = 0;
  const auto nextLine = [&]() -> std::optional<std::string_view> {
    if (rest.empty()) return std::nullopt;
    const std::size_t end = rest.find('\n');
    const std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    ++line;
    return trimmed(text);
  };
  while (const auto code_text = nextLine()) {
    if (code_text->empty() && trimmed(rest).empty()) break;
    const auto code = parsedNumber<int>(*code_text);
    if (!code || *code < -5 || *code > 1071) {
      // Words of a file that is no drawing at all are nobody's business.
      if (file.tags.empty()) faults.fatal(line, "expected a group code: this is no DXF drawing");
      faults.fatal(line, fmt::format("expected a group code, found {}", inQuotes(*code_text)));
    }
    const auto value = nextLine();
    if (!value) faults.fatal(line, "the file ends inside a group: truncated?");
    file.tags.push_back({*code, line, *value});
    progress.done(file.text.size() - rest.size());
    if (*code == 0 && *value == "EOF") return;
  }
  faults.fatal(line, "the file ends without EOF: truncated, or no DXF file");
}

void readHeader(std::span<const DxfTag> tags, DxfFile& file) {
  for (std::size_t i = 0; i + 1 < tags.size(); ++i) {
    if (tags[i].code == 9) file.header.emplace(tags[i].text, tags[i + 1]);
  }
}

std::vector<DxfRecord> recordsOf(std::span<const DxfTag> tags) {
  std::vector<DxfRecord> records;
  std::size_t start = 0;
  for (std::size_t i = 1; i <= tags.size(); ++i) {
    if (i < tags.size() && tags[i].code != 0) continue;
    if (tags[start].code == 0) records.push_back({tags.subspan(start, i - start)});
    start = i;
  }
  return records;
}

void readBlocks(const std::vector<DxfRecord>& records, DxfFile& file, FaultList& faults) {
  DxfBlock* open = nullptr;
  for (const DxfRecord& record : records) {
    if (record.type() == "BLOCK") {
      const DxfFields fields(record, faults);
      const std::string name(fields.text(2, ""));
      const auto [it, is_new] = file.blocks.try_emplace(lowered(name));
      if (!is_new) faults.add(record.line(), fmt::format("block {} is defined twice", inQuotes(name)));
      open = &it->second;
      *open = {name, fields.number(10, 0.0), fields.number(20, 0.0), {}};
    } else if (record.type() == "ENDBLK") {
      open = nullptr;
    } else if (open != nullptr) {
      open->records.push_back(record);
    }
  }
  if (open != nullptr) faults.add(0, fmt::format("block {} has no ENDBLK", inQuotes(open->name)));
}

}  // namespace

double dxfNumber(const DxfTag& tag, FaultList& faults) {
  const auto value = parsedNumber<double>(tag.text);
  if (!value) {
    faults.add(tag.line, fmt::format("group {} is no number: {}", tag.code, inQuotes(tag.text)));
    return 0.0;
  }
  if (std::abs(*value) > 1e9) {
    faults.add(tag.line, fmt::format("group {} is out of range: {}", tag.code, inQuotes(tag.text)));
    return 0.0;
  }
  return *value;
}

std::optional<double> DxfFields::find(int code) const {
  for (const DxfTag& tag : record_.tags) {
    if (tag.code == code) return dxfNumber(tag, faults_);
  }
  return std::nullopt;
}

double DxfFields::number(int code) const {
  const auto value = find(code);
  if (!value) faults_.add(record_.line(), fmt::format("{} lacks group {}", record_.type(), code));
  return value.value_or(0.0);
}

int DxfFields::integer(int code, int otherwise) const {
  for (const DxfTag& tag : record_.tags) {
    if (tag.code != code) continue;
    const auto value = parsedNumber<int>(tag.text);
    if (!value) faults_.add(tag.line, fmt::format("group {} is no integer: {}", code, inQuotes(tag.text)));
    return value.value_or(otherwise);
  }
  return otherwise;
}

std::string_view DxfFields::text(int code, std::string_view otherwise) const {
  for (const DxfTag& tag : record_.tags) {
    if (tag.code == code) return tag.text;
  }
  return otherwise;
}

void parseDxf(std::string text, DxfFile& file, FaultList& faults, base::ShareProgress& progress) {
  file.text = std::move(text);
  cutIntoTags(file, faults, progress);
  const std::span<const DxfTag> tags = file.tags;
  bool has_entities = false;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (tags[i].code != 0 || tags[i].text != "SECTION") continue;
    if (i + 1 >= tags.size() || tags[i + 1].code != 2) faults.fatal(tags[i].line, "a SECTION without a name");
    const std::string_view name = tags[i + 1].text;
    const int line = tags[i].line;
    const std::size_t begin = i + 2;
    std::size_t end = begin;
    while (end < tags.size() &&
           !(tags[end].code == 0 && (tags[end].text == "ENDSEC" || tags[end].text == "SECTION")))
      ++end;
    if (end >= tags.size() || tags[end].text == "SECTION") {
      faults.fatal(line, fmt::format("section {} has no ENDSEC: truncated?", inQuotes(name)));
    }
    const auto body = tags.subspan(begin, end - begin);
    if (name == "HEADER") readHeader(body, file);
    if (name == "BLOCKS" && !body.empty()) readBlocks(recordsOf(body), file, faults);
    if (name == "TABLES" && !body.empty()) file.tables = recordsOf(body);
    if (name == "OBJECTS" && !body.empty()) file.objects = recordsOf(body);
    if (name == "ENTITIES") {
      has_entities = true;
      if (!body.empty()) file.entities = recordsOf(body);
    }
    i = end;
  }
  if (!has_entities) faults.fatal(0, "no ENTITIES section");
}

}  // namespace kerfbench::dieline
