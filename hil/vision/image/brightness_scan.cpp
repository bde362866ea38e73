// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/image/brightness_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <utility>
#include <vector>

#include "hil/vision/image/level_histogram.h"
#include "twin/base/image.h"
#include "twin/base/multiversion.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr int kCell = Background::kCellPx;
constexpr int kSampleStride = 16;
constexpr int kFetchRows = 8;
// A spot of 0.8 px or more that reaches the threshold in the mean of 2 x 4 pixels has five sixths of it in
// that of two columns and two rows of every other one, wherever it lies.
constexpr int kHintsLess = 6;
constexpr std::size_t kCacheLine = 64;

std::uint8_t meanOf(std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>((a + b + 1) >> 1); }

// Each of these loops is one averaging instruction per register: two averages in one loop would be taken
// apart into words.

KERFBENCH_WIDE void takeMeans(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* out,
                              std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) out[c] = meanOf(a[c], b[c]);
}

/// Raises `highest` to the means.
KERFBENCH_WIDE void raiseToMeans(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* highest,
                                 std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) highest[c] = std::max(highest[c], meanOf(a[c], b[c]));
}

KERFBENCH_WIDE std::uint8_t highestOf(const std::uint8_t* values, int count) {
  std::uint8_t best = 0;
  for (int i = 0; i < count; ++i) best = std::max(best, values[i]);
  return best;
}

/// Sorts each column of a table by itself: neighbours are swapped in turn, whole rows at once, without a
/// branch.
KERFBENCH_WIDE void sortColumns(std::uint8_t* table, std::size_t rows, std::size_t columns) {
  for (std::size_t round = 0; round < rows; ++round) {
    for (std::size_t k = round % 2; k + 1 < rows; k += 2) {
      std::uint8_t* const low = table + k * columns;
      std::uint8_t* const high = low + columns;
      for (std::size_t c = 0; c < columns; ++c) {
        const std::uint8_t least = std::min(low[c], high[c]);
        high[c] = std::max(low[c], high[c]);
        low[c] = least;
      }
    }
  }
}

/// Part of a row of a table: whole registers.
std::size_t strideFor(std::size_t columns) { return (columns + 31) / 32 * 32; }

constexpr std::size_t kPerSide = kCell / kSampleStride;
constexpr std::size_t kPerCell = kPerSide * kPerSide;

/// Samples of the picture: of its cells, of all, and steps between neighbours. Four histograms of each, as
/// counting twice in one place takes long.
class Samples {
 public:
  explicit Samples(const GrayImage& image)
      : image_(image),
        columns_(static_cast<std::size_t>((image.width + kCell - 1) / kCell)),
        stride_(strideFor(columns_)) {}

