// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/line_levels.h"

#include <fmt/format.h>

#include <algorithm>

namespace kerfbench::source {

std::vector<std::string> wrongAtStart(const std::vector<GpioWire>& wires, const std::vector<bool>& levels,
                                      const StartLevels& wanted) {
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (const std::string words = wrongAtStartWords(wires[i].signal, levels[i], wanted); !words.empty())
      problems.push_back(words);
  }
  return problems;
}

std::vector<std::string> levelsAgainstEdges(LineRequest& request, const EdgeOrder& order) {
  std::vector<std::string> problems;
  try {
    const std::vector<bool> now = request.levels();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i] == order.levels()[i]) continue;
      problems.push_back(
          fmt::format("{} is {} in the end, and its edges say {}: an odd number of them was lost",
                      request.lines()[i].name, now[i] ? "high" : "low", now[i] ? "low" : "high"));
    }
  } catch (const GpioError& e) {
    problems.emplace_back(e.what());
  }
  return problems;
}

std::vector<std::string> edgeTroubles(const EdgeOrder& order, std::uint64_t begin_ns) {
  std::vector<std::string> problems = order.problems();
  if (!problems.empty() && order.faults().first_ns > begin_ns) {
    problems.back() += fmt::format(" (the first trouble with edges is {:.6f} s after the start)",
                                   1e-9 * static_cast<double>(order.faults().first_ns - begin_ns));
  }
  return problems;
}

}  // namespace kerfbench::source
