// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "hil/base/digest.h"
#include "hil/base/piece_reader.h"
#include "hil/source/vcd.h"
#include "hil/source/vcd_text.h"

namespace kerfbench::source {
namespace {

/// Where the last line of a file of Kerfbench begins, if it is one that a sum can stand in.
std::optional<std::uint64_t> beginOfSum(base::PieceReader& file, std::string& sum) {
  constexpr std::size_t kDigits = 64;
  constexpr std::size_t kPiece = std::size_t{1} << 16U;
  const std::size_t length = vcdSumLine(std::string(kDigits, '0')).size() - 1;
  // Blanks behind it belong to no line.
  std::uint64_t end = file.size();
  std::string tail;
  const auto readBefore = [&](std::size_t bytes) {
    tail.resize(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, end)));
    file.seek(end - tail.size());
    tail.resize(file.read(tail));
  };
  for (std::size_t last = std::string::npos; last == std::string::npos && end > 0;) {
    readBefore(kPiece);
    if (tail.empty()) return std::nullopt;
    last = tail.find_last_not_of(" \n");
    end -= tail.size() - (last == std::string::npos ? 0 : last + 1);
  }
  readBefore(length);
  if (tail.size() != length || !tail.starts_with(kVcdSumBegin)) return std::nullopt;
  sum = tail.substr(kVcdSumBegin.size(), kDigits);
  if (tail + "\n" != vcdSumLine(sum)) return std::nullopt;
  return end - length;
}

}  // namespace

std::optional<std::string> vcdSum(const std::filesystem::path& path) {
  base::PieceReader file(path, path.string());
  std::string sum;
  const auto begin = beginOfSum(file, sum);
  if (!begin) return std::nullopt;
  file.seek(0);
  base::Sha256 digest;
  base::forEachPiece(file, *begin, [&](std::string_view piece) { digest.add(piece); });
  if (digest.digest() != sum) return std::nullopt;
  return sum;
}

}  // namespace kerfbench::source