  /// Medians of the cells of a band.
  void addBand(int top, int bottom, std::vector<std::uint8_t>& medians) {
    table_.resize(kPerCell * stride_);
    std::size_t rows = 0;
    for (int r = top + (bottom - top > kSampleStride ? kSampleStride / 2 : 0); r < bottom; r += kSampleStride)
      addRow(r, rows++);
    // The last cell of a band, or those of the last band, may have fewer.
    const std::size_t full = rows == kPerSide ? static_cast<std::size_t>(image_.width / kCell) : 0;
    const std::size_t begin = medians.size();
    medians.resize(begin + columns_);
    for (std::size_t i = full; i < columns_; ++i) {
      const std::vector<std::uint8_t> values = partOf(i, rows);
      // All of a sliver of a cell may lie under a spot: its neighbour knows better.
      const bool sliver = values.size() < 4;
      if (sliver && i > 0 && rows > 1) {
        medians[begin + i] = medians[begin + i - 1];
      } else if (sliver && begin > 0) {
        medians[begin + i] = medians[begin + i - columns_];
      } else {
        medians[begin + i] = upperMedianOf(values);
      }
    }
    sortColumns(table_.data(), kPerCell, stride_);
    std::copy_n(table_.begin() + static_cast<std::ptrdiff_t>(kPerCell / 2 * stride_), full,
                medians.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  [[nodiscard]] std::array<int, 256> all() const { return sumOf(all_); }
  [[nodiscard]] std::array<int, 256> steps() const { return sumOf(steps_); }

 private:
  using Histograms = std::array<std::array<int, 256>, kPerSide>;

  void addRow(int r, std::size_t row) {
    const std::uint8_t* const line =
        image_.pixels.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(image_.width);
    for (int c = 0; c < image_.width; c += kSampleStride) {
      const auto place = static_cast<std::size_t>(c / kSampleStride);
      const std::size_t lane = place % kPerSide;
      table_[(row * kPerSide + lane) * stride_ + place / kPerSide] = line[c];
      ++all_[lane][line[c]];
      if (c + 1 < image_.width) ++steps_[lane][static_cast<std::size_t>(std::abs(line[c] - line[c + 1]))];
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> partOf(std::size_t cell, std::size_t rows) const {
    std::vector<std::uint8_t> values;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t lane = 0; lane < kPerSide; ++lane) {
        if (static_cast<int>(cell * kPerSide + lane) * kSampleStride < image_.width)
          values.push_back(table_[(row * kPerSide + lane) * stride_ + cell]);
      }
    }
    return values;
  }
  static std::array<int, 256> sumOf(const Histograms& lanes) {
    std::array<int, 256> sum{};
    for (const auto& lane : lanes) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += lane[i];
    }
    return sum;
  }

  const GrayImage& image_;
  std::size_t columns_;
  std::size_t stride_;
  std::vector<std::uint8_t> table_;
  Histograms all_{};
  Histograms steps_{};
};

/// At least the median of the cells around each cell.
std::vector<int> filledIn(const std::vector<std::uint8_t>& own, int columns, int rows) {
  std::vector<int> level(own.begin(), own.end());
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t stride = strideFor(width);
  std::vector<std::uint8_t> table(9 * stride);
  for (int j = 0; j < rows; ++j) {
    const auto row = static_cast<std::size_t>(j) * width;
    for (int i = 0; i<columns; i += columns> 1 && j > 0 && j + 1 < rows ? columns - 1 : 1) {
      std::vector<std::uint8_t> around;
      for (int y = std::max(0, j - 1); y <= std::min(rows - 1, j + 1); ++y) {
        for (int x = std::max(0, i - 1); x <= std::min(columns - 1, i + 1); ++x)
          around.push_back(own[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]);
      }
      int& here = level[row + static_cast<std::size_t>(i)];
      here = std::max(here, static_cast<int>(upperMedianOf(around)));
    }
    if (j == 0 || j + 1 == rows || columns < 3) continue;
    for (std::size_t k = 0; k < 9; ++k) {
      const std::size_t from = row - width + k / 3 * width + k % 3;
      std::copy_n(own.begin() + static_cast<std::ptrdiff_t>(from), width - 2,
                  table.begin() + static_cast<std::ptrdiff_t>(k * stride));
    }
    sortColumns(table.data(), 9, stride);
    for (std::size_t i = 1; i + 1 < width; ++i)
      level[row + i] = std::max(level[row + i], static_cast<int>(table[4 * stride + i - 1]));
  }
  return level;
}

/// Tells by every other row what the cells can hold: the brightest mean of two columns and two such rows. A
/// spot between two of the rows shines into both of them.
class CellHints {
 public:
  explicit CellHints(const GrayImage& image)
      : image_(image),
        width_(static_cast<std::size_t>(image.width)),
        means_(width_),
        before_(width_),
        highest_(width_) {}

  void addBand(int top, int bottom) {
    std::ranges::fill(highest_, std::uint8_t{0});
    for (int r = top; r < bottom; r += 2) {
      addRow(r);
      // At the picture's border no row beyond would see the spot.
      if (r == 0 || r == image_.height - 2) addRow(r + 1);
    }
    for (int left = 0; left < image_.width; left += kCell)
      hints_.push_back(highestOf(highest_.data() + left, std::min(kCell, image_.width - 1 - left)));
  }
  [[nodiscard]] const std::vector<std::uint8_t>& hints() const { return hints_; }

 private:
  void addRow(int r) {
    const std::uint8_t* const row = rowOf(r);
    if (r + kFetchRows < image_.height) fetch(rowOf(r + kFetchRows));
    takeMeans(row, row + 1, means_.data(), width_ - 1);
    raiseToMeans(means_.data(), r == 0 ? means_.data() : before_.data(), highest_.data(), width_ - 1);
    std::swap(means_, before_);
  }
  [[nodiscard]] const std::uint8_t* rowOf(int r) const {
    return image_.pixels.data() + static_cast<std::size_t>(r) * width_;
  }
  /// Asks the memory for a row that is needed soon: left to itself it keeps us waiting.
  void fetch(const std::uint8_t* row) const {
    for (std::size_t i = 0; i < width_; i += kCacheLine) __builtin_prefetch(row + i);
  }

  const GrayImage& image_;
  std::size_t width_;
  std::vector<std::uint8_t> means_;   ///< Means of two neighbours in the row.
  std::vector<std::uint8_t> before_;  ///< The same of the row read before.
  std::vector<std::uint8_t> highest_;
  std::vector<std::uint8_t> hints_;
};

/// A close look at one cell, by all of its rows.
class CellLook {
 public:
  /// `left`, `top`: the cell's first pixel, counted from the picture's own first.
  CellLook(const GrayImage& image, int left, int top)
      : image_(image),
        left_(left),
        top_(top),
        count_(static_cast<std::size_t>(std::min(kCell, image.width - 1 - left))) {}

