// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <Eigen/LU>

#include "twin/base/random.h"
#include "twin/camera/camera.h"
#include "twin/camera/projection.h"
#include "twin/camera/sensor_noise.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kBackgrounds = 3;
constexpr std::uint64_t kBackgroundStream = ~std::uint64_t{0} - kBackgrounds;  // Above every sequence number.
constexpr std::uint64_t kShiftSeed = 0x5f3c1d2e9b8a7061ULL;
constexpr double kPixelSigma = 0.2887;  // Of the pixel's own area, 1/sqrt(12).
constexpr double kEdgeSigmas = 4.0;
constexpr double kMarkPad_px = 10.0;
constexpr double kSpotPad_px = 12.0;
constexpr double kFaintGray = 0.02;

/// Pixels [x0, x1) x [y0, y1).
struct PixelBox {
  int x0{}, y0{}, x1{}, y1{};
  [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
  [[nodiscard]] bool meets(const PixelBox& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
  [[nodiscard]] PixelBox with(const PixelBox& other) const {
    return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1), std::max(y1, other.y1)};
  }
};

/// The light of one printed mark: a blurred disc, smeared over the places where the web was.
struct MarkImage {
  PixelBox box;
  std::vector<Vector2d> p_WM_mm;  ///< Centres during the exposure.
  double radius_mm{};
  double px_per_mm{};
};

/// The light of the spot during one instant.
struct Blob {
  PixelBox box;
  Vector2d centre_px;
  Eigen::Matrix2d inverse_covariance;
  double gray{};
};

/// Where the web was at one instant.
struct WebPose {
  Vector2d p_WS_mm;
  double cos{};
  double sin{};
  [[nodiscard]] Vector2d place(const Vector2d& p_S_mm) const {
    return p_WS_mm + Vector2d(cos * p_S_mm.x() - sin * p_S_mm.y(), sin * p_S_mm.x() + cos * p_S_mm.y());
  }
};

/// How far `place` moves during the part of the exposure for which sample i stands.
template <typename Place>
Vector2d travelDuring(const std::vector<ExposureSample>& samples, std::size_t i, Place place) {
  const std::size_t last = samples.size() - 1;
  const std::size_t before = i == 0 ? 0 : i - 1;
  const std::size_t after = std::min(i + 1, last);
  if (before == after) return Vector2d::Zero();
  return (place(samples[after]) - place(samples[before])) / static_cast<double>(after - before);
}

int partsFor(double travel_mm, double step_mm) {
  return std::clamp(static_cast<int>(std::ceil(travel_mm / step_mm)), 1, 1000);
}

/// Share of light that a straight edge leaves `distance` blur sigmas outside of it: the normal distribution's
/// tail.
class BlurredEdge {
 public:
  BlurredEdge() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double distance = (static_cast<double>(i) / kPerSigma) - kEdgeSigmas;
      table_[i] = static_cast<float>(0.5 * std::erfc(distance / std::numbers::sqrt2));
    }
  }
  [[nodiscard]] float at(double distance) const {
    if (distance <= -kEdgeSigmas) return 1.0F;
    if (distance >= kEdgeSigmas) return 0.0F;
    const double place = (distance + kEdgeSigmas) * kPerSigma;
    const auto i = static_cast<std::size_t>(place);
    const auto t = static_cast<float>(place - static_cast<double>(i));
    return table_[i] + t * (table_[i + 1] - table_[i]);
  }

 private:
  static constexpr double kPerSigma = 128.0;
  std::array<float, 1026> table_{};
};

void mergeOverlapping(std::vector<PixelBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size();) {
    bool merged = false;
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      if (!boxes[i].meets(boxes[j])) continue;
      boxes[i] = boxes[i].with(boxes[j]);
      boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
      merged = true;
      break;
    }
    // The grown box may meet an earlier one.
    i = merged ? 0 : i + 1;
  }
}

void checkExposure(const Exposure& exposure) {
  bool fine = !exposure.samples.empty() && std::isfinite(exposure.start_s);
  for (const ExposureSample& sample : exposure.samples) {
    fine = fine && sample.p_WQ_mm.allFinite() && sample.p_WS_mm.allFinite() &&
           std::isfinite(sample.angle_rad) && std::isfinite(sample.power_w) && sample.power_w >= 0.0 &&
           std::isfinite(sample.radius_mm) && (sample.power_w == 0.0 || sample.radius_mm > 0.0);
  }
  if (!fine)
    throw std::invalid_argument(
        "SpotCamera::render: an exposure without samples or with values out of range");
}

}  // namespace

