// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/scanner/scan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "hil/calibrate/scanner/scan_discs.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr double kSameSize = 0.25;     // Share by which a disc may be larger or smaller than drawn.
constexpr double kFarthestSize = 6.0;  // Size, over the one drawn, of discs that tell another resolution.
constexpr double kBorder_mm = 4.0;
constexpr double kLeastContrast = 40.0;
constexpr double kBoardGray = 60.0, kInkGray = 15.0;
constexpr int kCell_px = 16;  // The map is so smooth that it is evaluated at so few places.
constexpr double kDiscEdge_px = 6.0;
constexpr double kUpright_mm = 1.0;

double medianRadius(std::vector<ScanDisc> discs) {
  std::ranges::sort(discs, {}, &ScanDisc::radius_px);
  return discs[discs.size() / 2].radius_px;
}

std::vector<ScanDisc> printedDiscs(const GrayImage& scan, const ScannerMap& map,
                                   const std::vector<RegistrationMark>& print) {
  const double wanted_px = 0.5 * print.front().diameter_mm / map.pitchMm();
  const std::vector<ScanDisc> round =
      findScanDiscs(scan, wanted_px / kFarthestSize, wanted_px * kFarthestSize);
  std::vector<ScanDisc> discs;
  std::ranges::copy_if(round, std::back_inserter(discs), [&](const ScanDisc& disc) {
    return std::abs(disc.radius_px / wanted_px - 1.0) <= kSameSize;
  });
  if (discs.size() == print.size()) return discs;
  std::vector<ScanDisc> others;
  if (!round.empty()) {
    const double largest = std::ranges::max_element(round, {}, &ScanDisc::radius_px)->radius_px;
    std::ranges::copy_if(round, std::back_inserter(others),
                         [&](const ScanDisc& disc) { return disc.radius_px > (1.0 - kSameSize) * largest; });
  }
  if (discs.empty() && others.size() >= 2) {
    const double dpi = kMmPerInch / map.pitchMm();
    throw ScanError(fmt::format("by its printed marks the scan has about {:.0f} dpi, not {:.0f}",
                                dpi * medianRadius(others) / wanted_px, dpi));
  }
  if (discs.size() > print.size()) {
    throw ScanError(
        fmt::format("{} places look like printed marks, the board has {}: cover what is not of the sheet",
                    discs.size(), print.size()));
  }
  throw ScanError(fmt::format("{} of {} printed marks are there: another sheet, or not all of it was scanned",
                              discs.size(), print.size()));
}

/// Middle of the box around some places.
template <typename Places, typename Of>
Vector2d middleOf(const Places& places, Of of) {
  Eigen::AlignedBox2d box;
  for (const auto& place : places) box.extend(of(place));
  return box.center();
}

/// A sheet that lies a quarter turn or two aside fits its print better so than as it should lie.
void requireUpright(const std::vector<ScanDisc>& discs, const ScannerMap& map,
                    const std::vector<RegistrationMark>& print) {
  const auto onGlass = [&](const ScanDisc& disc) { return map.glassFromPixel(disc.pixel); };
  const Vector2d seen_middle = middleOf(discs, onGlass),
                 print_middle = middleOf(print, [](const RegistrationMark&mark) { return mark.p_SM_mm; });
  std::array<double, 4> off{};
  for (std::size_t quarter = 0; quarter < off.size(); ++quarter) {
    const Eigen::Rotation2Dd turn(0.5 * std::numbers::pi * static_cast<double>(quarter));
    for (const ScanDisc& disc : discs) {
      const Vector2d p = print_middle + turn.inverse() * (onGlass(disc) - seen_middle);
      double nearest = std::numeric_limits<double>::infinity();
      for (const RegistrationMark& mark : print) nearest = std::min(nearest, (mark.p_SM_mm - p).norm());
      off[quarter] += nearest / static_cast<double>(discs.size());
    }
  }
  const auto best = static_cast<std::size_t>(std::distance(off.begin(), std::ranges::min_element(off)));
  if (best == 0 || off[best] > kUpright_mm) return;
  constexpr std::array kWays{"", "by a quarter turn to the left", "upside down",
                             "by a quarter turn to the right"};
  throw ScanError(fmt::format(
      "the sheet lies {} on the glass: lay it face down with its +x along the sensor bar", kWays.at(best)));
}

/// Greys of a scan as those of a back-lit picture.
class BackLight {
 public:
  BackLight(const GrayImage& scan, const std::vector<ScanDisc>& discs, ScanLid lid)
      : levels_(levelsAt(scan, discs)), lid_(lid) {
    if (levels_.board - levels_.ink < kLeastContrast) {
      throw ScanError(
          fmt::format("the printed marks are {:.0f} grey levels darker than the board; it takes {:.0f}",
                      levels_.board - levels_.ink, kLeastContrast));
    }
  }
  [[nodiscard]] double of(double gray, bool in_print) const {
    const double dark = (levels_.board - gray) / (levels_.board - levels_.ink);
    const double print = kBoardGray - (kBoardGray - kInkGray) * dark;
    if (in_print) return print;
    if (lid_ == ScanLid::kBlack) return kBoardGray + (kScanOpenGray - kBoardGray) * dark;
    const double light = (gray - levels_.board) / (kWhite - levels_.board);
    return dark > 0.0 ? print : kBoardGray + (kScanOpenGray - kBoardGray) * light;
  }

 private:
  static constexpr double kWhite = 245.0;  // A scanner sets its white lid near the top of its scale.
  ScanLevels levels_;
  ScanLid lid_;
};

