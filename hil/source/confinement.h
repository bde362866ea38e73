// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::source {

/// How a program that does not come with the bench is kept away from the computer it runs on.
struct Confinement {
  /// Program and arguments that run another one, whose path and arguments are to be appended.
  std::vector<std::string> launcher;
  /// Why it sees files and network like any program of this user, a clause; empty: it does not.
  std::string open_because;
};

/// Why bubblewrap is of no use here, a clause; empty: it is. Tried once.
const std::string& troubleOfBubblewrap();

/// Most addresses that such a program can take.
inline constexpr std::uint64_t kConfinedAddressSpace_bytes = std::uint64_t{4} << 30U;

/// Confinement of `program`. With bubblewrap it has no network, no other process in sight, no environment, no
/// capabilities, and of the files those of /usr, of its own folder and `readable`, none of which it can
/// write; it ends with the bench. Where bubblewrap is not installed, or must not make namespaces, its memory
/// alone is bounded.
/// @param program absolute. @param readable Files that it is to read, absolute.
Confinement confinementOf(const std::filesystem::path& program,
                          const std::vector<std::filesystem::path>& readable);

}  // namespace kerfbench::source
