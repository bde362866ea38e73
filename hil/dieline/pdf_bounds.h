// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

class QPDF;
class QPDFObjectHandle;

namespace kerfbench::dieline {

/// What a PDF may take of time and memory. The library has no limits of its own for what a stream unpacks
/// to, and an object takes more than a hundred times the bytes that it is written with.
class PdfBudget {
 public:
  PdfBudget() = default;
  PdfBudget(const PdfBudget&) = delete;
  PdfBudget& operator=(const PdfBudget&) = delete;
  ~PdfBudget();

  /// Objects: their text, and streams in which objects are packed.
  static constexpr std::size_t kMostStructure = 3U << 18U;

  /// @throws std::runtime_error when there is not so much left.
  void takeStructure(std::size_t bytes);
  void takePacked(std::size_t bytes);    ///< Bytes of the file in streams, as often as they are read.
  void takeUnpacked(std::size_t bytes);  ///< What filters make of them, each filter by itself.
  void takeContent(std::size_t bytes);   ///< What is kept of that.
  /// What was too much; empty if nothing was.
  [[nodiscard]] const std::string& exceeded() const { return exceeded_; }
  [[nodiscard]] bool isInContent() const { return is_in_content_; }
  void setInContent(bool value) { is_in_content_ = value; }

 private:
  void take(std::size_t& used, std::size_t bytes, std::size_t most, const char* what);

  std::size_t structure_{};
  std::size_t packed_{};
  std::size_t unpacked_{};
  std::size_t content_{};
  bool is_in_content_{};
  std::string exceeded_;
};

/// Opens a file in memory. `bytes` and `budget` must outlive `pdf`, and only one file is open in a thread.
void openBounded(QPDF& pdf, const std::string& bytes, PdfBudget& budget);

/// Appends the unpacked bytes of a stream. False where it cannot be unpacked.
bool appendUnpacked(QPDFObjectHandle& stream, PdfBudget& budget, std::string& text);

}  // namespace kerfbench::dieline