/// Keys' cubic convolution, a = -1/2.
std::array<double, 4> cubicWeights(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (-3.0 * t3 + 4.0 * t2 + t),
          0.5 * (t3 - t2)};
}

double grayAt(const GrayImage& scan, const Vector2d& pixel) {
  const int column = static_cast<int>(std::floor(pixel.x())), row = static_cast<int>(std::floor(pixel.y()));
  const auto along = cubicWeights(pixel.x() - column), down = cubicWeights(pixel.y() - row);
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    const int r = std::clamp(row - 1 + j, 0, scan.height - 1);
    double line = 0.0;
    for (int i = 0; i < 4; ++i)
      line += along[static_cast<std::size_t>(i)] * scan.at(std::clamp(column - 1 + i, 0, scan.width - 1), r);
    sum += down[static_cast<std::size_t>(j)] * line;
  }
  return sum;
}

/// The straightened picture: its pixels on the glass.
struct Canvas {
  Vector2d corner_G_mm;  ///< Place of the first pixel's centre, upper left.
  double pitch_mm;
  int width, height;
  [[nodiscard]] Vector2d onGlass(double column, double row) const {
    return corner_G_mm + pitch_mm * Vector2d(column, -row);
  }
};

Canvas canvasOf(const std::vector<ScanDisc>& discs, const ScannerMap& map) {
  Eigen::AlignedBox2d box;
  for (const ScanDisc& disc : discs) box.extend(map.glassFromPixel(disc.pixel));
  const double pitch_mm = map.pitchMm();
  const Vector2d border = Vector2d::Constant(kBorder_mm + discs.front().radius_px * pitch_mm);
  box = {box.min() - border, box.max() + border};
  return {{box.min().x(), box.max().y()},
          pitch_mm,
          static_cast<int>(std::ceil(box.sizes().x() / pitch_mm)),
          static_cast<int>(std::ceil(box.sizes().y() / pitch_mm))};
}

/// @param shift_mm from the glass to the plane of the pictures.
vision::CameraCalibration cameraOf(const Canvas& canvas, const Vector2d& shift_mm) {
  vision::CameraCalibration camera;
  camera.width_px = canvas.width;
  camera.height_px = canvas.height;
  camera.telecentric_mm = canvas.pitch_mm * canvas.width;
  camera.fx_px = camera.fy_px = camera.telecentric_mm / canvas.pitch_mm;
  camera.cx_px = 0.5 * (canvas.width - 1);
  camera.cy_px = 0.5 * (canvas.height - 1);
  const Vector2d middle = canvas.onGlass(camera.cx_px, camera.cy_px) + shift_mm;
  camera.X_CP.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  camera.X_CP.translation() = Eigen::Vector3d(-middle.x(), middle.y(), camera.telecentric_mm);
  camera.area_mm = {canvas.onGlass(0, canvas.height - 1) + shift_mm,
                    canvas.onGlass(canvas.width - 1, 0) + shift_mm};
  return camera;
}

}  // namespace

StraightScan straightened(const GrayImage& scan, const ScannerMap& map, ScanLid lid,
                          const std::vector<RegistrationMark>& print) {
  const std::vector<ScanDisc> discs = printedDiscs(scan, map, print);
  const BackLight light(scan, discs, lid);
  const Canvas canvas = canvasOf(discs, map);
  requireUpright(discs, map, print);
  // The sheet lies on the plane of the pictures as it lies on its own.
  const Vector2d shift_mm =
      middleOf(print, [](const RegistrationMark& mark) { return mark.p_SM_mm; }) -
      middleOf(discs, [&](const ScanDisc& disc) { return map.glassFromPixel(disc.pixel); });
  StraightScan straight{GrayImage(canvas.width, canvas.height), cameraOf(canvas, shift_mm)};
  const auto inPrint = [&](const Vector2d& pixel) {
    return std::ranges::any_of(discs, [&](const ScanDisc& disc) {
      return (disc.pixel - pixel).squaredNorm() < std::pow(disc.radius_px + kDiscEdge_px, 2);
    });
  };
  for (int row0 = 0; row0 < canvas.height; row0 += kCell_px) {
    for (int column0 = 0; column0 < canvas.width; column0 += kCell_px) {
      const auto source = [&](int i, int j) {
        return map.pixelFromGlass(canvas.onGlass(column0 + i * kCell_px, row0 + j * kCell_px));
      };
      const Vector2d p00 = source(0, 0), p10 = source(1, 0), p01 = source(0, 1), p11 = source(1, 1);
      const bool near_print = inPrint(p00) || inPrint(p10) || inPrint(p01) || inPrint(p11);
      for (int row = row0; row < std::min(row0 + kCell_px, canvas.height); ++row) {
        for (int column = column0; column < std::min(column0 + kCell_px, canvas.width); ++column) {
          const double s = static_cast<double>(column - column0) / kCell_px,
                       t = static_cast<double>(row - row0) / kCell_px;
          const Vector2d pixel = (1.0 - t) * ((1.0 - s) * p00 + s * p10) + t * ((1.0 - s) * p01 + s * p11);
          const double gray = light.of(grayAt(scan, pixel), near_print && inPrint(pixel));
          straight.image.at(column, row) =
              static_cast<std::uint8_t>(std::lround(std::clamp(gray, 0.0, 255.0)));
        }
      }
    }
  }
  return straight;
}

}  // namespace kerfbench::calibrate
