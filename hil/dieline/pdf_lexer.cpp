// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_lexer.h"

#include <charconv>
#include <cmath>

namespace kerfbench::dieline {
namespace {

bool isPdfBlank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\0'; }
bool isPdfDelimiter(char c) {
  return c == '(' || c == ')' || c == '<' || c == '>' || c == '[' || c == ']' || c == '{' || c == '}' ||
         c == '/' || c == '%';
}

/// A number of PDF has no exponent; nothing for any other word.
bool readPdfNumber(std::string_view word, double& value) {
  std::size_t first = word.starts_with('+') || word.starts_with('-') ? 1 : 0;
  const std::string_view digits = word.substr(first);
  if (digits.empty() || digits.find_first_not_of("0123456789.") != std::string_view::npos) return false;
  if (digits.find('.') != digits.rfind('.') || digits == ".") return false;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {
    value = HUGE_VAL;
  } else if (error != std::errc{} || end != digits.data() + digits.size()) {
    return false;
  }
  if (word.starts_with('-')) value = -value;
  return true;
}

}  // namespace

void PdfLexer::passBlanks() {
  while (at_ < text_.size()) {
    if (isPdfBlank(text_[at_])) {
      ++at_;
    } else if (text_[at_] == '%') {
      at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
    } else {
      return;
    }
  }
}

PdfToken PdfLexer::word() {
  const std::size_t from = at_;
  while (at_ < text_.size() && !isPdfBlank(text_[at_]) && !isPdfDelimiter(text_[at_])) ++at_;
  PdfToken token;
  token.text = text_.substr(from, at_ - from);
  token.kind = PdfToken::Kind::kOperator;
  if (readPdfNumber(token.text, token.number)) token.kind = PdfToken::Kind::kNumber;
  // Values that nothing here asks for, like a string's.
  if (token.text == "true" || token.text == "false" || token.text == "null")
    token.kind = PdfToken::Kind::kString;
  return token;
}

bool PdfLexer::passString() {
  int depth = 0;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '\\') {
      ++at_;
    } else if (c == '(') {
      ++depth;
    } else if (c == ')' && --depth == 0) {
      ++at_;
      return true;
    }
  }
  return false;
}

PdfToken PdfLexer::next() {
  using Kind = PdfToken::Kind;
  passBlanks();
  if (at_ >= text_.size()) return {};
  const char c = text_[at_];
  const std::string_view one = text_.substr(at_, 1);
  if (c == '/') {
    ++at_;
    PdfToken token = word();
    token.kind = Kind::kName;
    return token;
  }
  if (c == '(') return {passString() ? Kind::kString : Kind::kBroken, 0.0, one};
  if (c == '<' && !text_.substr(at_).starts_with("<<")) {
    const std::size_t end = text_.find('>', at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    return {end == std::string_view::npos ? Kind::kBroken : Kind::kString, 0.0, one};
  }
  if (c == '[' || c == '<' || c == '{') {
    at_ += c == '<' ? 2 : 1;
    return {Kind::kOpen, 0.0, one};
  }
  if (c == ']' || c == '}' || (c == '>' && text_.substr(at_).starts_with(">>"))) {
    at_ += c == '>' ? 2 : 1;
    return {Kind::kClose, 0.0, one};
  }
  if (isPdfDelimiter(c)) {
    ++at_;
    return {Kind::kBroken, 0.0, one};
  }
  return word();
}

bool PdfLexer::passInlineImage() {
  ++at_;  // One blank is not the image's.
  while (true) {
    const std::size_t found = text_.find("EI", at_);
    if (found == std::string_view::npos) return false;
    at_ = found + 2;
    const bool begins = found > 0 && isPdfBlank(text_[found - 1]);
    if (begins && (at_ >= text_.size() || isPdfBlank(text_[at_]))) return true;
  }
}

std::string pdfName(std::string_view raw) {
  std::string name;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    unsigned value = 0;
    const char* digits = raw.data() + i + 1;
    if (raw[i] == '#' && i + 2 < raw.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      name += static_cast<char>(value);
      i += 2;
    } else {
      name += raw[i];
    }
  }
  return name;
}

}  // namespace kerfbench::dieline
