// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::hil {

/// The way of a beam near a point where it ends or turns, from afar along tangent_in to the origin, and on
/// along tangent_out if it goes on.
struct BeamWay {
  Eigen::Vector2d tangent_in{Eigen::Vector2d::UnitX()};
  std::optional<Eigen::Vector2d> tangent_out{};
  /// > 0: both legs run over the corner by this much. < 0: an arc cuts the corner, this far inside of it.
  double beyond_mm{};
};

/// How a kerf looks in the picture.
struct KerfLook {
  double half_width_mm{};  ///< At half height, as seen.
  double brightness{1.0};  ///< Of its middle.
  double board_gray{};
  double open_gray{};
  double beam_radius_mm{};  ///< 1/e²; 0: a round tool as wide as the kerf.
  double pixel_mm{};
};

/// Where the edge of a kerf is seen whose beam did exactly what a way says: how far the outline reaches
/// beyond where the beam stopped or turned.
///
/// A Gaussian beam of radius w lays along a straight way, s0 being the share of the cutting fluence in the
/// middle of it, s0 exp(-2 n²/w²) erfc(sqrt(2) a/w) / 2 at n beside and a beyond its end, and
/// s0 sqrt(2/pi)/w exp(-2 d²/w²) per length at a distance d. Light by Beer's law, as in FlankModel; then the
/// blur of lens and spline. s0 is what makes the kerf as wide as it is seen.
class KerfOutline {
 public:
  explicit KerfOutline(const KerfLook& look);

  /// Mean reach along `direction` from the origin over a strip of half width `strip_mm`.
  [[nodiscard]] double reachMm(const Eigen::Vector2d& direction, double strip_mm, const BeamWay& way) const;

 private:
  struct Element {
    Eigen::Vector2d p_mm;
    double length_mm;
  };
  /// The legs' ends and the arc between them.
  struct Path {
    Eigen::Vector2d end_in, start_out;
    std::vector<Element> arc;
  };
  [[nodiscard]] Path pathOf(const BeamWay& way) const;
  [[nodiscard]] double shareAt(const Eigen::Vector2d& p_mm, const BeamWay& way, const Path& path) const;
  [[nodiscard]] int samplesOfLook() const;
  [[nodiscard]] double grayAt(double share) const;
  /// Of the middle of a straight kerf.
  [[nodiscard]] double seenTop(double peak) const;
  /// Of a profile that falls outwards, blurred: where it crosses half way.
  [[nodiscard]] double fallMm(const std::vector<double>& gray, double first_mm) const;

  KerfLook look_;
  double step_mm_;
  double peak_share_{1.0};
};

}  // namespace kerfbench::hil