struct SpotCamera::Model {
  CameraDescription camera;
  PrintLayout print;
  double glow_gray_per_w;
  std::uint64_t seed;
  PlaneProjection projection;
  SensorNoise noise;
  Eigen::AlignedBox2d view_W;
  double mm_per_px;
  double blur_px;
  BlurredEdge edge;
  std::vector<std::vector<std::uint8_t>> backgrounds;

  Model(const CameraDescription& camera_, const PrintLayout& print_, double glow, std::uint64_t seed_);
  [[nodiscard]] PixelBox boxAround(const Vector2d& centre_px, double half_x, double half_y) const;
  [[nodiscard]] std::vector<WebPose> webPoses(const Exposure& exposure) const;
  [[nodiscard]] std::vector<MarkImage> marksInView(const std::vector<WebPose>& web) const;
  [[nodiscard]] std::vector<Blob> blobs(const Exposure& exposure) const;
  void addMark(const MarkImage& mark, const PixelBox& box, std::vector<float>& light) const;
  static void addBlob(const Blob& blob, const PixelBox& box, std::vector<float>& light);
  [[nodiscard]] std::vector<std::uint8_t> background(std::uint64_t sequence) const;
};

SpotCamera::Model::Model(const CameraDescription& camera_, const PrintLayout& print_, double glow,
                         std::uint64_t seed_)
    : camera(camera_),
      print(print_),
      glow_gray_per_w(glow),
      seed(seed_),
      projection(camera_),
      noise(camera_.read_noise, camera_.full_well_electrons),
      view_W(fieldOf(projection, camera_.width_px, camera_.height_px).circumscribed),
      mm_per_px(1.0 / std::sqrt(std::abs(projection.jacobianAt(view_W.center()).determinant()))),
      blur_px(std::max(camera_.psf_sigma_px, kPixelSigma)) {
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  const std::vector<float> light(static_cast<std::size_t>(camera.width_px),
                                 static_cast<float>(camera.board_gray));
  for (std::uint64_t b = 0; b < kBackgrounds; ++b) {
    const CounterRandom random(seed, kBackgroundStream + b);
    std::vector<std::uint8_t>& background = backgrounds.emplace_back(pixels);
    for (std::size_t begin = 0; begin < pixels; begin += light.size()) {
      noise.expose(light, random, begin, background.data() + begin);
    }
  }
}

PixelBox SpotCamera::Model::boxAround(const Vector2d& centre_px, double half_x, double half_y) const {
  const auto clip = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  return {clip(std::floor(centre_px.x() - half_x), camera.width_px),
          clip(std::floor(centre_px.y() - half_y), camera.height_px),
          clip(std::ceil(centre_px.x() + half_x) + 1.0, camera.width_px),
          clip(std::ceil(centre_px.y() + half_y) + 1.0, camera.height_px)};
}

std::vector<WebPose> SpotCamera::Model::webPoses(const Exposure& exposure) const {
  const auto place = [](const ExposureSample& sample) { return sample.p_WS_mm; };
  const auto& samples = exposure.samples;
  double travel_mm = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) travel_mm += travelDuring(samples, i, place).norm();
  std::vector<WebPose> poses;
  if (travel_mm < 0.05 * mm_per_px) {
    Vector2d p_WS_mm = Vector2d::Zero();
    double angle_rad = 0.0;
    for (const ExposureSample& sample : samples) {
      p_WS_mm += sample.p_WS_mm / static_cast<double>(samples.size());
      angle_rad += sample.angle_rad / static_cast<double>(samples.size());
    }
    poses.push_back({p_WS_mm, std::cos(angle_rad), std::sin(angle_rad)});
    return poses;
  }
  // The same number for each sample: each stands for the same time.
  const int parts = partsFor(travel_mm / static_cast<double>(samples.size()), 0.5 * mm_per_px);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d travel = travelDuring(samples, i, place);
    for (int part = 0; part < parts; ++part) {
      poses.push_back({samples[i].p_WS_mm + travel * ((part + 0.5) / parts - 0.5),
                       std::cos(samples[i].angle_rad), std::sin(samples[i].angle_rad)});
    }
  }
  return poses;
}

