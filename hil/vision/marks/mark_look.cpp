// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "hil/vision/marks/disc_pixels.h"
#include "twin/base/constants.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr double kInnerRim = 0.75;     // Share of the radius within which all is ink.
constexpr double kBoardWithin = 0.35;  // Share of the contrast within which a pixel is board.
constexpr double kInkBeyond = 0.65;    // Share of it beyond which a pixel is ink.

/// Noise of the centroid per axis but for the light's slope, from what the sectors of the edge show beyond a
/// shift and a growth of the disc: a sector that has s more ink (in pixels) moves it by s * radius / area.
double centroidNoise(const std::array<double, kSectors>& sector, double radius_px, double area_px) {
  double mean = 0.0;
  double cosine = 0.0;
  double sine = 0.0;
  const auto angleOf = [](std::size_t k) { return 2.0 * kPi * (static_cast<double>(k) + 0.5) / kSectors; };
  for (std::size_t k = 0; k < kSectors; ++k) {
    mean += sector[k] / kSectors;
    cosine += sector[k] * std::cos(angleOf(k)) * 2.0 / kSectors;
    sine += sector[k] * std::sin(angleOf(k)) * 2.0 / kSectors;
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    const double rest = sector[k] - mean - cosine * std::cos(angleOf(k)) - sine * std::sin(angleOf(k));
    squares += rest * rest;
  }
  return radius_px / area_px * std::sqrt(0.5 * kSectors * squares / (kSectors - 3));
}

/// Columns [first, last) of a row.
struct Span {
  int first{};
  int last{};
  [[nodiscard]] bool empty() const { return first >= last; }
  [[nodiscard]] Span within(const Span& other) const {
    return {std::max(first, other.first), std::min(last, other.last)};
  }
};

/// What of `whole` lies before and behind `part`, which may be empty.
std::array<Span, 2> around(const Span& whole, const Span& part) {
  if (part.empty()) return {whole, {}};
  return {Span{whole.first, part.first}, Span{part.last, whole.last}};
}

/// A row's levels by their columns in the picture.
template <typename Level>
struct Row {
  const Level* first;
  int left;
  [[nodiscard]] const Level* from(int column) const { return first + (column - left); }
};

/// Sums over the pixels of one look at a printed disc, row by row. Where a pixel is all ink or all board
/// there is nothing to weigh; only those of the edge are taken by their gray.
class MarkSums {
 public:
  MarkSums(const DiscPlace& disc, const MarkLevels& levels, bool check_edge, double levels_per_gray)
      : disc_(disc),
        levels_(levels),
        check_edge_(check_edge),
        levels_known_(levels.pictures > 1.0),
        gray_per_level_(static_cast<float>(1.0 / levels_per_gray)),
        contrast_(levels.contrast()),
        radius_px_(disc.radius_px()),
        inner2_(squared(kInnerRim * radius_px_)),
        outer2_(squared(kOuterRim * radius_px_)),
        edge_begin2_(squared(std::max(0.0, radius_px_ - disc.edge_half_px))),
        edge_end2_(squared(radius_px_ + disc.edge_half_px)),
        circle_(disc.mm_per_pixel / disc.pitch_mm()),
        form_(circle_.transpose() * circle_) {}

  template <typename Level>
  void addRow(const Row<Level>& row, int r, const Span& columns) {
    const double y = r - disc_.centre.y();
    const RowOfDisc circles(*this, y);
    const Span look = circles.within(outer2_, columns);
    if (look.empty()) return;
    const Span disc = circles.within(edge_end2_, look);
    const Span full = circles.within(edge_begin2_, disc);
    for (const Span& edge : around(disc, full))
      collect(row, edge, y, edge_pixels_, [this](const DiscPixels& p) { takeEdge(p); });
    if (!levels_known_ || r % 2 == 0) {
      for (const Span& board : around(look, disc))
        collect(row, board, y, board_pixels_, [this](const DiscPixels& p) { takeBoard(p); });
      collect(row, circles.within(inner2_, look), y, ink_pixels_,
              [this](const DiscPixels& p) { takeInk(p); });
    }
    const double n = std::max(0, full.last - full.first);
    full_ += n;
    full_moment_ += n * Eigen::Vector2d(0.5 * (full.first + full.last - 1) - disc_.centre.x(), y);
  }

