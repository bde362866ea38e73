// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/digest.h"
#include "hil/base/piece_reader.h"
#include "hil/base/progress.h"

namespace kerfbench::source {

// Private to this room.

/// The last line of a file of Kerfbench begins with it.
inline constexpr std::string_view kVcdSumBegin = "$comment kerfbench sum ";
/// The last line.
inline std::string vcdSumLine(std::string_view sum) {
  return std::string(kVcdSumBegin).append(sum).append(" $end\n");
}

/// The text of a VCD file, word by word, read in pieces: of a file of any size there are a few hundred
/// kilobytes in memory. Words are divided by blanks, as which all bytes up to ' ' count.
class VcdText {
 public:
  /// More than this a word or a section does not have.
  static constexpr std::size_t kMostKept = std::size_t{64} << 20U;
  static constexpr std::size_t kPiece = std::size_t{1} << 16U;

  /// @throws std::system_error with the path.
  VcdText(const std::filesystem::path& path, const base::ProgressFn& progress, std::size_t piece = kPiece);

  /// The next word, or nothing at the end of the file; to be used before the next one is asked for.
  /// @throws std::length_error, std::system_error.
  std::string_view word() {
    const char* at = at_;
    const char* const end = end_;
    std::size_t lines = 0;
    for (; at != end && static_cast<unsigned char>(*at) <= ' '; ++at) lines += *at == '\n' ? 1U : 0U;
    const char* const start = at;
    while (at != end && static_cast<unsigned char>(*at) > ' ') ++at;
    if (at == end) return wordAcrossPieces();
    line_ += lines;
    at_ = at;
    return {start, static_cast<std::size_t>(at - start)};
  }

  /// What is at hand of the text behind the last word; it may end within a word.
  [[nodiscard]] std::string_view ahead() const { return {at_, end_}; }
  /// Passes over a line of what is ahead, its end included.
  void skipLine(std::size_t size) {
    at_ += size;
    ++line_;
  }

  /// What stands between a keyword and its $end.
  struct Section {
    std::vector<std::string_view> words;  ///< The first 64.
    std::string_view text;                ///< From the first word to the last.
    std::string_view whole;               ///< With the keyword and $end.
  };
  /// The section whose keyword was the last word; nullopt: the file ends in it. To be used before the next
  /// word.
  std::optional<Section> section(std::string_view keyword);

  /// Line of the end of the last word, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

  /// Digest of all that stands before a place in what was asked for last. @throws std::logic_error after
  /// forgetDigest().
  std::string digestBefore(const char* place);
  void forgetDigest() { is_digested_ = false; }
  /// Passes over blanks and line ends; true: nothing else follows.
  bool onlyBlanksFollow();

 private:
  std::string_view wordAcrossPieces();
  /// Reads another piece behind [from, end_), which moves to another place. False: the file is at its end.
  bool more(const char* from);
  void digestUpTo(const char* place);

  base::PieceReader file_;
  base::ShareProgress progress_;
  std::size_t piece_;
  std::vector<char> buffer_;
  const char* at_{};
  const char* end_{};
  const char* digested_{};  ///< Up to here.
  std::optional<std::size_t>
      kept_;  ///< Where the section begins that is being read, from the buffer's begin.
  std::size_t line_{1};
  std::uint64_t bytes_{};
  bool is_digested_{true};
  base::Sha256 digest_;
};

}  // namespace kerfbench::source
