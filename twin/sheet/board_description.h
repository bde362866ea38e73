// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

namespace kerfbench::twin {

/// A point of a material's depth curve (S3: D = f(P_ua), piecewise linear).
struct DepthPoint {
  double fluence_share{};  ///< Fluence, relative to cut_fluence_j_mm2.
  double depth_share{};    ///< Depth, relative to the board's thickness.
};

/// Discolouration of the board near the kerf. Air that blows across carries it to one side.
struct ScorchDescription {
  double fluence_j_mm2{};            ///< Fluence that scorches board fully; 0: no scorch.
  double darkening{0.3};             ///< Share of the light that full scorch absorbs; 0…1.
  std::array<double, 2> shift_mm{};  ///< Displacement of the scorch from the burn: asymmetry; |.| <= 1.
};

/// How much of the back light comes through what is left of a board, whose whole thickness lets T through: a
/// share z of the thickness lets through
enum class LightLaw {
  kBeer,     ///< T^z: it absorbs.
  kScatter,  ///< 1 / (1 + z (1/T - 1)): it scatters without loss (Kubelka and Munk 1931).
  kLinear,   ///< 1 - z (1 - T)
};
/// @pre 0 < transmission <= 1, 0 <= left <= 1
double lightThrough(LightLaw law, double transmission, double left);

/// The board and its reaction to a CO2 beam.
struct BoardDescription {
  double thickness_mm{0.4};  ///< A camera sees that a kerf is a slit with walls; see KerfCamera.
  /// Energy per area (J/mm²), summed over all passes, at which the board is just cut through. For a line of
  /// speed F cut by a spot of diameter d = 2 w at power P, S3's power per area is P_ua = P / (F d), and the
  /// fluence at the line's centre is 2 sqrt(2/pi) P_ua.
  double cut_fluence_j_mm2{0.5};
  /// Depth over fluence, both ascending strictly, the first at depth 0 (its fluence is the threshold), the
  /// last at (1, 1). Empty: the straight line from (0, 0) to (1, 1).
  std::vector<DepthPoint> depth_curve{};
  ScorchDescription scorch{};
  LightLaw light_law{LightLaw::kBeer};
  double transmission{0.12};  ///< Transmission of the back light through uncut board, 0…1.
  /// Transmission of the back light through board under a registration mark.
  double print_transmission{0.02};
};

/// Everything that is wrong with a board, in one line; empty when nothing is.
std::string faultsOf(const BoardDescription& board);

}  // namespace kerfbench::twin
