// SPDX-License-Identifier: Apache-2.0
// Prints what the reader makes of drawings, for comparison with other readers: for each file a line of JSON
// with the length per process and the box, mm.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace {

using namespace kerfbench;

std::string measured(const dieline::Dieline& drawing) {
  std::map<std::string, double> lengths_mm;
  for (const dieline::Entity& entity : drawing.entities)
    lengths_mm[std::string(dieline::processName(entity.process))] += dieline::lengthOf(entity.curve);
  std::string text = "{\"lengths_mm\": {";
  for (const auto& [process, length_mm] : lengths_mm)
    text += fmt::format("{}\"{}\": {:.9f}", text.back() == '{' ? "" : ", ", process, length_mm);
  const auto box = drawing.bounds();
  text += "}, \"box_mm\": [";
  if (!box.isEmpty())
    text += fmt::format("{:.9f}, {:.9f}, {:.9f}, {:.9f}", box.min().x(), box.min().y(), box.max().x(),
                        box.max().y());
  return text + "]}";
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kMemoryIsWatched = true;
#elif defined(__has_feature)
constexpr bool kMemoryIsWatched = __has_feature(address_sanitizer);
#else
constexpr bool kMemoryIsWatched = false;
#endif

/// The most memory since the program began; what a parent measures counts the parent's own before that.
long peak_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  }
  return -1;
}

/// Arguments are files; `--peak FILE` reads one and ends with its peak of memory in KiB; `--is-watched` exits
/// with 0 if a sanitizer's own memory counts, else with 1; `--unit UNIT` and `--layer RULE` say what a
/// unit and a layer are in those behind them.
int main(int argc, char** argv) {
  dieline::DrawingArguments told;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--is-watched") return kMemoryIsWatched ? 0 : 1;
    if (argument == "--peak") {
      std::atexit([] { std::printf("peak %ld\n", peak_kib()); });
      continue;
    }
    if (argument == "--unit" && i + 1 < argc) {
      told.unit = argv[++i];
      continue;
    }
    if (argument == "--layer" && i + 1 < argc) {
      told.layers.emplace_back(argv[++i]);
      continue;
    }
    try {
      std::puts(measured(dieline::readDieline(argument, dieline::drawingOptionsFrom(told))).c_str());
    } catch (const dieline::DielineError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
  }
  return 0;
}