  /// What the rows have shown.
  [[nodiscard]] MarkLook look() {
    for (DiscPixels* const pixels : {&board_pixels_, &edge_pixels_, &ink_pixels_}) pixels->pad();
    takeBoard(board_pixels_);
    takeEdge(edge_pixels_);
    takeInk(ink_pixels_);
    const double board = board_.n.total();
    const double outer = board + board_.below.total() + board_.above.total();
    const double ink = ink_.n.total();
    const double weight = full_ + edge_.ink.total();
    MarkLook look{};
    if (!(ink > 0.0) || !(outer > 0.0) || !(weight > 1.0)) {
      look.stained_share = 1.0;
      return look;
    }
    const Eigen::Vector2d moment = full_moment_ + Eigen::Vector2d(edge_.x.total(), edge_.y.total());
    look.centroid = disc_.centre + moment / weight;
    look.area_px = weight;
    look.stained_share = ink_.above.total() / (ink + ink_.above.total());
    look.darkened_share = board_.below.total() / outer;
    look.board_share = board / outer;
    const std::optional<BoardPlane> plane = boardPlane();
    look.levels = measuredLevels(plane);
    if (check_edge_) look.sigma_px = noise(plane, weight);
    double mean = 0.0;
    for (const double s : edge_.beyond) mean += s / kSectors;
    for (const double s : edge_.beyond) {
      look.worst_sector_px =
          std::max(look.worst_sector_px, std::abs(s - mean) * kSectors / (2.0 * kPi * radius_px_));
    }
    return look;
  }

 private:
  static double squared(double x) { return x * x; }

  /// A row, y below the centre, against circles about it on the disc's own plane.
  class RowOfDisc {
   public:
    RowOfDisc(const MarkSums& sums, double y)
        : half_(sums.form_(0, 1) * y / sums.form_(0, 0)),
          rest_(half_ * half_ - sums.form_(1, 1) * y * y / sums.form_(0, 0)),
          per_square_(1.0 / sums.form_(0, 0)),
          middle_(sums.disc_.centre.x() - half_) {}
    /// Columns that lie within a circle of this radius, squared.
    [[nodiscard]] Span within(double radius2, const Span& limits) const {
      const double root2 = rest_ + radius2 * per_square_;
      if (!(root2 >= 0.0)) return {};
      const double root = std::sqrt(root2);
      // Rounds towards zero, which is down for all columns that a picture has.
      const double first = middle_ - root;
      const int down = static_cast<int>(first);
      const Span span{down + (first > down ? 1 : 0), static_cast<int>(middle_ + root) + 1};
      const Span cut = span.within(limits);
      return cut.empty() ? Span{} : cut;
    }

   private:
    double half_, rest_, per_square_, middle_;
  };

  template <typename Level, typename Take>
  void collect(const Row<Level>& row, const Span& span, double y, DiscPixels& pixels,
               const Take& take) const {
    if (span.empty()) return;
    pixels.add(row.from(span.first), span.last - span.first, span.first - disc_.centre.x(), y,
               gray_per_level_, take);
  }

  [[nodiscard]] GrayRange rangeFrom(double least, double most) const {
    return {static_cast<float>(least), static_cast<float>(most), static_cast<float>(levels_.slope.x()),
            static_cast<float>(levels_.slope.y())};
  }
  void takeBoard(const DiscPixels& pixels) {
    const double reach = kBoardWithin * contrast_;
    addMoments(pixels, rangeFrom(levels_.board - reach, levels_.board + reach), board_);
  }
  void takeInk(const DiscPixels& pixels) {
    addMoments(pixels, rangeFrom(0.0, levels_.board - kInkBeyond * contrast_), ink_);
  }
  void takeEdge(const DiscPixels& pixels) {
    const DiscEdge edge{static_cast<float>(levels_.board / contrast_),
                        static_cast<float>(1.0 / contrast_),
                        static_cast<float>(levels_.slope.x()),
                        static_cast<float>(levels_.slope.y()),
                        circle_.cast<float>(),
                        static_cast<float>(radius_px_)};
    addEdge(pixels, edge, check_edge_, edge_);
  }

