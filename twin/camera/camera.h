// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/base/print_layout.h"
#include "twin/base/read_out.h"
#include "twin/camera/camera_imperfections.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// A printed mark under the spot camera's light; no description changes it.
inline constexpr double kMarkGray = 25.0;
/// The back light through an open kerf, as a kerf camera is set up: 92 % of the scale.
inline constexpr double kOpenKerfGray = 235.0;

/// A camera of the model: lens with distortion (k1 k2 p1 p2 k3), blur and noise. X_CP is the pose in the
/// camera of the plane it looks at: work plane W for the spot camera, for the kerf camera the plane of the
/// sheet's printed face on the inspection table. z of the camera points at the plane.
struct CameraDescription {
  int width_px{};
  int height_px{};
  double fx_px{}, fy_px{}, cx_px{}, cy_px{};
  std::array<double, 5> distortion{};
  /// 0: entocentric, a pinhole. Else telecentric: all rays run along the camera's z, and the scale is that of
  /// a pinhole at this distance, fx_px / telecentric_mm pixels per mm.
  double telecentric_mm{};
  Eigen::Isometry3d X_CP{Eigen::Isometry3d::Identity()};
  int bits{8};  ///< Depth of the pictures: 8, 10 or 12. Grey is always of the 8-bit scale.
  /// Standard deviation of the whole blur, the pixel's own area (0.29) included; >= 0.
  double psf_sigma_px{0.6};
  BlurFoot foot{};
  double read_noise{0.8};             ///< Standard deviation, grey levels.
  double full_well_electrons{10000};  ///< Electrons at grey level 255; sets the shot noise. Infinity: none.
  double board_gray{110};             ///< Board under this camera's light; spot camera only.
  double open_gray{kOpenKerfGray};    ///< The back light through an open kerf; kerf camera only; (0, 255].
  /// Half angle at which the back light is half as bright as straight up; 0: it shines evenly in all
  /// directions. Kerf camera only.
  double back_light_half_angle_rad{0.0};
  double frame_period_s{0.001};  ///< Time between exposures; spot camera only.
  double exposure_s{50e-6};      ///< Exposure time; spot camera only; in (0, frame_period_s].
  ReadOut read_out{};            ///< Spot camera only.

  /// Seed of the piece of board in view: texture and roughness. Pictures with another camera seed, but of the
  /// same board, differ in noise alone.
  std::uint64_t board_seed{1};
  BoardTexture texture{};
  EdgeRoughness roughness{};
  Plume plume{};
  UnevenLight light{};
  HotPixels hot{};
  FrameLink link{};
};

/// Everything that is wrong with a description or with the print, in one line; empty when nothing is.
std::string faultsOf(const CameraDescription& camera);
std::string faultsOf(const PrintLayout& print);

/// State of the spot camera's scene at one instant of an exposure; instants are evenly spaced. Sample i of n
/// stands for the i-th of n equal parts of the exposure, as at the middle of that part.
struct ExposureSample {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};  ///< Centre of the spot.
  double radius_mm{};                                ///< 1/e² radius; > 0 where power_w > 0.
  double power_w{};                                  ///< Mean power over the part.
  Eigen::Vector2d p_WS_mm{Eigen::Vector2d::Zero()};  ///< Origin of the web's S (unit 0) in W.
  double angle_rad{};                                ///< Angle of the web.
};
struct Exposure {
  std::uint64_t sequence{};
  double start_s{};
  std::vector<ExposureSample> samples;  ///< >= 1
};

/// Fate of a frame between the camera and the bench.
struct FrameFate {
  bool dropped{};
  double stamp_error_s{};  ///< Added to its time stamp.
};

