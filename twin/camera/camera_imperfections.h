// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

// Imperfections that make a camera's pictures as hard as real ones. Everything is off by default: a
// description without them gives the pictures of a clean camera over plain board.

namespace kerfbench::twin {

/// Pattern of the board as this camera sees it, with its lens. The pattern is fixed to the board: it moves
/// with it and is the same whenever the same place is seen, so frames of one place do not average it away.
/// Correlation falls to 1/e at the given lengths.
struct BoardTexture {
  double grain_gray{};  ///< RMS of paper grain on plain board, grey; [0, 40]. Less on ink, none in a kerf.
  double grain_length_mm{0.15};  ///< [0.01, 10]
  /// Extent of the grain. False: only around print and spot, where anything is measured; plain board
  /// elsewhere. A large frame then costs a hundredth. Spot camera only.
  bool grain_everywhere{true};
  double glow_share{};          ///< RMS of the share by which the board changes the spot's light; [0, 0.5].
  double glow_length_mm{0.15};  ///< [0.01, 10]
};

/// Roughness of a kerf's edge. Depth is read at a place that is displaced by a random field fixed to the
/// board, so its contours are rough by this much (RMS along their normal), each edge independently. Kerf
/// camera only.
struct EdgeRoughness {
  double rms_mm{};         ///< [0, 0.1]
  double length_mm{0.06};  ///< Distance at which the correlation falls to 1/e; [0.01, 10].
};

/// A dim glowing cloud near the spot, blown off by the air. Spot camera only.
struct Plume {
  double share{};  ///< Peak of the cloud over the peak of a spot at rest; [0, 1].
  /// Offset of the cloud's middle from the spot in W; each in [-50, 50].
  Eigen::Vector2d offset_mm{Eigen::Vector2d::Zero()};
  double sigma_mm{0.5};  ///< Standard deviation of the Gaussian cloud; [0.01, 20].
  /// Relative standard deviation of `share` from frame to frame; [0, 2]. The share is never below zero.
  double flicker{};
  double wander_mm{};  ///< Standard deviation of the offset per axis from frame to frame; [0, 20].
};

/// Light that a lens scatters beyond its Gaussian blur. Kerf camera only.
struct BlurFoot {
  double share{};        ///< Share of the light in the foot; [0, 0.5].
  double sigma_px{2.0};  ///< Standard deviation of the foot, in addition to that of the blur; [0.5, 4].
};

/// Illumination that is not the same all over the picture.
struct UnevenLight {
  /// Share lost in the corners, growing as the square of the distance from the middle; [0, 0.9].
  double vignette{};
  /// Change of the lamp's share from the left border to the right; 1 in the middle; |gradient_x| +
  /// |gradient_y| <= 1.
  double gradient_x{};
  double gradient_y{};  ///< Change of the lamp's share from top to bottom; 1 in the middle.
};

/// Pixels that are too bright, the same ones in every picture.
struct HotPixels {
  double share{};         ///< Share of all pixels; [0, 0.01].
  double gray{150.0};     ///< Grey of the brightest; each adds between a quarter of this and all; [0, 255].
  std::uint64_t seed{1};  ///< Seed of the sensor.
};

/// Losses and delays of frames between the sensor and the bench. Spot camera only.
struct FrameLink {
  double drop_share{};  ///< Probability that a frame is lost; [0, 1].
  /// A range of frames by sequence number.
  struct Burst {
    std::uint64_t first{};
    std::uint64_t count{1};
    [[nodiscard]] bool has(std::uint64_t sequence) const {
      return sequence >= first && sequence - first < count;
    }
  };
  std::vector<std::uint64_t> dropped{};  ///< Sequence numbers that are lost whatever the probability.
  std::vector<Burst> lost{};  ///< Ranges of sequence numbers that are lost whatever the probability.
  double stamp_jitter_s{};    ///< Standard deviation of the frames' time stamps; [0, frame_period_s].
  double late_share{};        ///< Probability that a stamp is late by late_s; [0, 1].
  double late_s{};            ///< Delay of a late stamp; [0, 10].
  std::vector<Burst> late{};  ///< Frames whose stamps are late by late_s whatever the probability.
};

}  // namespace kerfbench::twin
