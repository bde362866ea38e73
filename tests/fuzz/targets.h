// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace kerfbench::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Hands bytes to a reader in the way in which a user's reach it. True: it took them; false: it refused them
/// in words. Anything else is a finding: an exception that no command expects, a fault of memory, arithmetic
/// without a meaning, a hang.
using Reader = bool (*)(Bytes);

/// A reader and its target.
struct Target {
  std::string_view name;  ///< Name of the target, of the folder of its seeds and of that of its findings.
  Reader read{};
  std::string_view header;  ///< Declares what is called, from the root of the sources.
};

/// All targets; tests/fuzz/targets.cpp has the list.
std::span<const Target> targets();

/// A file of these bytes in a folder of this process, of memory where there is one; the last of this name is
/// written over.
std::filesystem::path asFile(std::string_view name, Bytes bytes);
std::filesystem::path asFile(std::string_view name, std::string_view text);

inline std::string_view textIn(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Parts of an input that stands for several files: what is between lines of "%%%%". Missing ones are empty.
std::string_view partOf(Bytes bytes, std::size_t number);

/// Calls a reader. Its own kinds of refusal are no findings.
template <typename... Refused, typename Do>
bool takes(const Do& action) {
  bool refused = false;
  const auto call = [&]<typename First, typename... Rest>(const auto& self) -> void {
    try {
      if constexpr (sizeof...(Rest) > 0) {
        self.template operator()<Rest...>(self);
      } else {
        action();
      }
    } catch (const First&) {
      refused = true;
    }
  };
  call.template operator()<Refused...>(call);
  return !refused;
}

bool drawingDxf(Bytes bytes);
bool drawingSvg(Bytes bytes);
bool drawingPdf(Bytes bytes);
bool drawingCf2(Bytes bytes);
bool scenarioFile(Bytes bytes);
bool machineFile(Bytes bytes);
bool recordingVcd(Bytes bytes);
bool recordingSr(Bytes bytes);
bool gcodeText(Bytes bytes);
bool correctionTable(Bytes bytes);
bool controllerTable(Bytes bytes);
bool imageHex(Bytes bytes);
bool imageElf(Bytes bytes);
bool imageTarget(Bytes bytes);
bool pinStreamReplies(Bytes bytes);
bool pinStreamRequests(Bytes bytes);
bool cameraCalibration(Bytes bytes);
bool calibrationTarget(Bytes bytes);
bool scannerCalibration(Bytes bytes);
bool markJob(Bytes bytes);
bool tileList(Bytes bytes);
bool picture(Bytes bytes);
bool cameraFrame(Bytes bytes);
bool frameRecording(Bytes bytes);
bool serialWords(Bytes bytes);
bool traceRecover(Bytes bytes);
bool httpHead(Bytes bytes);

}  // namespace kerfbench::fuzz
