// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hil/source/analyser/analyser_stream.h"
#include "hil/source/analyser/level_runs.h"

namespace kerfbench::source {

/// An analyser that cannot be used as it was asked for; what() says in words why, and what there is.
class AnalyserError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A device that was found.
struct AnalyserDevice {
  std::string driver;                 ///< libsigrok's name: "fx2lafw".
  std::string name;                   ///< Maker, model and version, as far as they are known.
  std::string serial;                 ///< May be empty.
  std::string conn;                   ///< "1.14" (USB bus and address), "/dev/ttyUSB0"; may be empty.
  std::vector<std::string> channels;  ///< Names of its logic channels.
  std::string samplerates;            ///< Rates for people: "1 Hz … 1000000000 Hz".
};

struct AnalyserList {
  std::string library;  ///< "libsigrok 0.5.2".
  std::vector<std::string> drivers;
  std::vector<AnalyserDevice> devices;
  std::vector<std::string> faults;  ///< Devices that were found and cannot be opened, in words.
};

/// Request for a capture.
struct AnalyserRequest {
  std::string driver;
  std::string conn;    ///< Empty: the only device there is.
  std::string serial;  ///< Empty: any.
  std::uint64_t samplerate_hz{};
  std::vector<std::string> channels;  ///< Names; at most kMostChannels.
  /// Settings of the driver, by sigrok's names: {"voltage_threshold", "1.2-1.2"}.
  std::vector<std::pair<std::string, std::string>> settings;
  ListenFor listen;
};

/// End of a capture.
struct AnalyserEnd {
  using Reason = analyser_stream::AnalyserReason;
  Reason reason{Reason::kBroken};
  std::vector<std::string> problems;  ///< Errors that the driver reported while it sampled.
  std::vector<std::string> notes;
};

/// An analyser that samples. read() until it says false, then end().
class AnalyserFeed {
 public:
  virtual ~AnalyserFeed() = default;
  /// The device, for people.
  [[nodiscard]] virtual std::string device() const = 0;
  /// Appends the next runs; false: there are no more. Never throws: whatever goes wrong is in end().
  virtual bool read(std::vector<LevelRun>& runs) = 0;
  [[nodiscard]] virtual AnalyserEnd end() const = 0;
};

/// The analysers of a computer; tests script them.
class AnalyserSystem {
 public:
  virtual ~AnalyserSystem() = default;
  /// @throws AnalyserError if they cannot be listed.
  virtual AnalyserList list() = 0;
  /// Starts sampling. @throws AnalyserError: no such driver or device, more than one, a channel, rate or
  /// setting that it does not have.
  virtual std::unique_ptr<AnalyserFeed> acquire(const AnalyserRequest& request) = 0;
};

/// Analysers by libsigrok, in a process of its own (kerfbench-sigrok in `bin_dir`): the library is under the
/// GPL, and a driver that crashes leaves the bench whole.
std::shared_ptr<AnalyserSystem> sigrokAnalysers(const std::filesystem::path& bin_dir);

}  // namespace kerfbench::source
