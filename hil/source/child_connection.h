// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/child_channel.h"

namespace kerfbench::source {

/// A child on another computer, or in a container, behind a TCP connection.
class ChildConnection final : public ChildChannel {
 public:
  /// @throws std::runtime_error with the address if nobody answers within `patience`.
  ChildConnection(const std::string& host, const std::string& port, std::chrono::milliseconds patience);

  std::string finish(std::chrono::milliseconds patience) override;
  void kill() override;
};

/// Starts the program, or connects to the child that a path "tcp:HOST:PORT" names.
/// @param launcher What runs the program (Confinement); empty: it is run as it is.
/// @throws std::system_error, std::runtime_error as they do.
std::unique_ptr<ChildChannel> openChannel(const std::filesystem::path& child,
                                          std::vector<std::string> launcher = {});

/// Whether a path stands for a child behind a connection, "tcp:HOST:PORT".
[[nodiscard]] bool isConnection(const std::filesystem::path& child);

}  // namespace kerfbench::source
