// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hil/source/analyser/sigrok_child/handles.h"

namespace kerfbench::sigrok_child {

/// Messages of libsigrok's drivers, the only place in which they report overruns.
class DriverLog {
 public:
  DriverLog();
  ~DriverLog();
  DriverLog(const DriverLog&) = delete;
  DriverLog& operator=(const DriverLog&) = delete;

  /// Errors and warnings since the last call; each once, the first ten.
  std::vector<std::string> takeErrors() { return std::exchange(errors_, {}); }
  std::vector<std::string> takeWarnings() { return std::exchange(warnings_, {}); }

 private:
  static int receive(void* self, int level, const char* format, va_list arguments);
  std::vector<std::string> errors_, warnings_;
};

/// libsigrok, its drivers and devices. @throws SigrokError throughout.
class Library {
 public:
  Library();

  /// Drivers of logic analysers, by name.
  [[nodiscard]] std::vector<sr_dev_driver*> drivers() const;
  [[nodiscard]] sr_dev_driver* driver(const std::string& name) const;
  /// `conn` may be empty. Devices stay the driver's.
  std::vector<sr_dev_inst*> scan(sr_dev_driver* driver, const std::string& conn);
  [[nodiscard]] sr_context* context() const { return context_.get(); }
  DriverLog& log() { return log_; }
  /// Error in words by libsigrok's code, and what its drivers have said since.
  std::string why(int code);

 private:
  DriverLog log_;
  Handle<sr_context> context_;
};

/// Maker, model and version, as far as they are known.
std::string nameOf(sr_dev_inst* device);
/// "fx2lafw Saleae Logic, serial 0123, at 1.14".
std::string describe(sr_dev_inst* device);
/// Logic channels.
std::vector<sr_channel*> logicChannels(sr_dev_inst* device);
/// Rates of the open device, for people; empty: it lists none.
std::string ratesOf(sr_dev_inst* device);

}  // namespace kerfbench::sigrok_child
