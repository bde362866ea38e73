// SPDX-License-Identifier: Apache-2.0
#include "hil/source/controllers.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "hil/base/number_from.h"
#include "hil/source/open.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kMostNames = 3;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

Controller controllerFrom(const std::string& line) {
  std::vector<std::string> fields = split(line, '\t');
  fields.resize(8);
  if (fields[7].empty()) fields[7] = "8";
  const auto number = [&](std::size_t i) {
    const auto read = base::numberFrom<std::size_t>(fields[i]);
    if (!read) throw std::runtime_error("an emulator describes a controller in words that make no sense");
    return *read;
  };
  return {split(fields[0], ' '),           number(1), number(2), number(3), fields[4], fields[5], fields[6],
          static_cast<unsigned>(number(7))};
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Name of a port in a controller with ports of these names: letters or digits. '?' where there can be none.
char portName(std::string_view ports, std::uint16_t port) {
  const bool numbered = !ports.empty() && isDigit(ports.front());
  if (port >= (numbered ? 10 : 26)) return '?';
  return static_cast<char>((numbered ? '0' : 'A') + port);
}

std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t before = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = before + (a[i] == b[j] ? 0U : 1U);
      before = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string Controller::nameOf(PinId pin) const {
  const char port = portName(ports, pin.port);
  return std::string("P") + port + (isDigit(port) ? "." : "") + std::to_string(pin.bit);
}

bool Controller::isCalled(std::string_view name) const {
  return std::ranges::find(names, name) != names.end();
}

bool Controller::hasPin(PinId pin) const {
  return pin.bit < port_bits && ports.find(portName(ports, pin.port)) != std::string::npos;
}

std::vector<Controller> emulatedControllers(const std::filesystem::path& child, const std::string& mcu) {
  std::vector<Controller> all;
  for (const std::string& line : split(describeChild(child, mcu), '\n')) all.push_back(controllerFrom(line));
  return all;
}

std::vector<std::string> namesLike(std::string_view name, const std::vector<Controller>& controllers) {
  std::vector<std::pair<std::size_t, std::string>> all;
  for (const Controller& controller : controllers) {
    for (const std::string& other : controller.names) all.emplace_back(distance(name, other), other);
  }
  std::ranges::sort(all);
  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < std::min(all.size(), kMostNames); ++i) nearest.push_back(all[i].second);
  return nearest;
}

}  // namespace kerfbench::source