  /// A plane through the gray of the board: its height at the disc's centre, its slope, and what is left.
  struct BoardPlane {
    double gray{};
    Eigen::Vector2d slope{Eigen::Vector2d::Zero()};  ///< Gray per pixel.
    double noise_gray{};
    double spread_px2{};  ///< Sum of squares of an axis over the board's pixels, the mean of both.
  };
  /// None where no pixel is board.
  [[nodiscard]] std::optional<BoardPlane> boardPlane() const {
    const double n = board_.n.total();
    if (!(n > 0.0)) return std::nullopt;
    const double gray = board_.gray.total();
    const Eigen::Vector2d place = Eigen::Vector2d(board_.x.total(), board_.y.total()) / n;
    Eigen::Matrix2d about_centre;
    about_centre << board_.xx.total(), board_.xy.total(), board_.xy.total(), board_.yy.total();
    const Eigen::Matrix2d spread = about_centre - n * place * place.transpose();
    const Eigen::Vector2d lean = Eigen::Vector2d(board_.x_gray.total(), board_.y_gray.total()) - gray * place;
    BoardPlane plane;
    if (spread.determinant() > 0.0) plane.slope = spread.inverse() * lean;
    plane.gray = gray / n - plane.slope.dot(place);
    const double rest = board_.gray2.total() - gray * gray / n - plane.slope.dot(lean);
    plane.noise_gray = std::sqrt(std::max(0.0, rest) / n);
    plane.spread_px2 = 0.5 * about_centre.trace();
    return plane;
  }

  [[nodiscard]] MarkLevels measuredLevels(const std::optional<BoardPlane>& plane) const {
    MarkLevels levels = levels_;
    const Eigen::Vector2d by_place(ink_.x_gray.total(), ink_.y_gray.total());
    levels.ink = (ink_.gray.total() - levels_.slope.dot(by_place)) / ink_.n.total();
    if (!plane) return levels;
    // A lamp at one side would pull the disc to itself.
    levels.board = plane->gray;
    levels.slope = plane->slope / plane->gray;
    levels.pictures = 1.0;
    return levels;
  }

  /// Standard uncertainty of the centroid per axis, px.
  [[nodiscard]] double noise(const std::optional<BoardPlane>& plane, double weight) const {
    const double by_edge = centroidNoise(edge_.beyond, radius_px_, weight);
    if (!plane) return by_edge;
    // What a gray of noise in each pixel does to the centroid, by the edge and by the light's slope.
    const double by_pixel = std::sqrt(edge_.half_square.total()) / contrast_ / weight;
    const double slope = 1.0 / plane->gray / std::sqrt(plane->spread_px2 * levels_.pictures);
    const double by_slope = slope * edge_.half_square_gray.total() / contrast_ / weight;
    // Grain that makes the edge worse than white noise makes the slope worse, too.
    const double gray = std::max(plane->noise_gray, by_pixel > 0.0 ? by_edge / by_pixel : 0.0);
    return std::hypot(by_edge, by_slope * gray);
  }

  const DiscPlace& disc_;
  const MarkLevels& levels_;
  bool check_edge_;
  bool levels_known_;  ///< Several pictures gave them: half of the rows tell whether they still hold.
  float gray_per_level_;
  double contrast_;
  double radius_px_;
  double inner2_, outer2_, edge_begin2_, edge_end2_;
  Eigen::Matrix2d circle_;  // Turns the ellipse in the picture into a circle.
  Eigen::Matrix2d form_;    // Square of the distance on that circle, as a quadratic form.
  double full_{0.0};        // Pixels of nothing but ink, and the sum of their places.
  Eigen::Vector2d full_moment_{Eigen::Vector2d::Zero()};
  DiscPixels board_pixels_, edge_pixels_, ink_pixels_;
  GrayMoments board_, ink_;
  EdgeSums edge_;
};

