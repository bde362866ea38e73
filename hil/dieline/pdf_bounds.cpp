// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_bounds.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <qpdf/InputSource.hh>
#include <qpdf/Pl_Flate.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFStreamFilter.hh>

#include "hil/dieline/pdf_document.h"

namespace kerfbench::dieline {
namespace {

/// The file that this thread reads. The library makes filters without saying for which file.
thread_local PdfBudget* open_budget = nullptr;

/// A file in memory that counts what is read of it.
class CountedSource : public InputSource {
 public:
  CountedSource(std::string_view bytes, PdfBudget& budget) : bytes_(bytes), budget_(budget) {}

  qpdf_offset_t findAndSkipNextEOL() override {
    const std::size_t from = std::min(at_, bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", from), bytes_.size());
    at_ = std::min(bytes_.find_first_not_of("\r\n", end), bytes_.size());
    budget_.takeStructure(at_ - from);
    return static_cast<qpdf_offset_t>(end);
  }
  std::string const& getName() const override { return name_; }
  qpdf_offset_t tell() override { return static_cast<qpdf_offset_t>(at_); }
  void seek(qpdf_offset_t offset, int whence) override {
    const auto from = static_cast<qpdf_offset_t>(whence == SEEK_SET   ? 0
                                                 : whence == SEEK_CUR ? at_
                                                                      : bytes_.size());
    if (from + offset < 0) throw std::runtime_error("seek before the beginning of the file");
    at_ = static_cast<std::size_t>(from + offset);
  }
  void rewind() override { at_ = 0; }
  std::size_t read(char* buffer, std::size_t length) override {
    const std::size_t from = std::min(at_, bytes_.size());
    const std::size_t count = std::min(length, bytes_.size() - from);
    if (budget_.isInContent())
      budget_.takePacked(count);
    else
      budget_.takeStructure(count);
    setLastOffset(static_cast<qpdf_offset_t>(from));
    std::memcpy(buffer, bytes_.data() + from, count);
    at_ = from + count;
    return count;
  }
  void unreadCh(char) override { at_ -= at_ > 0 ? 1 : 0; }

 private:
  std::string_view bytes_;
  PdfBudget& budget_;
  std::string name_{"PDF"};
  std::size_t at_{};
};

/// Counts what comes out of a filter.
class CountedOutput : public Pipeline {
 public:
  explicit CountedOutput(Pipeline* next) : Pipeline("counted", next) {}
  void write(unsigned char const* data, std::size_t length) override {
    if (open_budget != nullptr) {
      if (open_budget->isInContent())
        open_budget->takeUnpacked(length);
      else
        open_budget->takeStructure(length);
    }
    getNext()->write(data, length);
  }
  void finish() override { getNext()->finish(); }
};

/// Undoes PNG's prediction of rows (ISO 32000-1, 7.4.4.4), which tables of objects are packed with.
class PngRows : public Pipeline {
 public:
  PngRows(Pipeline* next, std::size_t row_bytes, std::size_t pixel_bytes)
      : Pipeline("PNG rows", next), pixel_(pixel_bytes), row_(row_bytes + 1), above_(row_bytes + 1) {}

  void write(unsigned char const* data, std::size_t length) override {
    while (length > 0) {
      const std::size_t count = std::min(length, row_.size() - filled_);
      std::copy_n(data, count, row_.begin() + static_cast<std::ptrdiff_t>(filled_));
      filled_ += count;
      data += count;
      length -= count;
      if (filled_ == row_.size()) putRow();
    }
  }
  void finish() override {
    if (filled_ > 1) {
      std::fill(row_.begin() + static_cast<std::ptrdiff_t>(filled_), row_.end(), 0);
      putRow();
    }
    getNext()->finish();
  }

 private:
  void putRow() {
    for (std::size_t i = 1; i < row_.size(); ++i) {
      const int left = i > pixel_ ? row_[i - pixel_] : 0;
      const int above_left = i > pixel_ ? above_[i - pixel_] : 0;
      row_[i] = static_cast<unsigned char>(row_[i] + predicted(row_[0], left, above_[i], above_left));
    }
    getNext()->write(row_.data() + 1, row_.size() - 1);
    row_.swap(above_);
    filled_ = 0;
  }
  static int predicted(int method, int left, int above, int above_left) {
    switch (method) {
      case 1:
        return left;
      case 2:
        return above;
      case 3:
        return (left + above) / 2;
      case 4: {
        const int p = left + above - above_left;
        const int to_left = std::abs(p - left);
        const int to_above = std::abs(p - above);
        const int to_corner = std::abs(p - above_left);
        if (to_left <= to_above && to_left <= to_corner) return left;
        return to_above <= to_corner ? above : above_left;
      }
      default:
        return 0;
    }
  }

