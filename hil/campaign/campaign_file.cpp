// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/campaign_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "hil/base/number_from.h"
#include "hil/base/text.h"
#include "hil/campaign/grid.h"
#include "hil/campaign/key_tree.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;
using base::YamlReader;

constexpr std::size_t kMostValues = 10'000;
constexpr std::size_t kLongestName = 100;
/// A normal distribution that its bounds cut down to less than this share is not what its author meant.
constexpr double kLeastInBounds = 0.01;

bool isName(const std::string& text) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_. ";
  return !text.empty() && text.size() <= kLongestName &&
         text.find_first_not_of(kLetters) == std::string::npos && base::trimmed(text) == text;
}

std::string readName(YamlReader& section) {
  std::string name = section.text("name");
  if (!name.empty() && !isName(name))
    section.fault("name", fmt::format("{} is no name of letters, digits, blanks, '-', '_' and '.'",
                                      base::inQuotes(name)));
  return name;
}

double normalBelow(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

Values readNormal(YamlReader normal) {
  Values values{.kind = Values::Kind::kNormal};
  values.mean = normal.number("mean", {});
  values.sigma = normal.number("sigma", {.min = 1e-300});
  values.min = normal.number("min", {.fallback = values.mean - 4.0 * values.sigma});
  values.max = normal.number("max", {.fallback = values.mean + 4.0 * values.sigma});
  if (values.min >= values.max) {
    normal.fault("max", "must be larger than min");
  } else if (values.sigma > 0.0 && normalBelow((values.max - values.mean) / values.sigma) -
                                           normalBelow((values.min - values.mean) / values.sigma) <
                                       kLeastInBounds) {
    normal.fault("mean", fmt::format("the bounds {} … {} leave less than 1 % of this distribution",
                                     values.min, values.max));
  }
  return values;
}

Values readBounds(YamlReader& section, std::string_view key, Values::Kind kind) {
  const std::vector<double> bounds = section.numbers(key, 2, YamlReader::Range{});
  if (bounds[0] >= bounds[1]) section.fault(key, "the second number must be the larger");
  if (kind == Values::Kind::kLogUniform && bounds[0] <= 0.0)
    section.fault(key, "both numbers must be above zero");
  return {.kind = kind, .list = {}, .min = bounds[0], .max = bounds[1]};
}

/// What stands under `list_key`, or one of the distributions; nothing where there is none of them.
std::optional<Values> readValues(YamlReader& section, std::string_view list_key) {
  std::vector<std::string> given;
  for (const std::string_view key :
       {list_key, std::string_view("uniform"), std::string_view("log_uniform"), std::string_view("normal")}) {
    if (section.has(key)) given.emplace_back(key);
  }
  if (given.empty()) return std::nullopt;
  if (given.size() > 1) {
    section.fault(given[1], fmt::format("only one of {} says what the values are", fmt::join(given, ", ")));
    return std::nullopt;
  }
  if (given[0] == "uniform") return readBounds(section, "uniform", Values::Kind::kUniform);
  if (given[0] == "log_uniform") return readBounds(section, "log_uniform", Values::Kind::kLogUniform);
  if (given[0] == "normal") return readNormal(section.section("normal"));
  Values values{.kind = Values::Kind::kList, .list = section.texts(list_key)};
  if (values.list.empty()) section.fault(list_key, "needs one value or more");
  if (values.list.size() > kMostValues)
    section.fault(list_key, fmt::format("has more than {} values", kMostValues));
  std::set<std::string> seen;
  for (const std::string& value : values.list)
    if (!seen.insert(value).second)
      section.fault(list_key, fmt::format("{} is given twice", base::inQuotes(value)));
  return values;
}

/// A key with its sections, as it may be changed.
std::string readKey(YamlReader& section, std::string_view where) {
  std::string key = section.text(where);
  if (key.find('[') != std::string::npos) {
    section.fault(where,
                  fmt::format("{}: an element of a list cannot be changed by itself: set the whole list",
                              base::inQuotes(key)));
  } else if (!key.empty() && !isKeyPath(key)) {
    section.fault(where, fmt::format("{} is no key: section.key", base::inQuotes(key)));
  } else if (key == "extends" || key == "name" || key == "version") {
    section.fault(where, fmt::format("'{}' is not a factor's to change: the campaign sets it", key));
  }
  return key;
}

bool isTemplate(const std::string& text, std::string_view holder) {
  std::string filled = text;
  for (std::size_t at = 0; (at = filled.find(holder, at)) != std::string::npos;)
    filled.replace(at, holder.size(), "1");
  return base::isYamlValue(filled);
}

/// The file that a change is in: `key: …` of the scenario, or `machine: …`.
bool readTarget(YamlReader& section, Change& change) {
  const bool scenario = section.has("key"), machine = section.has("machine");
  if (scenario == machine) {
    section.fault(machine ? "machine" : "key",
                  "give either 'key', a key of the scenario, or 'machine', a key of the machine file");
    return false;
  }
  change.of_machine = machine;
  change.key = readKey(section, machine ? "machine" : "key");
  return true;
}

Change readChange(YamlReader& section, std::string_view holder, bool has_size) {
  Change change;
  if (!readTarget(section, change)) return change;
  const bool sets = section.has("set"), scales = section.has("scale_by"), shifts = section.has("shift_by");
  if (int{sets} + int{scales} + int{shifts} != 1) {
    section.fault("set", "give one of 'set', 'scale_by' and 'shift_by'");
    return change;
  }
  if (sets) {
    change.text = section.text("set");
    const bool uses_size = change.text.find(holder) != std::string::npos;
    if (uses_size && !has_size)
      section.fault("set", fmt::format("has {}, and this fault has no size", holder));
    if (!change.text.empty() && !isTemplate(change.text, holder))
      section.fault("set", fmt::format("{} is no value of YAML on one line", base::inQuotes(change.text)));
    return change;
  }
  change.how = scales ? Change::How::kScale : Change::How::kShift;
  change.by = section.number(scales ? "scale_by" : "shift_by", {});
  if (!has_size) section.fault(scales ? "scale_by" : "shift_by", "needs a size of the fault");
  return change;
}

std::vector<Change> readChanges(YamlReader& section, std::string_view holder, bool has_size) {
  std::vector<Change> changes;
  for (YamlReader& element : section.list("changes"))
    changes.push_back(readChange(element, holder, has_size));
  if (!section.has("changes")) return changes;
  if (changes.empty()) section.fault("changes", "needs one change or more");
  const bool uses = std::ranges::any_of(changes, [&](const Change& c) {
    return c.how != Change::How::kSet || c.text.find(holder) != std::string::npos;
  });
  if (has_size && !uses)
    section.fault("changes",
                  fmt::format("none of them depends on the {}", holder == kSizeHolder ? "size" : "value"));
  return changes;
}

void refuseWords(YamlReader& section, std::string_view key, const Kind& kind) {
  if (!kind.values || kind.values->isDrawn()) return;
  const bool needs_numbers =
      std::ranges::any_of(kind.changes, [](const Change& c) { return c.how != Change::How::kSet; });
  for (const std::string& value : kind.values->list) {
    if (!base::isYamlValue(value))
      section.fault(key, fmt::format("{} is no value of YAML on one line", base::inQuotes(value)));
    if (needs_numbers && !base::numberFrom<double>(value))
      section.fault(key, fmt::format("{} is no number", base::inQuotes(value)));
  }
}

Kind readFault(YamlReader& section) {
  Kind kind;
  kind.name = readName(section);
  if (section.has("size")) {
    if (section.isList("size")) {
      kind.values = readValues(section, "size");
    } else {
      YamlReader size = section.section("size");
      kind.values = readValues(size, "values");
      if (!kind.values) size.fault("values", "missing: or 'uniform', 'log_uniform', 'normal'");
    }
    if (kind.values)
      for (const std::string& size : kind.values->list)
        if (!base::numberFrom<double>(size))
          section.fault("size", fmt::format("{} is no number", base::inQuotes(size)));
  }
  kind.changes = readChanges(section, kSizeHolder, kind.values.has_value());
  if (kind.values && kind.changes.empty())
    section.fault("size", "nothing is changed by it: 'changes' is missing");
  return kind;
}

Factor readFaults(YamlReader& section, Factor factor) {
  factor.is_fault = true;
  std::set<std::string> seen;
  for (YamlReader& element : section.list("faults")) {
    factor.kinds.push_back(readFault(element));
    if (!seen.insert(factor.kinds.back().name).second)
      element.fault("name", "is the name of another fault too");
  }
  if (factor.kinds.empty()) section.fault("faults", "needs one fault or more");
  return factor;
}

Factor readFactor(YamlReader& section) {
  Factor factor;
  factor.name = readName(section);
  if (section.has("faults")) return readFaults(section, std::move(factor));
  Kind kind;
  kind.values = readValues(section, "values");
  if (!kind.values) section.fault("values", "missing: or 'uniform', 'log_uniform', 'normal', 'faults'");
  if (section.has("changes")) {
    kind.changes = readChanges(section, kValueHolder, true);
  } else {
    Change change{.text = kValueHolder};
    if (readTarget(section, change)) kind.changes.push_back(change);
  }
  refuseWords(section, "values", kind);
  factor.kinds.push_back(std::move(kind));
  return factor;
}

std::vector<FixedKey> readFixed(YamlReader& file, std::string_view section, bool of_machine) {
  std::vector<FixedKey> fixed;
  if (!file.has(section)) return fixed;
  for (const auto& [path, text] : file.leaves(section)) {
    fixed.push_back({of_machine, fmt::format("{}", fmt::join(path, ".")), text});
    if (!isKeyPath(fixed.back().key) || !base::isYamlValue(text))
      file.fault(section,
                 fmt::format("{} is no key with a value on one line", base::inQuotes(fixed.back().key)));
  }
  return fixed;
}

/// Two keys of which one holds the other, or the same twice.
bool clash(const std::string& a, const std::string& b) {
  return a == b || a.starts_with(b + ".") || b.starts_with(a + ".");
}

/// What sets a key: the file, the key, and who.
struct Setter {
  bool of_machine{};
  std::string key, who;
};

void refuseClashes(YamlReader& file, const Campaign& campaign) {
  std::vector<Setter> set;
  for (const FixedKey& f : campaign.fixed)
    set.push_back({f.of_machine, f.key, f.of_machine ? "set_machine" : "set"});
  const auto add = [&](const Setter& setter, std::size_t known, std::string_view at) {
    for (std::size_t i = 0; i < known; ++i)
      if (set[i].of_machine == setter.of_machine && clash(set[i].key, setter.key))
        file.fault(at, fmt::format("'{}' of {} is set by {} too", setter.key, setter.who, set[i].who));
    set.push_back(setter);
  };
  for (const Factor& factor : campaign.factors) {
    const std::size_t before = set.size();
    for (const Kind& kind : factor.kinds) {
      const std::size_t own = set.size();
      for (const Change& c : kind.changes) {
        add({c.of_machine, c.key, fmt::format("factor '{}'", factor.name)}, before, "factors");
        for (std::size_t i = own; i + 1 < set.size(); ++i)
          if (set[i].of_machine == c.of_machine && clash(set[i].key, c.key))
            file.fault("factors", fmt::format("'{}' is changed twice by one and the same of factor '{}'",
                                              c.key, factor.name));
      }
    }
  }
}

bool setsSeed(const Campaign& campaign) {
  const auto isSeed = [](const auto& c) { return !c.of_machine && c.key == "seed"; };
  return std::ranges::any_of(campaign.fixed, isSeed) ||
         std::ranges::any_of(campaign.factors, [&](const Factor& f) {
           return std::ranges::any_of(f.kinds,
                                      [&](const Kind& k) { return std::ranges::any_of(k.changes, isSeed); });
         });
}

void readBases(YamlReader& file, Campaign& campaign) {
  std::vector<std::string> names;
  if (file.isList("base")) {
    names = file.texts("base");
  } else {
    names = {file.text("base")};
  }
  std::set<std::string> stems;
  for (const std::string& name : names) {
    if (name.empty()) continue;
    const fs::path path = (file.folderOf("base") / name).lexically_normal();
    if (!fs::is_regular_file(path)) {
      file.fault("base", fmt::format("no such file '{}'", name));
      continue;
    }
    if (!stems.insert(path.stem().string()).second)
      file.fault(
          "base",
          fmt::format("'{}': another scenario has this file name, by which they are told apart", name));
    campaign.bases.push_back(path);
  }
  if (campaign.bases.empty() && file.has("base") && names.empty()) file.fault("base", "needs a scenario");
}

void readSize(YamlReader& file, Campaign& campaign) {
  const auto most = static_cast<double>(kMostRuns);
  if (file.has("draws") && file.has("repeats"))
    file.fault("repeats", "belongs to a grid, and 'draws' makes none: give one of the two");
  campaign.draws = static_cast<std::size_t>(
      std::clamp<std::int64_t>(file.integer("draws", {.min = 1, .max = most, .fallback = 0}), 0, kMostRuns));
  campaign.repeats = static_cast<std::size_t>(std::clamp<std::int64_t>(
      file.integer("repeats", {.min = 1, .max = most, .fallback = 1}), 1, kMostRuns));
}

Campaign readFrom(YamlReader& file, const fs::path& path) {
  Campaign campaign;
  campaign.path = fs::absolute(path).lexically_normal();
  campaign.inputs = file.inputs();
  (void)file.integer("version", {.min = 1, .max = 1});
  campaign.name = readName(file);
  if (campaign.name.find(' ') != std::string::npos) file.fault("name", "names folders: it has no blanks");
  campaign.title = file.text("title", "");
  readBases(file, campaign);
  campaign.fixed = readFixed(file, "set", false);
  for (FixedKey& key : readFixed(file, "set_machine", true)) campaign.fixed.push_back(std::move(key));
  campaign.seed = static_cast<std::uint64_t>(
      std::max<std::int64_t>(file.integer("seed", {.min = 0, .max = 9e15, .fallback = 1}), 0));
  readSize(file, campaign);
  std::set<std::string> names;
  for (YamlReader& section : file.list("factors")) {
    campaign.factors.push_back(readFactor(section));
    if (!names.insert(campaign.factors.back().name).second)
      section.fault("name", "is the name of another factor too");
  }
  refuseClashes(file, campaign);
  campaign.own_seeds = !setsSeed(campaign);
  if (campaign.runs() > kMostRuns)
    file.fault("factors", fmt::format("the grid has more than {} runs", kMostRuns));
  return campaign;
}

}  // namespace

std::size_t Campaign::runs() const { return draws > 0 ? draws : pointsOf(*this) * repeats; }

Campaign readCampaign(const fs::path& path) {
  YamlReader file = YamlReader::openFile(path);
  Campaign campaign = readFrom(file, path);
  file.finish();
  return campaign;
}

std::vector<YamlReader::Asked> campaignKeys(const fs::path& path) {
  YamlReader file = YamlReader::openFile(path);
  (void)readFrom(file, path);
  file.finish();
  return file.asked();
}

}  // namespace kerfbench::campaign