std::vector<MarkImage> SpotCamera::Model::marksInView(const std::vector<WebPose>& web) const {
  std::vector<MarkImage> found;
  const WebPose& middle = web[web.size() / 2];
  for (int unit = 0; unit < print.units; ++unit) {
    for (const RegistrationMark& mark : print.marks) {
      const Vector2d p_SM_mm = mark.p_SM_mm - Vector2d(unit * print.pitch_mm, 0.0);
      const Vector2d p_WM_mm = middle.place(p_SM_mm);
      if (view_W.exteriorDistance(p_WM_mm) > 2.0 * mark.diameter_mm) continue;
      const std::optional<Vector2d> centre_px = projection.pixelOf(p_WM_mm);
      if (!centre_px) continue;
      MarkImage image;
      image.radius_mm = 0.5 * mark.diameter_mm;
      double reach_mm = image.radius_mm;
      for (const WebPose& pose : web) {
        image.p_WM_mm.push_back(pose.place(p_SM_mm));
        reach_mm = std::max(reach_mm, image.radius_mm + (image.p_WM_mm.back() - p_WM_mm).norm());
      }
      const Eigen::Matrix2d J = projection.jacobianAt(p_WM_mm);
      image.px_per_mm = std::sqrt(std::abs(J.determinant()));
      const double pad_px = kEdgeSigmas * blur_px + kMarkPad_px;
      image.box = boxAround(*centre_px, 1.05 * reach_mm * J.row(0).norm() + pad_px,
                            1.05 * reach_mm * J.row(1).norm() + pad_px);
      if (!image.box.empty()) found.push_back(std::move(image));
    }
  }
  return found;
}

std::vector<Blob> SpotCamera::Model::blobs(const Exposure& exposure) const {
  std::vector<Blob> found;
  const auto& samples = exposure.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ExposureSample& sample = samples[i];
    const double gray = glow_gray_per_w * sample.power_w;
    if (!(gray > kFaintGray)) continue;
    const Vector2d travel = travelDuring(samples, i, [](const ExposureSample& s) { return s.p_WQ_mm; });
    const double sigma_mm = 0.5 * sample.radius_mm;
    const int parts = partsFor(travel.norm(), 0.8 * std::hypot(sigma_mm, blur_px * mm_per_px));
    const double reach = std::sqrt(2.0 * std::log(gray / kFaintGray));
    for (int part = 0; part < parts; ++part) {
      const Vector2d p_WQ_mm = sample.p_WQ_mm + travel * ((part + 0.5) / parts - 0.5);
      const std::optional<Vector2d> centre_px = projection.pixelOf(p_WQ_mm);
      if (!centre_px) continue;
      const Eigen::Matrix2d J = projection.jacobianAt(p_WQ_mm);
      const Eigen::Matrix2d covariance =
          sigma_mm * sigma_mm * J * J.transpose() + blur_px * blur_px * Eigen::Matrix2d::Identity();
      const PixelBox box = boxAround(*centre_px, reach * std::sqrt(covariance(0, 0)) + kSpotPad_px,
                                     reach * std::sqrt(covariance(1, 1)) + kSpotPad_px);
      if (box.empty()) continue;
      found.push_back(
          {box, *centre_px, covariance.inverse(), gray / (static_cast<double>(samples.size()) * parts)});
    }
  }
  return found;
}

void SpotCamera::Model::addMark(const MarkImage& mark, const PixelBox& box, std::vector<float>& light) const {
  const PixelBox& own = mark.box;
  PlanePatch::Nodes nodes;
  for (std::size_t n = 0; n < 9; ++n) {
    const std::size_t column = n % 3;
    const std::size_t row = n / 3;
    const Vector2d pixel(own.x0 + 0.5 * static_cast<double>(column) * (own.x1 - own.x0),
                         own.y0 + 0.5 * static_cast<double>(row) * (own.y1 - own.y0));
    const std::optional<Vector2d> point = projection.planePointOf(pixel);
    if (!point) return;
    nodes[n] = *point;
  }
  const PlanePatch patch(nodes);
  const auto darkening =
      static_cast<float>((kMarkGray - camera.board_gray) / static_cast<double>(mark.p_WM_mm.size()));
  const double sigmas_per_mm = mark.px_per_mm / blur_px;
  const double outside_mm = mark.radius_mm + kEdgeSigmas / sigmas_per_mm;
  for (int y = own.y0; y < own.y1; ++y) {
    const double t = (y - own.y0) / static_cast<double>(own.y1 - own.y0);
    const Vector2d c0 = patch.alongRow(t, 0);
    const Vector2d c1 = patch.alongRow(t, 1);
    const Vector2d c2 = patch.alongRow(t, 2);
    float* const line = light.data() + static_cast<std::ptrdiff_t>(y - box.y0) * (box.x1 - box.x0) - box.x0;
    for (int x = own.x0; x < own.x1; ++x) {
      const double s = (x - own.x0) / static_cast<double>(own.x1 - own.x0);
      const Vector2d p_WP_mm = c0 + s * (c1 + s * c2);
      float covered = 0.0F;
      for (const Vector2d& p_WM_mm : mark.p_WM_mm) {
        const double square = (p_WP_mm - p_WM_mm).squaredNorm();
        if (square > outside_mm * outside_mm) continue;
        covered += edge.at((std::sqrt(square) - mark.radius_mm) * sigmas_per_mm);
      }
      line[x] += darkening * covered;
    }
  }
}

