// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hil/source/analyser/sigrok_child/fake_libsigrok.h"

#include <array>
#include <cstdarg>
#include <cstdlib>
#include <deque>
#include <memory>

using kerfbench::sigrok_child::fake;
using kerfbench::sigrok_child::FakePacket;

struct sr_dev_inst {
  std::size_t index;
};
struct sr_context {};
struct sr_session {
  sr_datafeed_callback callback;
  void* data;
};

namespace kerfbench::sigrok_child {
FakeLibsigrok fake;
}  // namespace kerfbench::sigrok_child

namespace {

sr_context the_context;
sr_session the_session;
std::array<sr_dev_inst, 4> the_devices{{{0}, {1}, {2}, {3}}};
sr_dev_driver the_driver{};
sr_dev_driver the_multimeter{};
std::array<sr_dev_driver*, 3> the_drivers{&the_multimeter, &the_driver, nullptr};
sr_log_callback log_callback;
void* log_data;

// Lists and names that libsigrok would own.
std::deque<std::string> names;
std::deque<sr_channel> channels;
std::vector<GSList*> lists;
sr_channel_group the_group{};

GSList* append(GSList* list, void* element) { return g_slist_append(list, element); }

const auto& deviceOf(const sr_dev_inst* device) { return fake.devices.at(device->index); }

sr_channel* newChannel(int index, int type, const std::string& name) {
  names.push_back(name);
  sr_channel channel{};
  channel.index = index;
  channel.type = type;
  channel.name = names.back().data();
  channels.push_back(channel);
  return &channels.back();
}

void say(int level, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  if (log_callback != nullptr) log_callback(log_data, level, format, arguments);
  va_end(arguments);
}

}  // namespace

