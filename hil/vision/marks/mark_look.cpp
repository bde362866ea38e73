// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "hil/vision/marks/row_sums.h"
#include "twin/base/constants.h"
#include "twin/base/image.h"
#include "twin/base/multiversion.h"
#include "twin/base/wide_math.h"

namespace kerfbench::vision {
namespace {

constexpr double kInnerRim = 0.75;  // Share of the radius within which all is ink.
constexpr double kEdgeSigmaPx = 0.7;
constexpr int kSectors = 12;
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

/// A piece of a row that crosses the edge of a disc.
struct EdgePiece {
  static constexpr int kMost = 64;
  static constexpr float kLeastShare = -0.15F;
  static constexpr float kMostShare = 1.15F;
  static constexpr float kSteps =
      65536.0F;  // Shares of ink are summed in whole steps: exactly, in any order.
  static constexpr std::int32_t kCoarse = 64;

  int count;
  float x, y;  ///< First pixel from the disc's centre.
  std::array<float, kMost> level;
  std::array<float, kMost> share;          ///< Share of ink.
  std::array<float, kMost> beyond;         ///< More than a round disc has there.
  std::array<std::int32_t, kMost> sector;  ///< Counted as atan2 goes, from -x.
  std::int32_t sum, by_place, by_square;   ///< Sums of steps; the last of coarse ones, kCoarse steps each.
};

/// How a level becomes a share of ink.
struct InkScale {
  float board, per_level, slope_x, slope_y;
};

KERFBENCH_WIDE void weigh(const InkScale& scale, EdgePiece& piece) {
  const float at_first = scale.slope_x * piece.x + scale.slope_y * piece.y;
  std::int32_t sum = 0;
  std::int32_t by_place = 0;
  std::int32_t by_square = 0;
  for (int k = 0; k < piece.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const float light = at_first + scale.slope_x * static_cast<float>(k);
    const float dark = scale.board - scale.per_level * piece.level[i] / (1.0F + light);
    const float least = dark > EdgePiece::kLeastShare ? dark : EdgePiece::kLeastShare;
    const float share = least < EdgePiece::kMostShare ? least : EdgePiece::kMostShare;
    piece.share[i] = share;
    const auto steps = static_cast<std::int32_t>((share - EdgePiece::kLeastShare) * EdgePiece::kSteps);
    sum += steps;
    by_place += steps * k;
    by_square += steps / EdgePiece::kCoarse * (k * k);
  }
  piece.sum = sum;
  piece.by_place = by_place;
  piece.by_square = by_square;
}

/// Compares a piece with the edge of a round disc, blurred as a straight one is.
KERFBENCH_WIDE void compare(const Eigen::Matrix2f& circle, float radius_px, EdgePiece& piece) {
  static_assert(kSectors == 12);
  constexpr float kTan30 = std::numbers::inv_sqrt3_v<float>;
  constexpr float kTan60 = std::numbers::sqrt3_v<float>;
  constexpr auto kPerPx = static_cast<float>(1.0 / (kEdgeSigmaPx * std::numbers::sqrt2));
  const float xx = circle(0, 0);
  const float xy = circle(0, 1);
  const float yx = circle(1, 0);
  const float yy = circle(1, 1);
  for (int k = 0; k < piece.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const float x = piece.x + static_cast<float>(k);
    const float right = xx * x + xy * piece.y;
    const float down = yx * x + yy * piece.y;
    const float outside = std::sqrt(right * right + down * down) - radius_px;
    piece.beyond[i] = piece.share[i] - 0.5F * wideErfc(kPerPx * outside);
    const float a = right < 0.0F ? -right : right;
    const float b = down < 0.0F ? -down : down;
    const std::int32_t third = (b >= kTan30 * a ? 1 : 0) + (b >= kTan60 * a ? 1 : 0);
    const std::int32_t above = right < 0.0F ? third : 5 - third;
    const std::int32_t below = right < 0.0F ? 11 - third : 6 + third;
    piece.sector[i] = down < 0.0F ? above : below;
  }
}

/// A row's levels by their columns in the picture.
template <typename Level>
struct Row {
  const Level* first;
  int left;
  [[nodiscard]] const Level* from(int column) const { return first + (column - left); }
};

/// Sums over the pixels of one look at a printed disc, row by row. Where a pixel is all ink or all board
/// there is nothing to weigh: of these the levels are summed, and only those of the edge are taken one by
/// one. The light's slope is small over a disc: 1 / (1 + slope) is taken for 1 - slope where it counts for
/// levels.
class MarkSums {
 public:
  MarkSums(const DiscPlace& disc, const MarkLevels& levels, bool check_edge, double levels_per_gray)
      : disc_(disc),
        levels_(levels),
        check_edge_(check_edge),
        levels_per_gray_(levels_per_gray),
        contrast_(levels.board - levels.ink),
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
    for (const Span& board : around(look, disc)) addBoard(row, board, y);
    for (const Span& edge : around(disc, full)) addEdge(row, edge, y);
    const double n = std::max(0, full.last - full.first);
    weight_ += n;
    moment_ += n * Eigen::Vector2d(0.5 * (full.first + full.last - 1) - disc_.centre.x(), y);
    addInk(row, circles.within(inner2_, look), y);
  }