/// Renders the spot camera's picture: board, printed marks of every unit in view, the glowing spot smeared
/// over the exposure, blur, shot noise and read noise. Noise is sampled from seed and sequence, so any frame
/// can be rendered alone, in any order, from any thread.
///
/// The spot glows as a Gaussian of half its radius. `glow_gray_per_w` is the grey level per watt that it adds
/// at the centre of a spot at rest, as imaged; a moving spot spreads the same light along its path. Levels
/// above the top of the scale saturate. Noise is fresh for each frame around the print and the spot.
/// Elsewhere each row of plain board is cut from a long prepared strip of noise at its own place, sampled for
/// each row of each frame: nothing repeats in a frame or between frames, except rarely a piece of a row. With
/// uneven light, or grain everywhere, the whole frame is rendered afresh.
///
/// Immutable; copies share the strip.
class SpotCamera {
 public:
  /// @throws std::invalid_argument that names everything wrong.
  SpotCamera(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w,
             std::uint64_t seed);
  /// The whole picture. @throws std::invalid_argument for an exposure without samples or with values that are
  /// not finite.
  [[nodiscard]] Frame render(const Exposure& exposure) const;
  /// Windows alone, cut to the picture: their pixels are those of the whole picture. Takes the time of the
  /// windows, not of the picture. @throws as above.
  [[nodiscard]] Frame render(const Exposure& exposure, std::span<const PixelWindow> windows) const;
  /// Fate of a frame under the description's link; render() itself neither drops nor delays.
  [[nodiscard]] FrameFate fateOf(std::uint64_t sequence) const;
  [[nodiscard]] const CameraDescription& description() const;

 private:
  struct Model;
  std::shared_ptr<const Model> model_;
};

/// How far an axis of a table goes aside on its way.
struct TableBow {
  double amplitude_mm{};  ///< Half the height of a sine of kPeriod_mm.
  double phase_rad{};
  static constexpr double kPeriod_mm = 150.0;
  [[nodiscard]] double at(double along_mm) const {
    return amplitude_mm * std::sin(2.0 * std::numbers::pi * along_mm / kPeriod_mm + phase_rad);
  }
};

/// The table on which the finished sheet lies under the kerf camera: how far it is from the truth.
struct InspectionTableDescription {
  double step_mm{};  ///< Standard deviation of where it stops, per axis, anew for each tile.
  double scale{};    ///< Relative: the way that it goes for a millimetre of its scales, less one.
  /// Along x as it goes along y, and along y as it goes along x.
  TableBow bow_x{}, bow_y{};
};

/// Piece of the web that lies on the inspection table, along Sx of its unit. The rest of the web was cut off
/// before: nothing that was burnt there is seen.
struct PieceSpan {
  double min_x_S_mm{-std::numeric_limits<double>::infinity()};
  double max_x_S_mm{std::numeric_limits<double>::infinity()};
};

/// Renders back-lit tiles of one unit on the inspection table. Its light is diffuse, or falls off with the
/// angle between the line of sight and the sheet's normal (back_light_half_angle_rad): a common lens then
/// sees the middle of its field alone, a telecentric one all of it.
///
/// The sheet's printed face lies in the plane that the camera looks at, the other face `thickness_mm` below.
/// The burn is deep from the printed face, square to it: where a line of sight goes through board for the
/// share z of the thickness, lightThrough() of z comes through, under a mark that of print_transmission. A
/// line of sight that is aslant by the angle theta so sees a kerf displaced, by up to half of thickness
/// tan(theta) with upright walls, and narrower. Left out: the longer way of such a line (0.8 % at 7.3
/// degrees), light from lit walls, and the slant of the walls where the beam itself fell aslant.
///
/// Noise is sampled from seed, unit and place of the tile: a tile is the same however often and wherever it
/// is rendered. Another seed with the same board_seed is another look at the same board. Immutable, so safe
/// to share between threads.
class KerfCamera {
 public:
  /// @throws std::invalid_argument that names everything wrong.
  KerfCamera(const CameraDescription& camera, const PrintLayout& print, std::uint64_t seed);

  /// Picture of one tile. p_TV_mm: shift of the camera over the table. X_TS: place of the unit's frame S_k on
  /// the table.
  [[nodiscard]] GrayImage render(const Sheet& sheet, int unit, const Eigen::Vector2d& p_TV_mm,
                                 const Eigen::Isometry2d& X_TS, const PieceSpan& piece = {}) const;
  [[nodiscard]] const CameraDescription& description() const;
  [[nodiscard]] const PrintLayout& print() const;
  /// Largest upright box of the camera's plane V, approximately, that lies within the picture.
  [[nodiscard]] Eigen::AlignedBox2d field() const;

 private:
  struct Model;
  std::shared_ptr<const Model> model_;
};

}  // namespace kerfbench::twin
