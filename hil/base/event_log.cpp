// SPDX-License-Identifier: Apache-2.0
#include "hil/base/event_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

namespace kerfbench::base {
namespace {

// In the order in which the fields are told.
using Json = nlohmann::ordered_json;

[[noreturn]] void throwFor(const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), "cannot write " + path.string());
}

}  // namespace

EventLog::EventLog(const std::filesystem::path& path)
    : path_(path), fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (!fd_.valid()) throwFor(path);
}

void EventLog::tell(std::string_view event, std::initializer_list<EventField> fields) {
  Json json{{"event", event}};
  for (const EventField& field : fields)
    std::visit([&](const auto& value) { json[std::string(field.first)] = value; }, field.second);
  const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t wrote = ::write(fd_.get(), line.data() + done, line.size() - done);
    if (wrote < 0 && errno != EINTR) throwFor(path_);
    if (wrote > 0) done += static_cast<std::size_t>(wrote);
  }
}

}  // namespace kerfbench::base
