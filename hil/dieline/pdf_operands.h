// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "hil/dieline/faults.h"
#include "hil/dieline/pdf_lexer.h"

namespace kerfbench::dieline {

/// States, marked sections and arrays are not nested deeper than this.
inline constexpr std::size_t kDeepestPdf = 512;

/// What stands in front of an operator of a content stream.
class PdfOperands {
 public:
  explicit PdfOperands(FaultList& faults) : faults_(faults) {}

  /// Keeps an operand. False for an operator that is to be run now.
  /// @throws DielineError for what is no content.
  bool keep(const PdfToken& token);
  void clear() { operands_.clear(); }
  /// @throws DielineError if a content ends within an array.
  void checkEnd();

  [[nodiscard]] std::size_t count() const { return operands_.size(); }
  [[nodiscard]] const PdfToken& operator[](std::size_t i) const { return operands_[i]; }
  /// The last operand, if it is a name; else an empty one.
  [[nodiscard]] std::string_view name() const;
  /// True if the last array has a number above zero, as a pattern of dashes does.
  [[nodiscard]] bool hasDashes() const { return has_dashes_; }

  /// The last N operands. @throws DielineError unless they are numbers that are no larger than 1e9.
  template <std::size_t N>
  std::array<double, N> numbers(const char* name) {
    std::array<double, N> values{};
    if (!fill(values.data(), N)) refuse(name, N);
    return values;
  }

 private:
  bool fill(double* values, std::size_t count) const;
  [[noreturn]] void refuse(const char* name, std::size_t count);

  FaultList& faults_;
  std::vector<PdfToken> operands_;
  std::size_t depth_{};  // Open arrays and dictionaries.
  bool has_dashes_{};
};

}  // namespace kerfbench::dieline
