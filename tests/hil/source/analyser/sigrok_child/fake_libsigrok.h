// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <libsigrok/libsigrok.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::sigrok_child {

/// What the stand-in for libsigrok says: its functions are linked instead of the library's.
struct FakeDevice {
  std::string vendor{"Maker"}, model{"Model"}, version{}, serial{}, conn{};
  std::vector<std::string> logic{"D0", "D1", "D2"};
  bool analog{};  ///< One channel more, before the others.
};
struct FakePacket {
  int type{SR_DF_LOGIC};
  std::vector<std::uint8_t> samples{};
  std::uint16_t sample_bytes{1};
  std::string says{};  ///< The driver, as an error, before the packet.
  int level{SR_LOG_ERR};
};
struct FakeLibsigrok {
  int init_error{SR_OK}, driver_error{SR_OK}, open_error{SR_OK}, enable_error{SR_OK};
  int session_error{SR_OK}, add_error{SR_OK}, start_error{SR_OK}, run_error{SR_OK};
  std::vector<FakeDevice> devices{FakeDevice{}};
  std::string scan_says;                    ///< An error of the driver's.
  std::map<std::uint32_t, int> set_errors;  ///< By key; else it is taken.
  std::uint64_t granted_hz{};               ///< 0: as asked for.
  bool tells_rate{true};
  std::vector<std::uint64_t> rates;  ///< Empty: a range with steps.
  bool lists_rates{true};
  bool continuous{true};
  bool has_limit{true};
  std::pair<std::uint64_t, std::uint64_t> limits{1, 4096};  ///< Second 0: does not tell.
  std::map<std::uint32_t, std::pair<bool, int>> settings;   ///< Key: in the group and not the device; what
                                                            ///< sr_dev_config_capabilities_list() says.
  std::vector<FakePacket> packets;

  // What was asked.
  std::string scanned_conn;
  std::map<std::uint32_t, std::string> set;  ///< Key: value as glib prints it, with " @group" for a group's.
  std::vector<std::string> enabled, disabled;
  int contexts{}, sessions{}, opened{};
  bool stopped{};
};
extern FakeLibsigrok fake;

}  // namespace kerfbench::sigrok_child