void SpotCamera::Model::addBlob(const Blob& blob, const PixelBox& box, std::vector<float>& light) {
  const double xx = blob.inverse_covariance(0, 0);
  const double xy = blob.inverse_covariance(0, 1);
  const double yy = blob.inverse_covariance(1, 1);
  for (int y = blob.box.y0; y < blob.box.y1; ++y) {
    float* const line = light.data() + static_cast<std::ptrdiff_t>(y - box.y0) * (box.x1 - box.x0) - box.x0;
    const double dy = y - blob.centre_px.y();
    for (int x = blob.box.x0; x < blob.box.x1; ++x) {
      const double dx = x - blob.centre_px.x();
      const double square = dx * dx * xx + 2.0 * dx * dy * xy + dy * dy * yy;
      if (square < 60.0) line[x] += static_cast<float>(blob.gray * std::exp(-0.5 * square));
    }
  }
}

std::vector<std::uint8_t> SpotCamera::Model::background(std::uint64_t sequence) const {
  const CounterRandom random(seed ^ kShiftSeed, sequence);
  const std::vector<std::uint8_t>& chosen = backgrounds[random.bits(0) % kBackgrounds];
  // Shifted through the flat array: by some rows and some columns at once.
  const auto split = chosen.begin() + static_cast<std::ptrdiff_t>(random.bits(1) % chosen.size());
  std::vector<std::uint8_t> pixels;
  pixels.reserve(chosen.size());
  pixels.insert(pixels.end(), split, chosen.end());
  pixels.insert(pixels.end(), chosen.begin(), split);
  return pixels;
}

SpotCamera::SpotCamera(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w,
                       std::uint64_t seed) {
  std::string faults = faultsOf(camera);
  const auto add = [&faults](const std::string& more) {
    if (!more.empty()) faults += (faults.empty() ? "" : "; ") + more;
  };
  add(faultsOf(print));
  // Also refuses NaN.
  if (!(camera.exposure_s > 0.0 && camera.exposure_s <= camera.frame_period_s))
    add("exposure_s must be in (0, frame_period_s]");
  if (!(glow_gray_per_w >= 0.0 && std::isfinite(glow_gray_per_w))) add("glow_gray_per_w must be >= 0");
  if (!faults.empty()) throw std::invalid_argument(faults);
  model_ = std::make_shared<const Model>(camera, print, glow_gray_per_w, seed);
}

const CameraDescription& SpotCamera::description() const { return model_->camera; }

Frame SpotCamera::render(const Exposure& exposure) const {
  checkExposure(exposure);
  const Model& model = *model_;
  const std::vector<MarkImage> marks = model.marksInView(model.webPoses(exposure));
  const std::vector<Blob> blobs = model.blobs(exposure);
  std::vector<PixelBox> boxes;
  for (const MarkImage& mark : marks) boxes.push_back(mark.box);
  std::optional<PixelBox> spot;
  for (const Blob& blob : blobs) spot = spot ? spot->with(blob.box) : blob.box;
  if (spot) boxes.push_back(*spot);
  mergeOverlapping(boxes);

  Frame frame;
  frame.sequence = exposure.sequence;
  frame.start_s = exposure.start_s;
  frame.exposure_s = model.camera.exposure_s;
  frame.image.width = model.camera.width_px;
  frame.image.height = model.camera.height_px;
  frame.image.pixels = model.background(exposure.sequence);

  const CounterRandom random(model.seed, exposure.sequence);
  std::vector<float> light;
  for (const PixelBox& box : boxes) {
    const auto width = static_cast<std::size_t>(box.x1 - box.x0);
    light.assign(width * static_cast<std::size_t>(box.y1 - box.y0),
                 static_cast<float>(model.camera.board_gray));
    for (const MarkImage& mark : marks) {
      if (mark.box.meets(box)) model.addMark(mark, box, light);
    }
    for (const Blob& blob : blobs) {
      if (blob.box.meets(box)) Model::addBlob(blob, box, light);
    }
    for (int y = box.y0; y < box.y1; ++y) {
      const std::size_t first =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(model.camera.width_px) +
          static_cast<std::size_t>(box.x0);
      model.noise.expose(std::span(light).subspan(static_cast<std::size_t>(y - box.y0) * width, width),
                         random, first, frame.image.pixels.data() + first);
    }
  }
  return frame;
}

}  // namespace kerfbench::twin