extern "C" {

int sr_init(sr_context** ctx) {
  the_driver.name = "fakela";
  the_multimeter.name = "fakemeter";
  if (fake.init_error == SR_OK) ++fake.contexts;
  *ctx = &the_context;
  return fake.init_error;
}
int sr_exit(sr_context*) {
  --fake.contexts;
  return SR_OK;
}
int sr_log_loglevel_set(int) { return SR_OK; }
int sr_log_callback_set(sr_log_callback cb, void* data) {
  log_callback = cb;
  log_data = data;
  return SR_OK;
}
int sr_log_callback_set_default() {
  log_callback = nullptr;
  return SR_OK;
}
const char* sr_strerror(int code) { return code == SR_ERR_NA ? "not applicable" : "generic error"; }
const char* sr_package_version_string_get() { return "0.5.2-fake"; }
sr_dev_driver** sr_driver_list(const sr_context*) { return the_drivers.data(); }
int sr_driver_init(sr_context*, sr_dev_driver*) { return fake.driver_error; }
GArray* sr_dev_options(const sr_dev_driver* driver, const sr_dev_inst*, const sr_channel_group*) {
  if (driver == &the_multimeter) return nullptr;
  GArray* const options = g_array_new(FALSE, FALSE, sizeof(std::uint32_t));
  for (const std::uint32_t key : {std::uint32_t{SR_CONF_DEMO_DEV}, std::uint32_t{SR_CONF_LOGIC_ANALYZER}})
    g_array_append_val(options, key);
  return options;
}
GSList* sr_driver_scan(sr_dev_driver*, GSList* options) {
  if (options != nullptr)
    fake.scanned_conn = g_variant_get_string(static_cast<sr_config*>(options->data)->data, nullptr);
  if (!fake.scan_says.empty()) say(SR_LOG_ERR, "%s\n", fake.scan_says.c_str());
  GSList* list = nullptr;
  for (std::size_t i = 0; i < fake.devices.size(); ++i) list = append(list, &the_devices.at(i));
  return list;
}
int sr_dev_open(sr_dev_inst*) {
  if (fake.open_error == SR_OK) ++fake.opened;
  return fake.open_error;
}
int sr_dev_close(sr_dev_inst*) {
  --fake.opened;
  return SR_OK;
}
sr_dev_driver* sr_dev_inst_driver_get(const sr_dev_inst*) { return &the_driver; }
const char* sr_dev_inst_vendor_get(const sr_dev_inst* device) { return deviceOf(device).vendor.c_str(); }
const char* sr_dev_inst_model_get(const sr_dev_inst* device) { return deviceOf(device).model.c_str(); }
const char* sr_dev_inst_version_get(const sr_dev_inst* device) {
  return deviceOf(device).version.empty() ? nullptr : deviceOf(device).version.c_str();
}
const char* sr_dev_inst_sernum_get(const sr_dev_inst* device) { return deviceOf(device).serial.c_str(); }
const char* sr_dev_inst_connid_get(const sr_dev_inst* device) { return deviceOf(device).conn.c_str(); }
GSList* sr_dev_inst_channels_get(const sr_dev_inst* device) {
  GSList* list = nullptr;
  int index = 0;
  if (deviceOf(device).analog) list = append(list, newChannel(index++, SR_CHANNEL_ANALOG, "A0"));
  for (const std::string& name : deviceOf(device).logic)
    list = append(list, newChannel(index++, SR_CHANNEL_LOGIC, name));
  // The objects are the same at each query.
  static std::map<std::size_t, std::pair<std::vector<std::string>, GSList*>> known;
  auto& [logic, old] = known[device->index];
  if (old != nullptr && logic == deviceOf(device).logic && !deviceOf(device).analog) return old;
  logic = deviceOf(device).logic;
  old = list;
  lists.push_back(list);
  return list;
}
GSList* sr_dev_inst_channel_groups_get(const sr_dev_inst*) {
  static GSList* const list = append(nullptr, &the_group);
  return list;
}
int sr_dev_channel_enable(sr_channel* channel, gboolean on) {
  (on == TRUE ? fake.enabled : fake.disabled).emplace_back(channel->name);
  return fake.enable_error;
}
gboolean sr_dev_has_option(const sr_dev_inst*, int key) {
  return (key == SR_CONF_CONTINUOUS && fake.continuous) || (key == SR_CONF_LIMIT_SAMPLES && fake.has_limit)
             ? TRUE
             : FALSE;
}
int sr_dev_config_capabilities_list(const sr_dev_inst*, const sr_channel_group* cg, int key) {
  const auto found = fake.settings.find(static_cast<std::uint32_t>(key));
  if (found == fake.settings.end()) return 0;
  return found->second.first == (cg != nullptr) ? found->second.second : SR_ERR_CHANNEL_GROUP;
}
int sr_config_set(const sr_dev_inst*, const sr_channel_group* cg, std::uint32_t key, GVariant* data) {
  g_variant_ref_sink(data);
  char* const text = g_variant_print(data, FALSE);
  fake.set[key] = std::string(text) + (cg != nullptr ? " @group" : "");
  g_free(text);
  g_variant_unref(data);
  return fake.set_errors.contains(key) ? fake.set_errors.at(key) : SR_OK;
}
int sr_config_get(const sr_dev_driver*, const sr_dev_inst*, const sr_channel_group*, std::uint32_t,
                  GVariant** data) {
  if (!fake.tells_rate) return SR_ERR_NA;
  const std::uint64_t asked = std::strtoull(fake.set[SR_CONF_SAMPLERATE].c_str(), nullptr, 10);
  *data = g_variant_ref_sink(g_variant_new_uint64(fake.granted_hz != 0 ? fake.granted_hz : asked));
  return SR_OK;
}
int sr_config_list(const sr_dev_driver*, const sr_dev_inst*, const sr_channel_group*, std::uint32_t key,
                   GVariant** data) {
  if (key == SR_CONF_LIMIT_SAMPLES) {
    if (fake.limits.second == 0) return SR_ERR_NA;
    *data = g_variant_ref_sink(g_variant_new("(tt)", fake.limits.first, fake.limits.second));
    return SR_OK;
  }
  if (!fake.lists_rates) return SR_ERR_NA;
  const std::array<std::uint64_t, 3> steps{10, 1000, 10};
  GVariantBuilder builder;
  g_variant_builder_init(&builder, G_VARIANT_TYPE("a{sv}"));
  GVariant* const values =
      fake.rates.empty()
          ? g_variant_new_fixed_array(G_VARIANT_TYPE("t"), steps.data(), 3, 8)
          : g_variant_new_fixed_array(G_VARIANT_TYPE("t"), fake.rates.data(), fake.rates.size(), 8);
  g_variant_builder_add(&builder, "{sv}", fake.rates.empty() ? "samplerate-steps" : "samplerates", values);
  *data = g_variant_ref_sink(g_variant_builder_end(&builder));
  return SR_OK;
}
const sr_key_info* sr_key_info_name_get(int, const char* name) {
  static const std::array<sr_key_info, 6> infos{{
      {SR_CONF_PATTERN_MODE, SR_T_STRING, "pattern", nullptr, nullptr},
      {SR_CONF_CAPTURE_RATIO, SR_T_UINT64, "captureratio", nullptr, nullptr},
      {SR_CONF_RLE, SR_T_BOOL, "rle", nullptr, nullptr},
      {SR_CONF_OUTPUT_FREQUENCY, SR_T_FLOAT, "output_frequency", nullptr, nullptr},
      {SR_CONF_VOLTAGE_THRESHOLD, SR_T_DOUBLE_RANGE, "voltage_threshold", nullptr, nullptr},
      {SR_CONF_MEASURED_QUANTITY, SR_T_MQ, "measured_quantity", nullptr, nullptr},
  }};
  for (const sr_key_info& info : infos) {
    if (std::string(info.id) == name) return &info;
  }
  return nullptr;
}
int sr_parse_sizestring(const char* text, std::uint64_t* size) {
  char* end = nullptr;
  *size = std::strtoull(text, &end, 10);
  return *end == '\0' && end != text ? SR_OK : SR_ERR;
}
int sr_session_new(sr_context*, sr_session** session) {
  if (fake.session_error == SR_OK) ++fake.sessions;
  *session = &the_session;
  return fake.session_error;
}
int sr_session_destroy(sr_session*) {
  --fake.sessions;
  return SR_OK;
}
int sr_session_dev_add(sr_session*, sr_dev_inst*) { return fake.add_error; }
int sr_session_datafeed_callback_add(sr_session* session, sr_datafeed_callback callback, void* data) {
  *session = {callback, data};
  return SR_OK;
}
int sr_session_start(sr_session*) { return fake.start_error; }
int sr_session_stop(sr_session*) {
  fake.stopped = true;
  return SR_OK;
}
// A device may still send pending samples when it is stopped.
int sr_session_run(sr_session* session) {
  for (FakePacket& packet : fake.packets) {
    if (!packet.says.empty()) say(packet.level, "%s", packet.says.c_str());
    sr_datafeed_logic logic{packet.samples.size(), packet.sample_bytes, packet.samples.data()};
    const sr_datafeed_packet sent{static_cast<std::uint16_t>(packet.type), &logic};
    session->callback(nullptr, &sent, session->data);
  }
  return fake.run_error;
}

}  // extern "C"
