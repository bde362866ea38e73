// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

// What makes a camera's pictures as hard as real ones. Everything is off by default: a description without
// them gives the pictures of a clean camera over plain board.

namespace kerfbench::twin {

/// The pattern of the board as this camera sees it, its lens included. Fixed to the board: it moves with it
/// and is the same whenever the same place is looked at, so frames of one place do not average it away.
/// Correlation falls to 1/e at the lengths given.
struct BoardTexture {
  double grain_gray{};  ///< RMS of paper grain on plain board, grey; [0, 40]. Less on ink, none in a kerf.
  double grain_length_mm{0.15};  ///< [0.01, 10]
  /// False: grain only around print and spot, where anything is measured; plain board elsewhere. A large
  /// frame costs a hundredth then. Spot camera only.
  bool grain_everywhere{true};
  double glow_share{};          ///< RMS of the share by which the board changes the spot's light; [0, 0.5].
  double glow_length_mm{0.15};  ///< [0.01, 10]
};

/// A kerf's edge: where depth is read is displaced by a random field fixed to the board, so its contours are
/// rough by this much (RMS along their normal), each edge for itself. Kerf camera only.
struct EdgeRoughness {
  double rms_mm{};         ///< [0, 0.1]
  double length_mm{0.06};  ///< Correlation falls to 1/e there; [0.01, 10].
};

/// A cloud that glows dimly beside the spot, blown off by the air. Spot camera only.
struct Plume {
  double share{};  ///< Its peak over the spot's that rests; [0, 1].
  Eigen::Vector2d offset_mm{
      Eigen::Vector2d::Zero()};  ///< Offset of its middle from the spot in W; each in [-50, 50].
  double sigma_mm{0.5};          ///< Standard deviation of the Gaussian cloud; [0.01, 20].
  double
      flicker{};  ///< Relative standard deviation of `share` from frame to frame; [0, 2]. Never below zero.
  double wander_mm{};  ///< Standard deviation of the offset per axis from frame to frame; [0, 20].
};

/// Light that is not the same all over the picture.
struct UnevenLight {
  double vignette{};  ///< Share lost in the corners, as the square of the distance from the middle; [0, 0.9].
  double gradient_x{};  ///< The lamp's share from the left border to the right, about 1 in the middle …
  double gradient_y{};  ///< … and from top to bottom; |x| + |y| <= 1.
};

/// Pixels that are too bright, the same ones in every picture.
struct HotPixels {
  double share{};         ///< Share of all pixels; [0, 0.01].
  double gray{150.0};     ///< The brightest of them; each adds between a quarter of this and all; [0, 255].
  std::uint64_t seed{1};  ///< Which sensor it is.
};

/// What the way from the sensor to the bench does to frames. Spot camera only.
struct FrameLink {
  double drop_share{};  ///< Probability that a frame is lost; [0, 1].
  /// Frames by their sequence numbers.
  struct Burst {
    std::uint64_t first{};
    std::uint64_t count{1};
    [[nodiscard]] bool has(std::uint64_t sequence) const {
      return sequence >= first && sequence - first < count;
    }
  };
  std::vector<std::uint64_t> dropped{};  ///< Sequence numbers that are lost whatever the probability …
  std::vector<Burst> lost{};             ///< … and others.
  double stamp_jitter_s{};    ///< Standard deviation of the frames' time stamps; [0, frame_period_s].
  double late_share{};        ///< Probability that a stamp is late …
  double late_s{};            ///< … by this much; [0, 10].
  std::vector<Burst> late{};  ///< Stamps that are late by late_s whatever the probability.
};

}  // namespace kerfbench::twin
