// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/vision/synthetic.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hil/camera/kerf_tile.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision::test {
namespace {

template <typename T>
std::vector<T> take(std::vector<T>& from, std::size_t& next, std::size_t max) {
  const std::size_t end = std::min(from.size(), next + max);
  std::vector<T> out(std::make_move_iterator(from.begin() + static_cast<std::ptrdiff_t>(next)),
                     std::make_move_iterator(from.begin() + static_cast<std::ptrdiff_t>(end)));
  next = end;
  return out;
}

}  // namespace

CameraCalibration tiltedCamera(int width_px, int height_px, double pitch_mm) {
  constexpr double kDistanceMm = 500.0;
  CameraCalibration c;
  c.width_px = width_px;
  c.height_px = height_px;
  c.fx_px = kDistanceMm / pitch_mm;
  c.fy_px = 1.001 * kDistanceMm / pitch_mm;
  c.cx_px = 0.5 * width_px + 3.2;
  c.cy_px = 0.5 * height_px - 2.7;
  c.distortion = {-0.15, 0.03, 2e-4, -3e-4, 0.0};
  c.X_CP.linear() =
      (Eigen::AngleAxisd(3.14159265358979 + 0.06, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(0.04, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  c.X_CP.translation() = Eigen::Vector3d(0.8, -0.5, kDistanceMm);
  return c;
}

Canvas::Canvas(const CameraCalibration& calibration, double board_gray)
    : calibration_(calibration),
      gray_(static_cast<std::size_t>(calibration.width_px) * static_cast<std::size_t>(calibration.height_px),
            board_gray) {}

void Canvas::disc(const Eigen::Vector2d& p_mm, double diameter_mm, double gray) {
  const double r = 0.5 * diameter_mm;
  const Eigen::AlignedBox2d box(p_mm - Eigen::Vector2d(r, r), p_mm + Eigen::Vector2d(r, r));
  shape(box, gray, [&](const Eigen::Vector2d& q) { return (q - p_mm).squaredNorm() < r * r; });
}

void Canvas::shape(const Eigen::AlignedBox2d& box_mm, double gray,
                   const std::function<bool(const Eigen::Vector2d&)>& inside, int samples) {
  Eigen::AlignedBox2d box_px;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    box_px.extend(calibration_.pixelFromPlane(box_mm.corner(corner)));
  }
  const int left = std::max(0, static_cast<int>(box_px.min().x()) - 2);
  const int right = std::min(calibration_.width_px - 1, static_cast<int>(box_px.max().x()) + 2);
  const int top = std::max(0, static_cast<int>(box_px.min().y()) - 2);
  const int bottom = std::min(calibration_.height_px - 1, static_cast<int>(box_px.max().y()) + 2);
  for (int r = top; r <= bottom; ++r) {
    for (int c = left; c <= right; ++c) {
      int hits = 0;
      for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
          const Eigen::Vector2d sub((i + 0.5) / samples - 0.5, (j + 0.5) / samples - 0.5);
          hits += inside(calibration_.planeFromPixel(Eigen::Vector2d(c, r) + sub)) ? 1 : 0;
        }
      }
      const double share = static_cast<double>(hits) / (samples * samples);
      at(c, r) += share * (gray - at(c, r));
    }
  }
}

void Canvas::blur(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma_px));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
    sum += kernel.back();
  }
  const int w = calibration_.width_px;
  const int h = calibration_.height_px;
  std::vector<double> across(gray_.size());
  const auto index = [&](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(w) + static_cast<std::size_t>(c);
  };
  for (int r = 0; r < h; ++r) {
    for (int c = 0; c < w; ++c) {
      double v = 0.0;
      for (int i = -reach; i <= reach; ++i) {
        v += kernel[static_cast<std::size_t>(i + reach)] * gray_[index(std::clamp(c + i, 0, w - 1), r)];
      }
      across[index(c, r)] = v / sum;
    }
  }
  for (int r = 0; r < h; ++r) {
    for (int c = 0; c < w; ++c) {
      double v = 0.0;
      for (int i = -reach; i <= reach; ++i) {
        v += kernel[static_cast<std::size_t>(i + reach)] * across[index(c, std::clamp(r + i, 0, h - 1))];
      }
      gray_[index(c, r)] = v / sum;
    }
  }
}

void Canvas::spot(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm, double sigma_mm,
                  double height_gray, double blur_px) {
  const double scale_px = 1.0 / calibration_.pitchMm();
  const double sigma_px = std::hypot(sigma_mm * scale_px, blur_px);
  const int steps = std::max(1, static_cast<int>(std::ceil((to_mm - from_mm).norm() * scale_px * 4.0)));
  const double height = height_gray / steps;
  for (int s = 0; s < steps; ++s) {
    const Eigen::Vector2d p = calibration_.pixelFromPlane(from_mm + (to_mm - from_mm) * ((s + 0.5) / steps));
    const int reach = static_cast<int>(std::ceil(5.0 * sigma_px)) + 1;
    const int column = static_cast<int>(std::lround(p.x()));
    const int row = static_cast<int>(std::lround(p.y()));
    constexpr int kSub = 4;
    for (int r = std::max(0, row - reach); r <= std::min(calibration_.height_px - 1, row + reach); ++r) {
      for (int c = std::max(0, column - reach); c <= std::min(calibration_.width_px - 1, column + reach);
           ++c) {
        double light = 0.0;
        for (int j = 0; j < kSub; ++j) {
          for (int i = 0; i < kSub; ++i) {
            const Eigen::Vector2d q(c + (i + 0.5) / kSub - 0.5, r + (j + 0.5) / kSub - 0.5);
            light += std::exp(-0.5 * (q - p).squaredNorm() / (sigma_px * sigma_px));
          }
        }
        at(c, r) += height * light / (kSub * kSub);
      }
    }
  }
}

void Canvas::pixel(int column, int row, double gray) { at(column, row) = gray; }

GrayImage Canvas::expose(std::uint64_t seed, std::uint64_t sequence) const {
  GrayImage image(calibration_.width_px, calibration_.height_px);
  const CounterRandom random(seed, sequence);
  constexpr double kElectronsPerGray = 10000.0 / 255.0;
  for (std::size_t i = 0; i < gray_.size(); ++i) {
    const double sigma = std::sqrt(std::max(0.0, gray_[i]) / kElectronsPerGray + 0.8 * 0.8);
    const double value = gray_[i] + sigma * random.normal(i);
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
  return image;
}

std::vector<Frame> ReadyFrames::nextBatch(std::size_t max) { return take(frames_, next_, max); }
std::vector<camera::KerfTile> ReadyTiles::nextBatch(std::size_t max) { return take(tiles_, next_, max); }

Statistics statisticsOf(std::span<const double> values) {
  Statistics s;
  for (const double v : values) s.mean += v / static_cast<double>(values.size());
  for (const double v : values) s.sigma += (v - s.mean) * (v - s.mean) / static_cast<double>(values.size());
  s.sigma = std::sqrt(s.sigma);
  return s;
}

}  // namespace kerfbench::vision::test
