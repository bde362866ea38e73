// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/sr_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "hil/base/number_from.h"

namespace kerfbench::source {
namespace {

/// No analyser is so fast; with more, times of samples would overflow.
constexpr std::uint64_t kMostRate_hz = 1'000'000'000'000;

/// "24 MHz", "14.7456 MHz", "500000" Hz, exactly.
std::optional<std::uint64_t> rateOf(std::string_view text) {
  const auto digits_end = std::min(text.find_first_not_of("0123456789."), text.size());
  std::string_view unit = text.substr(digits_end);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  static const std::map<std::string_view, std::size_t> kZeros{{"", 0},    {"Hz", 0},  {"kHz", 3}, {"KHz", 3},
                                                              {"MHz", 6}, {"GHz", 9}, {"k", 3},   {"m", 6}};
  const auto zeros = kZeros.find(unit);
  if (zeros == kZeros.end()) return std::nullopt;
  const std::string_view number = text.substr(0, digits_end);
  const auto point = std::min(number.find('.'), number.size());
  std::string fraction(number.substr(std::min(point + 1, number.size())));
  while (fraction.ends_with('0')) fraction.pop_back();
  if (fraction.size() > zeros->second) return std::nullopt;
  fraction.resize(zeros->second, '0');
  const auto rate_hz = base::numberFrom<std::uint64_t>(std::string(number.substr(0, point)) + fraction);
  return rate_hz && *rate_hz <= kMostRate_hz ? rate_hz : std::nullopt;
}

using Keys = std::map<std::string, std::string>;

/// Keys of the first device; other sections but [global] are devices too many.
Keys deviceKeys(const std::string& text, std::vector<std::string>& faults) {
  Keys keys;
  std::string section;
  std::size_t devices = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    const auto equals = line.find('=');
    if (line.starts_with('[')) {
      section = line;
      if (line.starts_with("[device")) ++devices;
    } else if (equals != std::string::npos && section.starts_with("[device") && devices == 1) {
      keys[line.substr(0, equals)] = line.substr(equals + 1);
    }
  }
  if (devices == 0) faults.emplace_back("metadata: no [device 1]");
  if (devices > 1) faults.push_back(fmt::format("metadata: {} devices, and one is expected", devices));
  return keys;
}

void readChannels(const Keys& keys, SrMetadata& metadata, std::vector<std::string>& faults) {
  constexpr std::string_view kProbe = "probe";
  for (const auto& [key, name] : keys) {
    if (!key.starts_with(kProbe)) continue;
    const auto number = base::numberFrom<std::uint64_t>(std::string_view(key).substr(kProbe.size()));
    if (!number || *number == 0 || *number > 8 * metadata.sample_bytes) {
      faults.push_back(fmt::format("metadata: {}={}: no channel of samples of {} bytes", key, name,
                                   metadata.sample_bytes));
    } else {
      metadata.channels.emplace_back(static_cast<unsigned>(*number - 1), name);
    }
  }
  std::ranges::sort(metadata.channels);
}

}  // namespace

SrMetadata readSrMetadata(const std::string& text, std::vector<std::string>& faults) {
  SrMetadata metadata;
  const Keys keys = deviceKeys(text, faults);
  if (keys.empty()) return metadata;
  const auto value = [&](const std::string& key) {
    const auto found = keys.find(key);
    if (found == keys.end() || found->second.empty()) faults.push_back("metadata: no " + key);
    return found == keys.end() ? std::string() : found->second;
  };
  metadata.samples_name = value("capturefile");
  if (const std::string rate = value("samplerate"); !rate.empty()) {
    metadata.samplerate_hz = rateOf(rate).value_or(0);
    if (metadata.samplerate_hz == 0)
      faults.push_back(
          fmt::format("metadata: samplerate={}: no rate in Hz, kHz, MHz or GHz, up to 1000 GHz", rate));
  }
  if (const std::string size = value("unitsize"); !size.empty()) {
    const std::uint64_t bytes = base::numberFrom<std::uint64_t>(size).value_or(0);
    if (bytes < 1 || bytes > 8)
      faults.push_back(fmt::format("metadata: unitsize={}: samples of 1 to 8 bytes can be read", size));
    metadata.sample_bytes = bytes < 1 || bytes > 8 ? 0 : static_cast<std::size_t>(bytes);
  }
  if (metadata.sample_bytes > 0) readChannels(keys, metadata, faults);
  return metadata;
}

std::string srMetadataText(const SrMetadata& metadata) {
  std::string text = fmt::format(
      "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile={}\ntotal probes={}\nsamplerate={} "
      "Hz\ntotal "
      "analog=0\n",
      metadata.samples_name, metadata.channels.size(), metadata.samplerate_hz);
  for (const auto& [bit, name] : metadata.channels) text += fmt::format("probe{}={}\n", bit + 1, name);
  return text + fmt::format("unitsize={}\n", metadata.sample_bytes);
}

}  // namespace kerfbench::source