  std::size_t pixel_;
  std::vector<unsigned char> row_;  // Behind the byte that names the row's method.
  std::vector<unsigned char> above_;
  std::size_t filled_{};
};

class BoundedFlate : public QPDFStreamFilter {
 public:
  bool setDecodeParms(QPDFObjectHandle parms) override {
    if (parms.isNull()) return true;
    if (!parms.isDictionary()) return false;
    const auto number = [&](const char* key, long long fallback) {
      auto value = parms.getKey(key);
      return value.isInteger() ? value.getIntValue() : fallback;
    };
    const long long predictor = number("/Predictor", 1);
    if (predictor == 1) return true;
    const long long colours = number("/Colors", 1);
    const long long bits = number("/BitsPerComponent", 8);
    const long long columns = number("/Columns", 1);
    constexpr long long kWidest = 1 << 16;
    if (predictor < 10 || predictor > 15 || colours < 1 || colours > 32 || bits < 1 || bits > 16 ||
        columns < 1 || columns > kWidest)
      return false;
    pixel_bytes_ = static_cast<std::size_t>(std::max(1LL, colours * bits / 8));
    row_bytes_ = static_cast<std::size_t>((colours * bits * columns + 7) / 8);
    return true;
  }
  Pipeline* getDecodePipeline(Pipeline* next) override {
    if (row_bytes_ > 0) {
      rows_ = std::make_unique<PngRows>(next, row_bytes_, pixel_bytes_);
      next = rows_.get();
    }
    counted_ = std::make_unique<CountedOutput>(next);
    inflate_ = std::make_unique<Pl_Flate>("inflate", counted_.get(), Pl_Flate::a_inflate);
    return inflate_.get();
  }

 private:
  std::size_t row_bytes_{};
  std::size_t pixel_bytes_{1};
  std::unique_ptr<PngRows> rows_;
  std::unique_ptr<CountedOutput> counted_;
  std::unique_ptr<Pl_Flate> inflate_;
};

/// Filters that unpack without bound and that no program writes drawings with.
class NoFilter : public QPDFStreamFilter {
 public:
  bool setDecodeParms(QPDFObjectHandle) override { return false; }
  Pipeline* getDecodePipeline(Pipeline*) override { return nullptr; }
};

void registerFilters() {
  static std::once_flag once;
  std::call_once(once, [] {
    QPDF::registerStreamFilter("/FlateDecode", [] { return std::make_shared<BoundedFlate>(); });
    for (const char* name : {"/LZWDecode", "/RunLengthDecode"})
      QPDF::registerStreamFilter(name, [] { return std::make_shared<NoFilter>(); });
  });
}

class AppendingTo : public Pipeline {
 public:
  AppendingTo(std::string& text, PdfBudget& budget)
      : Pipeline("text", nullptr), text_(text), budget_(budget) {}
  void write(unsigned char const* data, std::size_t length) override {
    budget_.takeContent(length);
    text_.append(reinterpret_cast<char const*>(data), length);
  }
  void finish() override {}

 private:
  std::string& text_;
  PdfBudget& budget_;
};

}  // namespace

PdfBudget::~PdfBudget() {
  if (open_budget == this) open_budget = nullptr;
}

void PdfBudget::take(std::size_t& used, std::size_t bytes, std::size_t most, const char* what) {
  used += bytes;
  if (used <= most) return;
  if (exceeded_.empty()) exceeded_ = fmt::format("{} take more than {} KiB", what, most >> 10U);
  throw std::runtime_error(exceeded_);
}

void PdfBudget::takeStructure(std::size_t bytes) {
  take(structure_, bytes, kMostStructure, "the objects that describe its page");
}

void PdfBudget::takePacked(std::size_t bytes) {
  take(packed_, bytes, 2 * kLargestPdf, "the streams that its page names");
}

void PdfBudget::takeUnpacked(std::size_t bytes) {
  take(unpacked_, bytes, 2 * kLargestPdfContent, "the streams that its page names");
}

void PdfBudget::takeContent(std::size_t bytes) {
  take(content_, bytes, kLargestPdfContent, "the unpacked drawings of its page");
}

void openBounded(QPDF& pdf, const std::string& bytes, PdfBudget& budget) {
  registerFilters();
  open_budget = &budget;
  pdf.setSuppressWarnings(true);
  pdf.setAttemptRecovery(false);
  pdf.processInputSource(std::make_shared<CountedSource>(bytes, budget));
}

bool appendUnpacked(QPDFObjectHandle& stream, PdfBudget& budget, std::string& text) {
  AppendingTo output(text, budget);
  budget.setInContent(true);
  bool is_filtered = false;
  const bool is_whole = stream.pipeStreamData(&output, &is_filtered, 0, qpdf_dl_generalized, true, false);
  budget.setInContent(false);
  return is_whole && is_filtered;
}

}  // namespace kerfbench::dieline