  [[nodiscard]] MarkLook look() const {
    MarkLook look{};
    if (!(ink_.n > 0.0) || !(outer_ > 0.0) || !(weight_ > 1.0)) {
      look.stained_share = 1.0;
      return look;
    }
    look.centroid = disc_.centre + moment_ / weight_;
    look.area_px = weight_;
    look.levels = measuredLevels();
    look.stained_share = stained_ / ink_.n;
    look.darkened_share = darkened_ / outer_;
    look.board_share = board_.n / outer_;
    if (check_edge_) look.sigma_px = noise(look.levels.board);
    double mean = 0.0;
    for (const double s : sector_) mean += s / kSectors;
    for (const double s : sector_) {
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

  /// Levels of a gray that the light's slope has changed as it does in the middle of a span.
  [[nodiscard]] double levelOf(double gray, const Span& span, double y) const {
    const Eigen::Vector2d from(0.5 * (span.first + span.last - 1) - disc_.centre.x(), y);
    return gray * (1.0 + levels_.slope.dot(from)) * levels_per_gray_;
  }
  static std::uint32_t bound(double level) {
    return static_cast<std::uint32_t>(std::clamp(level, 0.0, 65535.0));
  }

  template <typename Level>
  void addBoard(const Row<Level>& row, const Span& span, double y) {
    if (span.empty()) return;
    const double dark = levelOf(levels_.board - kBoardWithin * contrast_, span, y);
    const double bright = levelOf(levels_.board + kBoardWithin * contrast_, span, y);
    const int count = span.last - span.first;
    outer_ += count;
    for (int k = 0; k < count; ++k) darkened_ += row.from(span.first)[k] < dark ? 1.0 : 0.0;
    board_.add(sumRow(row.from(span.first), count, bound(std::ceil(dark)), bound(std::floor(bright))),
               span.first - disc_.centre.x(), y, 1.0 / levels_per_gray_);
  }

  template <typename Level>
  void addInk(const Row<Level>& row, const Span& span, double y) {
    if (span.empty()) return;
    const double bright = levelOf(levels_.board - kInkBeyond * contrast_, span, y);
    for (int c = span.first; c < span.last; ++c) stained_ += *row.from(c) > bright ? 1.0 : 0.0;
    ink_.add(sumRow(row.from(span.first), span.last - span.first, 0, 65535), span.first - disc_.centre.x(), y,
             1.0 / levels_per_gray_);
  }

  /// Weighs the pixels of the edge by their share of ink.
  template <typename Level>
  void addEdge(const Row<Level>& row, const Span& span, double y) {
    const InkScale scale{static_cast<float>(levels_.board / contrast_),
                         static_cast<float>(1.0 / (levels_per_gray_ * contrast_)),
                         static_cast<float>(levels_.slope.x()), static_cast<float>(levels_.slope.y())};
    EdgePiece piece;
    for (int begin = span.first; begin < span.last; begin += EdgePiece::kMost) {
      piece.count = std::min(EdgePiece::kMost, span.last - begin);
      const double x = begin - disc_.centre.x();
      piece.x = static_cast<float>(x);
      piece.y = static_cast<float>(y);
      std::copy_n(row.from(begin), piece.count, piece.level.begin());
      weigh(scale, piece);
      // Cut off, a step is half of one too small.
      constexpr double kOffset = EdgePiece::kLeastShare + 0.5 / EdgePiece::kSteps;
      const auto n = static_cast<double>(piece.count);
      const double places = 0.5 * n * (n - 1.0);
      const double weight = piece.sum / double{EdgePiece::kSteps} + n * kOffset;
      const double by_place = piece.by_place / double{EdgePiece::kSteps} + places * kOffset;
      weight_ += weight;
      moment_ += Eigen::Vector2d(weight * x + by_place, weight * y);
      if (!check_edge_) continue;
      compare(circle_.cast<float>(), static_cast<float>(radius_px_), piece);
      for (std::size_t k = 0; k < static_cast<std::size_t>(piece.count); ++k)
        sector_[static_cast<std::size_t>(piece.sector[k])] += piece.beyond[k];
      const double squares = places * (2.0 * n - 1.0) / 3.0;
      const double by_square =
          piece.by_square * (EdgePiece::kCoarse / double{EdgePiece::kSteps}) + squares * kOffset;
      const double spread = 0.5 * (n * (x * x + y * y) + 2.0 * x * places + squares);
      edge_spread_ += spread;
      edge_spread_light_ += levels_.board * spread -
                            contrast_ * 0.5 * (weight * (x * x + y * y) + 2.0 * x * by_place + by_square);
    }
  }

  /// A plane through the gray of the board: its height at the disc's centre, its slope, and what is left.
  struct BoardPlane {
    double gray{};
    Eigen::Vector2d slope{Eigen::Vector2d::Zero()};  ///< Gray per pixel.
    double noise_gray{};
  };
  [[nodiscard]] BoardPlane boardPlane() const {
    const double mean = board_.gray / board_.n;
    const Eigen::Vector2d place = board_.place / board_.n;
    const Eigen::Matrix2d spread = board_.spread - board_.n * place * place.transpose();
    const Eigen::Vector2d lean = board_.gray_place - board_.gray * place;
    BoardPlane plane{mean, {}, 0.0};
    plane.slope.setZero();
    if (spread.determinant() > 0.0) plane.slope = spread.inverse() * lean;
    plane.gray -= plane.slope.dot(place);
    const double rest = board_.gray2 - mean * board_.gray - plane.slope.dot(lean);
    plane.noise_gray = std::sqrt(std::max(0.0, rest) / board_.n);
    return plane;
  }

  [[nodiscard]] MarkLevels measuredLevels() const {
    MarkLevels levels = levels_;
    levels.ink = (ink_.gray - levels_.slope.dot(ink_.gray_place)) / ink_.n;
    if (!(board_.n > 0.0)) return levels;
    // A lamp at one side would pull the disc to itself.
    const BoardPlane plane = boardPlane();
    levels.board = plane.gray;
    levels.slope = plane.slope / plane.gray;
    return levels;
  }

  /// Standard uncertainty of the centroid per axis, px.
  [[nodiscard]] double noise(double board_gray) const {
    const double by_edge = centroidNoise(sector_, radius_px_, weight_);
    if (!(board_.n > 0.0)) return by_edge;
    // What a gray of noise in each pixel does to the centroid, by the edge and by the light's slope.
    const double by_pixel = std::sqrt(edge_spread_) / contrast_ / weight_;
    const double slope = 1.0 / board_gray / std::sqrt(0.5 * board_.spread.trace());
    const double by_slope = slope * edge_spread_light_ / contrast_ / weight_;
    // Grain that makes the edge worse than white noise makes the slope worse, too.
    const double gray = std::max(boardPlane().noise_gray, by_pixel > 0.0 ? by_edge / by_pixel : 0.0);
    return std::hypot(by_edge, by_slope * gray);
  }

  const DiscPlace& disc_;
  const MarkLevels& levels_;
  bool check_edge_;
  double levels_per_gray_;
  double contrast_;
  double radius_px_;
  double inner2_, outer2_, edge_begin2_, edge_end2_;
  Eigen::Matrix2d circle_;  // Turns the ellipse in the picture into a circle.
  Eigen::Matrix2d form_;    // Square of the distance on that circle, as a quadratic form.
  double weight_{0.0};
  Eigen::Vector2d moment_{Eigen::Vector2d::Zero()};
  std::array<double, kSectors> sector_{};
  Moments ink_, board_;
  double stained_{0.0}, outer_{0.0}, darkened_{0.0};
  double edge_spread_{0.0};        // Sum of squares of an axis over the edge.
  double edge_spread_light_{0.0};  // Sum of squares of an axis over the edge, weighted by grey.
};

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
    const RowSums dark = sumRow(row.from(first), last - first + 1, 0, most);
    n += dark.n;
    sum += Eigen::Vector2d(first * dark.n + dark.k, r * dark.n);
  });
  if (n < 4.0) return std::nullopt;
  return sum / n;
}

}  // namespace kerfbench::vision
