// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/base/temporary.h"

namespace kerfbench::judge {

/// Refuses a place that holds what no run wrote, before anything runs: a later commit() would delete it.
/// A place where nothing is, an empty folder and the results of an earlier run are fine.
/// @throws base::InputError that names the place and what is there.
void refuseForeignResults(const std::filesystem::path& parent, const std::string& name);

/// A results folder that appears whole or not at all: everything is written beside its place, commit() swaps
/// it in. Without commit() nothing is left.
class ResultsFolder {
 public:
  /// @throws std::system_error if `parent` cannot be made or written.
  ResultsFolder(const std::filesystem::path& parent, const std::string& name);

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& staging() const { return staging_.path(); }
  /// Where it will be.
  [[nodiscard]] const std::filesystem::path& place() const { return place_; }
  /// Adds kResultsList and puts the folder in its place; an older one there is replaced in one step, or on
  /// drives that cannot exchange two names (many of a network) in two. @throws std::system_error, or as
  /// refuseForeignResults() for what has come there meanwhile; the older one stays then.
  void commit();
  /// Adds kResultsList and puts the folder to a place of its own, beside nothing of the same name.
  /// @throws std::system_error, also where the place is taken.
  void commitTo(const std::filesystem::path& place);

 private:
  [[nodiscard]] bool renamed(const std::filesystem::path& place, unsigned flags) const;
  void commitInSteps();

  std::filesystem::path place_;
  base::TemporaryFolder staging_;
};

}  // namespace kerfbench::judge
