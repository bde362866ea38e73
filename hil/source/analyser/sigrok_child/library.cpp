// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/analyser/sigrok_child/library.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

#include "hil/source/analyser/sigrok_child/sigrok.h"

namespace kerfbench::sigrok_child {
namespace {

constexpr std::size_t kMostMessages = 10;

void keep(std::vector<std::string>& messages, std::string text) {
  std::ranges::replace(text, '\n', ' ');
  if (messages.size() < kMostMessages && std::ranges::find(messages, text) == messages.end())
    messages.push_back(std::move(text));
}

bool isLogicAnalyser(const sr_dev_driver* driver) {
  const Handle<GArray> options(sr_dev_options(driver, nullptr, nullptr));
  if (!options) return false;
  for (guint i = 0; i < options->len; ++i) {
    if (g_array_index(options.get(), std::uint32_t, i) == SR_CONF_LOGIC_ANALYZER) return true;
  }
  return false;
}

std::string hertz(std::uint64_t rate) { return std::to_string(rate) + " Hz"; }

}  // namespace

DriverLog::DriverLog() {
  sr_log_loglevel_set(SR_LOG_WARN);
  sr_log_callback_set(&DriverLog::receive, this);
}
DriverLog::~DriverLog() { sr_log_callback_set_default(); }

int DriverLog::receive(void* self, int level, const char* format, va_list arguments) {
  std::array<char, 400> text{};
  (void)std::vsnprintf(text.data(), text.size(), format, arguments);
  auto* const log = static_cast<DriverLog*>(self);
  if (level == SR_LOG_ERR) keep(log->errors_, text.data());
  if (level == SR_LOG_WARN) keep(log->warnings_, text.data());
  return SR_OK;
}

Library::Library() {
  sr_context* context = nullptr;
  if (const int code = sr_init(&context); code != SR_OK)
    throw SigrokError("libsigrok does not start: " + why(code));
  context_.reset(context);
}

std::string Library::why(int code) {
  std::string words = sr_strerror(code);
  for (const std::string& error : log_.takeErrors()) words += "; " + error;
  return words;
}

std::vector<sr_dev_driver*> Library::drivers() const {
  std::vector<sr_dev_driver*> found;
  sr_dev_driver** const all = sr_driver_list(context_.get());
  for (std::size_t i = 0; all != nullptr && all[i] != nullptr; ++i) {
    if (isLogicAnalyser(all[i])) found.push_back(all[i]);
  }
  std::ranges::sort(found, {}, [](const sr_dev_driver* driver) { return std::string(driver->name); });
  return found;
}

sr_dev_driver* Library::driver(const std::string& name) const {
  const auto all = drivers();
  const auto found =
      std::ranges::find_if(all, [&](const sr_dev_driver* driver) { return name == driver->name; });
  if (found != all.end()) return *found;
  std::string words = "libsigrok has no driver '" + name + "' for logic analysers; it has";
  for (const sr_dev_driver* driver : all) words += std::string(" ") + driver->name;
  throw SigrokError(words);
}

std::vector<sr_dev_inst*> Library::scan(sr_dev_driver* driver, const std::string& conn) {
  if (const int code = sr_driver_init(context_.get(), driver); code != SR_OK)
    throw SigrokError(std::string("the driver ") + driver->name + " does not start: " + why(code));
  Handle<GVariant> text;
  sr_config option{SR_CONF_CONN, nullptr};
  Handle<GSList> options;
  if (!conn.empty()) {
    text.reset(g_variant_ref_sink(g_variant_new_string(conn.c_str())));
    option.data = text.get();
    options.reset(g_slist_append(nullptr, &option));
  }
  const Handle<GSList> found(sr_driver_scan(driver, options.get()));
  return elementsOf<sr_dev_inst>(found.get());
}

std::string nameOf(sr_dev_inst* device) {
  std::string name;
  for (const char* part :
       {sr_dev_inst_vendor_get(device), sr_dev_inst_model_get(device), sr_dev_inst_version_get(device)}) {
    if (!textOf(part).empty()) name += (name.empty() ? "" : " ") + textOf(part);
  }
  return name;
}

std::string describe(sr_dev_inst* device) {
  const sr_dev_driver* const driver = sr_dev_inst_driver_get(device);
  std::string words = driver == nullptr ? "analyser" : driver->name;
  if (const std::string name = nameOf(device); !name.empty()) words += " " + name;
  if (const std::string serial = textOf(sr_dev_inst_sernum_get(device)); !serial.empty())
    words += ", serial " + serial;
  if (const std::string conn = textOf(sr_dev_inst_connid_get(device)); !conn.empty()) words += ", at " + conn;
  return words;
}

std::vector<sr_channel*> logicChannels(sr_dev_inst* device) {
  auto channels = elementsOf<sr_channel>(sr_dev_inst_channels_get(device));
  std::erase_if(channels, [](const sr_channel* channel) { return channel->type != SR_CHANNEL_LOGIC; });
  return channels;
}

std::string ratesOf(sr_dev_inst* device) {
  GVariant* raw = nullptr;
  if (sr_config_list(sr_dev_inst_driver_get(device), device, nullptr, SR_CONF_SAMPLERATE, &raw) != SR_OK)
    return "";
  const Handle<GVariant> dictionary(raw);
  const Handle<GVariant> steps(
      g_variant_lookup_value(dictionary.get(), "samplerate-steps", G_VARIANT_TYPE("at")));
  const Handle<GVariant> rates(g_variant_lookup_value(dictionary.get(), "samplerates", G_VARIANT_TYPE("at")));
  gsize count = 0;
  const auto* const values = static_cast<const std::uint64_t*>(
      steps   ? g_variant_get_fixed_array(steps.get(), &count, sizeof(std::uint64_t))
      : rates ? g_variant_get_fixed_array(rates.get(), &count, sizeof(std::uint64_t))
              : nullptr);
  if (steps && count == 3)
    return hertz(values[0]) + " … " + hertz(values[1]) + " in steps of " + hertz(values[2]);
  std::string words;
  for (gsize i = 0; i < count; ++i) words += (words.empty() ? "" : ", ") + hertz(values[i]);
  return words;
}

}  // namespace kerfbench::sigrok_child
