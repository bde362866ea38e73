// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_operands.h"

#include <cmath>

#include <fmt/format.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {
constexpr std::size_t kMostOperands = 64;  // No operator takes more than 33.
}

bool PdfOperands::keep(const PdfToken& token) {
  using Kind = PdfToken::Kind;
  if (token.kind == Kind::kBroken)
    faults_.fatal(0, fmt::format("the drawing of its page is broken at {}", inQuotes(token.text)));
  if (token.kind == Kind::kOpen) {
    if (depth_++ == 0) has_dashes_ = false;
    if (depth_ > kDeepestPdf)
      faults_.fatal(0,
                    fmt::format("arrays in the drawing of its page are nested deeper than {}", kDeepestPdf));
    return true;
  }
  if (token.kind == Kind::kClose) {
    if (depth_ == 0) faults_.fatal(0, "the drawing of its page closes an array that is not open");
    --depth_;
    return true;
  }
  if (depth_ > 0) {
    has_dashes_ = has_dashes_ || (token.kind == Kind::kNumber && token.number > 0.0);
    return true;
  }
  if (token.kind == Kind::kOperator) return false;
  if (operands_.size() >= kMostOperands) {
    faults_.fatal(0, fmt::format("more than {} operands without an operator in the drawing of its page",
                                 kMostOperands));
  }
  operands_.push_back(token);
  return true;
}

void PdfOperands::checkEnd() {
  if (depth_ > 0) faults_.fatal(0, "the drawing of its page ends within an array");
  clear();
}

std::string_view PdfOperands::name() const {
  const bool is_name = !operands_.empty() && operands_.back().kind == PdfToken::Kind::kName;
  return is_name ? operands_.back().text : std::string_view{};
}

bool PdfOperands::fill(double* values, std::size_t count) const {
  constexpr double kLargest = 1e9;
  if (operands_.size() < count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const PdfToken& token = operands_[operands_.size() - count + i];
    if (token.kind != PdfToken::Kind::kNumber || !(std::abs(token.number) <= kLargest)) return false;
    values[i] = token.number;
  }
  return true;
}

void PdfOperands::refuse(const char* name, std::size_t count) {
  faults_.fatal(0,
                fmt::format("the drawing of its page has {} without the numbers that it needs ({}), or with "
                            "one out of range",
                            name, count));
}

}  // namespace kerfbench::dieline
