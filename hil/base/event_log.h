// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "hil/base/unique_fd.h"

namespace kerfbench::base {

/// Value of a field of an event. A number that is not finite becomes null.
using EventValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                                std::vector<std::string>>;
using EventField = std::pair<std::string_view, EventValue>;

/// What happens in a run, for programs that watch it: a line of JSON for each event, {"event": NAME, …},
/// appended to a file as a whole, so that whoever reads to the end of a line reads all of an event. Bytes
/// that are no UTF-8 become U+FFFD. No result depends on it. May be told by several threads.
/// docs/reference/events.md lists the events.
class EventLog {
 public:
  /// Appends to what is there. @throws std::system_error with the path.
  explicit EventLog(const std::filesystem::path& path);

  /// @throws std::system_error where the disk is full.
  void tell(std::string_view event, std::initializer_list<EventField> fields);

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  UniqueFd fd_;
};

}  // namespace kerfbench::base
