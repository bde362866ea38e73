// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "twin/camera/camera.h"

namespace kerfbench::twin {
namespace {

bool within(double value, double least, double most) { return value >= least && value <= most; }
bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool notNegative(double value) { return std::isfinite(value) && value >= 0.0; }

/// Collects faults: "camera: this; that".
class Faults {
 public:
  explicit Faults(const char* subject) : subject_(subject) {}
  void require(bool fine, const char* rule) {
    if (!fine) text_ += (text_.empty() ? subject_ + ": " : "; ") + rule;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string subject_;
  std::string text_;
};

void findOnBoard(Faults& faults, const CameraDescription& camera) {
  const BoardTexture& texture = camera.texture;
  faults.require(within(texture.grain_gray, 0.0, 40.0), "texture.grain_gray must be in [0, 40]");
  faults.require(within(texture.grain_length_mm, 0.01, 10.0),
                 "texture.grain_length_mm must be in [0.01, 10]");
  faults.require(within(texture.glow_share, 0.0, 0.5), "texture.glow_share must be in [0, 0.5]");
  faults.require(within(texture.glow_length_mm, 0.01, 10.0), "texture.glow_length_mm must be in [0.01, 10]");
  faults.require(!(texture.grain_gray > 0.0) || camera.board_gray > 0.0,
                 "texture.grain_gray needs a board_gray > 0");
  faults.require(within(camera.roughness.rms_mm, 0.0, 0.1), "roughness.rms_mm must be in [0, 0.1]");
  faults.require(within(camera.roughness.length_mm, 0.01, 10.0), "roughness.length_mm must be in [0.01, 10]");
}

void findInLight(Faults& faults, const CameraDescription& camera) {
  const Plume& plume = camera.plume;
  faults.require(within(plume.share, 0.0, 1.0), "plume.share must be in [0, 1]");
  faults.require(within(plume.offset_mm.x(), -50.0, 50.0) && within(plume.offset_mm.y(), -50.0, 50.0),
                 "plume.offset_mm must be in [-50, 50]");
  faults.require(within(plume.sigma_mm, 0.01, 20.0), "plume.sigma_mm must be in [0.01, 20]");
  faults.require(within(plume.flicker, 0.0, 2.0), "plume.flicker must be in [0, 2]");
  faults.require(within(plume.wander_mm, 0.0, 20.0), "plume.wander_mm must be in [0, 20]");
  faults.require(within(camera.light.vignette, 0.0, 0.9), "light.vignette must be in [0, 0.9]");
  faults.require(std::abs(camera.light.gradient_x) + std::abs(camera.light.gradient_y) <= 1.0,
                 "light.gradient_x and light.gradient_y together must be within 1");
  faults.require(within(camera.hot.share, 0.0, 0.01), "hot.share must be in [0, 0.01]");
  faults.require(within(camera.hot.gray, 0.0, 255.0), "hot.gray must be in [0, 255]");
}

void findInLink(Faults& faults, const CameraDescription& camera) {
  const FrameLink& link = camera.link;
  faults.require(within(link.drop_share, 0.0, 1.0), "link.drop_share must be in [0, 1]");
  faults.require(link.stamp_jitter_s == 0.0 || within(link.stamp_jitter_s, 0.0, camera.frame_period_s),
                 "link.stamp_jitter_s must be in [0, frame_period_s]");
  faults.require(within(link.late_share, 0.0, 1.0), "link.late_share must be in [0, 1]");
  faults.require(within(link.late_s, 0.0, 10.0), "link.late_s must be in [0, 10]");
}

}  // namespace

std::string faultsOf(const CameraDescription& camera) {
  Faults faults("camera");
  const auto require = [&faults](bool fine, const char* rule) { faults.require(fine, rule); };
  require(camera.width_px >= 16 && camera.width_px <= 32768, "width_px must be in [16, 32768]");
  require(camera.height_px >= 16 && camera.height_px <= 32768, "height_px must be in [16, 32768]");
  require(positive(camera.fx_px), "fx_px must be > 0");
  require(positive(camera.fy_px), "fy_px must be > 0");
  require(std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px), "cx_px and cy_px must be finite");
  for (const double k : camera.distortion) require(std::isfinite(k), "distortion must be finite");
  require(notNegative(camera.telecentric_mm), "telecentric_mm must be >= 0");
  require(camera.X_CP.matrix().allFinite(), "X_CP must be finite");
  const Eigen::Matrix3d R_CP = camera.X_CP.linear();
  require((R_CP.transpose() * R_CP - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6,
          "X_CP must be a rotation and a shift");
  require(camera.bits == 8 || camera.bits == 10 || camera.bits == 12, "bits must be 8, 10 or 12");
  require(within(camera.psf_sigma_px, 0.0, 10.0), "psf_sigma_px must be in [0, 10]");
  require(within(camera.foot.share, 0.0, 0.5), "foot.share must be in [0, 0.5]");
  require(within(camera.foot.sigma_px, 0.5, 4.0), "foot.sigma_px must be in [0.5, 4]");
  require(notNegative(camera.read_noise), "read_noise must be >= 0");
  require(camera.full_well_electrons > 0.0, "full_well_electrons must be > 0");
  require(within(camera.board_gray, 0.0, 255.0), "board_gray must be in [0, 255]");
  require(camera.open_gray > 0.0 && camera.open_gray <= 255.0, "open_gray must be in (0, 255]");
  require(within(camera.back_light_half_angle_rad, 0.0, 1.5),
          "back_light_half_angle_rad must be in [0, 1.5]");
  findOnBoard(faults, camera);
  findInLight(faults, camera);
  findInLink(faults, camera);
  return faults.text();
}

std::string faultsOf(const PrintLayout& print) {
  Faults faults("print");
  faults.require(print.units >= 1, "units must be >= 1");
  faults.require(
      std::isfinite(print.pitch_mm) && (print.pitch_mm > 0.0 || (print.units == 1 && print.pitch_mm == 0.0)),
      "pitch_mm must be > 0");
  for (const RegistrationMark& mark : print.marks) {
    faults.require(mark.p_SM_mm.allFinite(), "marks must be at finite places");
    faults.require(positive(mark.diameter_mm), "diameter_mm of a mark must be > 0");
  }
  for (const PrintedArea& area : print.areas) {
    faults.require(area.p_SA_mm.allFinite() && std::isfinite(area.angle_rad),
                   "areas must be at finite places");
    faults.require(positive(area.size_mm.x()) && positive(area.size_mm.y()),
                   "size_mm of an area must be > 0");
    faults.require(within(area.ink, 0.0, 1.0), "ink of an area must be in [0, 1]");
  }
  return faults.text();
}

}  // namespace kerfbench::twin
