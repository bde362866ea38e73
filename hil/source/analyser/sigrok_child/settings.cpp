// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/analyser/sigrok_child/settings.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "hil/source/analyser/sigrok_child/sigrok.h"

namespace kerfbench::sigrok_child {
namespace {

std::optional<double> doubleOf(std::string_view text) {
  double value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Floating, as sr_config_set() wants it; nullptr: the text is no such value.
GVariant* valueOf(int datatype, const std::string& text) {
  std::uint64_t size{};
  switch (datatype) {
    case SR_T_STRING:
      return g_variant_new_string(text.c_str());
    case SR_T_UINT64:
      return sr_parse_sizestring(text.c_str(), &size) == SR_OK ? g_variant_new_uint64(size) : nullptr;
    case SR_T_BOOL:
      return text == "on" || text == "off" ? g_variant_new_boolean(text == "on" ? TRUE : FALSE) : nullptr;
    case SR_T_FLOAT:
      if (const auto value = doubleOf(text)) return g_variant_new_double(*value);
      return nullptr;
    case SR_T_DOUBLE_RANGE: {
      const auto dash = text.find('-', 1);  // The first may be negative.
      if (dash == std::string::npos) return nullptr;
      const auto low = doubleOf(std::string_view(text).substr(0, dash));
      const auto high = doubleOf(std::string_view(text).substr(dash + 1));
      return low && high ? g_variant_new("(dd)", *low, *high) : nullptr;
    }
    default:
      return nullptr;
  }
}

}  // namespace

void applySettings(Library& library, sr_dev_inst* device,
                   const std::vector<std::pair<std::string, std::string>>& settings) {
  for (const auto& [key, text] : settings) {
    const std::string what = fmt::format("{}: setting {}: {}", describe(device), key, text);
    const sr_key_info* const info = sr_key_info_name_get(SR_KEY_CONFIG, key.c_str());
    if (info == nullptr) throw SigrokError(what + ": libsigrok knows no setting of this name");
    std::vector<const sr_channel_group*> places{nullptr};
    for (const sr_channel_group* group : elementsOf<sr_channel_group>(sr_dev_inst_channel_groups_get(device)))
      places.push_back(group);
    const sr_channel_group* const* place = nullptr;
    for (const auto& candidate : places) {
      // The uppermost three bits, or a negative number, whose lower bits are not all zero.
      const auto can = static_cast<std::uint32_t>(
          sr_dev_config_capabilities_list(device, candidate, static_cast<int>(info->key)));
      constexpr std::uint32_t kFlags = SR_CONF_GET | SR_CONF_SET | SR_CONF_LIST;
      if (place == nullptr && (can & ~kFlags) == 0 && (can & SR_CONF_SET) != 0) place = &candidate;
    }
    if (place == nullptr) throw SigrokError(what + ": this analyser has no such setting");
    GVariant* const value = valueOf(info->datatype, text);
    if (value == nullptr) throw SigrokError(what + ": no value for it");
    if (const int code = sr_config_set(device, *place, info->key, value); code != SR_OK)
      throw SigrokError(what + ": not taken: " + library.why(code));
  }
}

}  // namespace kerfbench::sigrok_child
