// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// Protocol of bench and kerfbench-sigrok: one request on the child's standard input, frames on its standard
/// output, each a type, a length of 4 bytes (little-endian) and as many bytes.
///
///   request: lines, the last of them empty
///     list
///   or
///     acquire
///     driver NAME, conn TEXT, serial TEXT         the last two only if given
///     samplerate HZ, quiet SAMPLES, limit SAMPLES
///     channel NAME                                once for each, in the order of the bits of levels
///     setting KEY=VALUE                           as often as needed
///   frames
///     kLibrary, kDevice    lines "KEY TEXT": library, driver (each) · driver, name, serial, conn, rates,
///                          channel (each)
///     kFault               text: a device that was found and cannot be opened
///     kError               text: it does not come to that; the child ends
///     kStarted             text: the device; it samples at the rate asked for
///     kRuns                any number of runs: u64 samples, u32 levels
///     kProblem, kNote      text: an error or warning that the driver reported while it sampled
///     kFinished            u8 AnalyserReason; the child ends
///     kListed              nothing; the list is complete, the child ends
namespace kerfbench::source::analyser_stream {

enum class AnalyserFrame : std::uint8_t {
  kLibrary = 'l',
  kDevice = 'd',
  kFault = 'v',
  kError = 'e',
  kStarted = 's',
  kRuns = 'r',
  kProblem = 'p',
  kNote = 'n',
  kFinished = 'f',
  kListed = 'z',
};

/// Reason why sampling ended.
enum class AnalyserReason : std::uint8_t {
  kQuiet = 0,
  kLimit = 1,
  kDevice = 2,  ///< The device stopped by itself: memory full, overrun, unplugged.
  kBroken = 3,  ///< Reason that is never sent: the child died or its frames made no sense; see `problems`.
};

inline constexpr std::size_t kHeadBytes = 5;
inline constexpr std::size_t kRunBytes = 12;
inline constexpr std::size_t kMostFrameBytes = std::size_t{64} << 20U;

}  // namespace kerfbench::source::analyser_stream
