// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerfbench::dieline {

/// One token of a content stream (ISO 32000-1, 7.8.2).
struct PdfToken {
  enum class Kind { kNumber, kName, kString, kOpen, kClose, kOperator, kEnd, kBroken };
  Kind kind{Kind::kEnd};
  double number{};
  std::string_view text;  ///< The name behind its slash, the operator, or what is broken.
};

/// Takes a content stream apart. Strings and comments are passed over, arrays and dictionaries are told by
/// their brackets.
class PdfLexer {
 public:
  explicit PdfLexer(std::string_view text) : text_(text) {}

  PdfToken next();
  /// Passes over the data of an inline image, behind its ID. False if it has no end.
  bool passInlineImage();

 private:
  void passBlanks();
  PdfToken word();
  bool passString();

  std::string_view text_;
  std::size_t at_{};
};

/// A name with its #xx undone.
std::string pdfName(std::string_view raw);

/// An operator's letters as one number, to choose by; 0 for words that are no operator's.
constexpr std::uint32_t pdfOperator(std::string_view word) {
  if (word.empty() || word.size() > 3) return 0;
  std::uint32_t code = 0;
  for (const char c : word) code = code << 8U | static_cast<unsigned char>(c);
  return code;
}

}  // namespace kerfbench::dieline