/// How many pixels of a row are no brighter than this, and the sum of their places in it. Whole numbers: in
/// any order they are the same.
template <typename Level>
std::pair<double, double> darkIn(const Level* levels, int count, std::uint32_t most) {
  std::uint32_t dark = 0;
  std::uint32_t places = 0;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const std::uint32_t is = levels[i] <= most ? 1U : 0U;
    dark += is;
    places += is * i;
  }
  return {dark, places};
}

/// Calls visit(row, r) for the rows of a box.
template <typename Visit>
void forEachRow(const GrayImage& image, const PixelBox& box, const Visit& visit) {
  for (int r = box.top; r <= box.bottom; ++r) {
    const std::size_t first = image.index(image.left, r);
    if (image.bits == 8) {
      visit(Row<std::uint8_t>{image.pixels.data() + first, image.left}, r);
    } else {
      visit(Row<std::uint16_t>{image.levels.data() + first, image.left}, r);
    }
  }
}

}  // namespace

double DiscPlace::pitch_mm() const { return std::sqrt(std::abs(mm_per_pixel.determinant())); }

std::optional<PixelBox> boxAround(const GrayImage& image, const Eigen::Vector2d& centre, double half_px) {
  const PixelBox box{
      static_cast<int>(std::floor(centre.x() - half_px)), static_cast<int>(std::floor(centre.y() - half_px)),
      static_cast<int>(std::ceil(centre.x() + half_px)), static_cast<int>(std::ceil(centre.y() + half_px))};
  const PixelBox cut{std::max(image.left, box.left), std::max(image.top, box.top),
                     std::min(image.right(), box.right), std::min(image.bottom(), box.bottom)};
  if (cut.left >= cut.right || cut.top >= cut.bottom) return std::nullopt;
  return cut;
}

MarkLevels roughLevels(const GrayImage& image, const PixelBox& box, double disc_share) {
  std::array<int, 256> histogram{};
  int total = 0;
  const int stride = std::max(1, (box.right - box.left) / 48);
  for (int r = box.top; r <= box.bottom; r += stride) {
    for (int c = box.left; c <= box.right; c += stride) {
      ++histogram[image.at(c, r)];
      ++total;
    }
  }
  const auto quantile = [&](double share) {
    int seen = 0;
    for (int i = 0; i < 256; ++i) {
      seen += histogram[static_cast<std::size_t>(i)];
      if (seen > share * total) return static_cast<double>(i);
    }
    return 255.0;
  };
  // Middle of the dark share and middle of the bright share.
  return {quantile(0.5 + 0.5 * disc_share), quantile(0.45 * disc_share)};
}

MarkLook lookAtMark(const GrayImage& image, const PixelBox& box, const DiscPlace& disc,
                    const MarkLevels& levels, bool check_edge) {
  MarkSums sums(disc, levels, check_edge, image.levelsPerGray());
  const Span columns{box.left, box.right + 1};
  forEachRow(image, box, [&](const auto& row, int r) { sums.addRow(row, r, columns); });
  return sums.look();
}

std::optional<Eigen::Vector2d> darkCentroid(const GrayImage& image, const PixelBox& box,
                                            const Eigen::Vector2d& centre, double within_px,
                                            double threshold) {
  double n = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const auto most =
      static_cast<std::uint32_t>(std::max(0.0, std::ceil(threshold * image.levelsPerGray()) - 1.0));
  forEachRow(image, box, [&](const auto& row, int r) {
    const double y = r - centre.y();
    const double root2 = within_px * within_px - y * y;
    if (!(root2 >= 0.0)) return;
    const int first = std::max(box.left, static_cast<int>(std::ceil(centre.x() - std::sqrt(root2))));
    const int last = std::min(box.right, static_cast<int>(std::floor(centre.x() + std::sqrt(root2))));
    if (first > last) return;
    const auto [count, places] = darkIn(row.from(first), last - first + 1, most);
    n += count;
    sum += Eigen::Vector2d(first * count + places, r * count);
  });
  if (n < 4.0) return std::nullopt;
  return sum / n;
}

}  // namespace kerfbench::vision