  /// The brightest mean of 2 x 4 pixels, on every second row.
  [[nodiscard]] int brightest2x4() const {
    // The pair of rows above the cell belongs to its first mean; the picture's first pair goes with itself.
    Means before = squaresAt(std::max(0, top_ - 2));
    Means highest{};
    for (int r = top_; r < std::min(image_.height, top_ + kCell); r += 2) {
      // An odd last row goes with the one before.
      const Means here = squaresAt(std::min(r, image_.height - 2));
      raiseToMeans(here.data(), before.data(), highest.data(), count_);
      before = here;
    }
    return highestOf(highest.data(), static_cast<int>(count_));
  }

  /// The brightest 2 x 2 pixels in the cell and two rows around it.
  [[nodiscard]] BrightPeak brightest2x2() const {
    BrightPeak best{image_.left + left_, image_.top + top_, -1};
    for (int r = std::max(0, top_ - 2); r < std::min(image_.height - 1, top_ + kCell + 2); ++r) {
      const Means here = squaresAt(r);
      const int highest = highestOf(here.data(), static_cast<int>(count_));
      if (highest <= best.height) continue;
      const auto place = std::ranges::find(here, highest) - here.begin();
      best = {image_.left + left_ + static_cast<int>(place), image_.top + r, highest};
    }
    return best;
  }

 private:
  using Means = std::array<std::uint8_t, kCell>;

  /// Means of 2 x 2 pixels, first of each column's.
  [[nodiscard]] Means squaresAt(int r) const {
    const std::uint8_t* const upper = image_.pixels.data() +
                                      static_cast<std::size_t>(r) * static_cast<std::size_t>(image_.width) +
                                      static_cast<std::size_t>(left_);
    std::array<std::uint8_t, kCell + 1> rows{};
    takeMeans(upper, upper + image_.width, rows.data(), count_ + 1);
    Means means{};
    takeMeans(rows.data(), rows.data() + 1, means.data(), count_);
    return means;
  }

  const GrayImage& image_;
  int left_, top_;
  std::size_t count_;  ///< Columns that have a neighbour to the right.
};

}  // namespace

Background::Background(const GrayImage& image, const std::function<void(int, int)>& visit)
    : left_(image.left),
      top_(image.top),
      columns_((image.width + kCell - 1) / kCell),
      rows_((image.height + kCell - 1) / kCell) {
  std::vector<std::uint8_t> own;
  Samples samples(image);
  for (int top = 0; top < image.height; top += kCell) {
    const int bottom = std::min(image.height, top + kCell);
    if (visit) visit(top, bottom);
    samples.addBand(top, bottom, own);
  }
  const std::array<int, 256> all = samples.all();
  const std::array<int, 256> steps = samples.steps();
  median_ = quantile(all, 0.5);
  const int total = std::max(1, std::accumulate(all.begin(), all.end(), 0));
  saturated_share_ = static_cast<double>(all[254] + all[255]) / total;
  lifeless_ = withoutSteps(steps, total);
  noise_ = noiseBySteps(steps);
  level_ = filledIn(own, columns_, rows_);
}

BrightnessScan scanBrightness(const GrayImage& image, std::size_t max) {
  if (image.width < 2 || image.height < 2) return {Background(image), {}};
  CellHints cells(image);
  BrightnessScan scan{Background(image, [&](int top, int bottom) { cells.addBand(top, bottom); }), {}};
  const Background& background = scan.background;
  // The mean of eight pixels has 0.35 of the noise; 5.7 sigma leaves less than one false peak in a large
  // picture, which no fit takes for a spot. The averaging instruction rounds up, three times.
  const int threshold = static_cast<int>(std::ceil(std::max(5.0, 2.0 * background.noise() + 1.5)));
  const int hint_threshold = threshold - (threshold + kHintsLess - 1) / kHintsLess;
  struct Candidate {
    BrightPeak peak;
    int cell_x;
    int cell_y;
  };
  std::vector<Candidate> candidates;
  for (int j = 0; j < background.rows(); ++j) {
    for (int i = 0; i < background.columns(); ++i) {
      const int board = background.at(image.left + i * kCell, image.top + j * kCell);
      const std::size_t cell = static_cast<std::size_t>(j) * static_cast<std::size_t>(background.columns()) +
                               static_cast<std::size_t>(i);
      if (cells.hints()[cell] < board + hint_threshold) continue;
      CellLook look(image, i * kCell, j * kCell);
      if (look.brightest2x4() < board + threshold) continue;
      BrightPeak peak = look.brightest2x2();
      peak.height -= board;
      candidates.push_back({peak, i, j});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.peak.height > b.peak.height; });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    if (kept.size() == max) break;
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const Candidate& k) {
      return std::abs(k.cell_x - c.cell_x) <= 1 && std::abs(k.cell_y - c.cell_y) <= 1;
    });
    if (!beside) kept.push_back(c);
  }
  for (const Candidate& k : kept) scan.peaks.push_back(k.peak);
  return scan;
}

}  // namespace kerfbench::vision
