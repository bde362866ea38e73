// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <libsigrok/libsigrok.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::sigrok_child {

/// Answers of the stand-in for libsigrok: its functions are linked instead of the library's.
struct FakeDevice {
  std::string vendor{"Maker"}, model{"Model"}, version{}, serial{}, conn{};
  std::vector<std::string> logic{"D0", "D1", "D2"};
  bool analog{};  ///< True for one channel more, before the others.
};
struct FakePacket {
  int type{SR_DF_LOGIC};
  std::vector<std::uint8_t> samples{};
  std::uint16_t sample_bytes{1};
  std::string says{};  ///< Error that the driver reports before the packet.
  int level{SR_LOG_ERR};
};
struct FakeLibsigrok {
  int init_error{SR_OK}, driver_error{SR_OK}, open_error{SR_OK}, enable_error{SR_OK};
  int session_error{SR_OK}, add_error{SR_OK}, start_error{SR_OK}, run_error{SR_OK};
  std::vector<FakeDevice> devices{FakeDevice{}};
  std::string scan_says;                    ///< Error that the driver reports in a scan.
  std::map<std::uint32_t, int> set_errors;  ///< Error for each key; other keys are accepted.
  std::uint64_t granted_hz{};               ///< Rate that is set; 0: as requested.
  bool tells_rate{true};
  std::vector<std::uint64_t> rates;  ///< Rates; empty: a range with steps.
  bool lists_rates{true};
  bool continuous{true};
  bool has_limit{true};
  /// Limits of the samples; second 0: not reported.
  std::pair<std::uint64_t, std::uint64_t> limits{1, 4096};
  /// Whether each key is in the group and not in the device, and its result of
  /// sr_dev_config_capabilities_list().
  std::map<std::uint32_t, std::pair<bool, int>> settings;
  std::vector<FakePacket> packets;

  // Record of the calls.
  std::string scanned_conn;
  /// Value of each key as glib prints it, with " @group" for a group's.
  std::map<std::uint32_t, std::string> set;
  std::vector<std::string> enabled, disabled;
  int contexts{}, sessions{}, opened{};
  bool stopped{};
};
extern FakeLibsigrok fake;

}  // namespace kerfbench::sigrok_child
