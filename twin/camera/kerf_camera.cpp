// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "twin/base/random.h"
#include "twin/camera/camera.h"
#include "twin/camera/gaussian_blur.h"
#include "twin/camera/projection.h"
#include "twin/camera/sensor_noise.h"
#include "twin/sheet/cubic_spline.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr int kBlockPx = 16;
constexpr double kSampleMm = 0.0145;  // Supersampling pitch: finer than the spline's cells.
constexpr double kMaxPsfPx = 2.0;     // The blur must not reach beyond the next block.
constexpr double kFarMm = 1e6;
constexpr std::uint64_t kTileSeed = 0x3a8f05c5d2b17e49ULL;

/// Cuts `size` pixels into blocks of at most kBlockPx; returns the first pixel of each, and `size`.
std::vector<int> blockEdges(int size) {
  const int blocks = (size + kBlockPx - 1) / kBlockPx;
  std::vector<int> edges;
  for (int b = 0; b <= blocks; ++b) edges.push_back(size * b / blocks);
  return edges;
}

/// Spline weights at 1024 places between two nodes (0.02 µm apart).
class WeightTable {
 public:
  WeightTable() {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      storeQuad(&weights_[4 * i], splineWeights((static_cast<float>(i) + 0.5F) / kPlaces));
    }
  }
  [[nodiscard]] Quad at(float t) const {
    return loadQuad(&weights_[4 * static_cast<std::size_t>(t * static_cast<float>(kPlaces))]);
  }

 private:
  static constexpr std::size_t kPlaces = 1024;
  std::array<float, 4 * kPlaces> weights_{};
};

/// Grey level of the back light through board burnt to a depth of 0…1, where uncut board lets `transmission`
/// through.
class LightTable {
 public:
  explicit LightTable(double transmission) {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double depth = static_cast<double>(i) / (static_cast<double>(table_.size()) - 1.0);
      table_[i] = static_cast<float>(kOpenKerfGray * std::pow(transmission, 1.0 - depth));
    }
  }
  [[nodiscard]] float at(float depth) const {
    const float place = (depth < 1.0F ? depth : 1.0F) * static_cast<float>(kSteps);
    return table_[static_cast<std::size_t>(place + 0.5F)];
  }

 private:
  static constexpr std::size_t kSteps = 4096;
  std::array<float, kSteps + 1> table_{};
};

/// A printed mark in the spline's own unit.
struct MarkDisc {
  Vector2d centre_nodes;
  double radius_nodes;
};

/// What the blocks of one tile share, and scratch.
struct TileJob {
  const Sheet& sheet;
  LightTable board;
  LightTable print;
  float depth_per_fluence;
  double piece_min_nodes;
  double piece_max_nodes;
  std::vector<MarkDisc> marks;
  std::vector<float> nodes;
  std::vector<MarkDisc> near;
};

}  // namespace

struct KerfCamera::Model {
  CameraDescription camera;
  PrintLayout print;
  std::uint64_t seed;
  PlaneProjection projection;
  SensorNoise noise;
  GaussianBlur blur;
  PlaneField field;
  std::vector<int> edges_x;
  std::vector<int> edges_y;
  std::vector<Vector2d> plane_nodes;  ///< p_V at the corners, middles and centres of all blocks.
  int samples_per_px{};
  double mm_per_px{};
  WeightTable weights;

  Model(const CameraDescription& camera_, const PrintLayout& print_, std::uint64_t seed_);
  /// Draws one block into `light`; false if it is plain board.
  bool renderBlock(TileJob& job, const Eigen::Isometry2d& X_NV, std::size_t bx, std::size_t by,
                   std::vector<float>& light) const;
};

KerfCamera::Model::Model(const CameraDescription& camera_, const PrintLayout& print_, std::uint64_t seed_)
    : camera(camera_),
      print(print_),
      seed(seed_),
      projection(camera_),
      noise(camera_.read_noise, camera_.full_well_electrons),
      // The average over a pixel's area is part of the blur; the supersampling does it.
      blur(camera_.psf_sigma_px * camera_.psf_sigma_px - 1.0 / 12.0),
      field(fieldOf(projection, camera_.width_px, camera_.height_px)),
      edges_x(blockEdges(camera_.width_px)),
      edges_y(blockEdges(camera_.height_px)) {
  mm_per_px = 1.0 / std::sqrt(std::abs(projection.jacobianAt(field.inscribed.center()).determinant()));
  samples_per_px = std::clamp(static_cast<int>(std::ceil(mm_per_px / kSampleMm)), 3, 8);
  const auto nodeAt = [](const std::vector<int>& edges, std::size_t i) {
    return 0.5 * (edges[i / 2] + edges[(i + 1) / 2]) - 0.5;
  };
  for (std::size_t j = 0; j < 2 * edges_y.size() - 1; ++j) {
    for (std::size_t i = 0; i < 2 * edges_x.size() - 1; ++i) {
      const auto point = projection.planePointOf({nodeAt(edges_x, i), nodeAt(edges_y, j)});
      if (!point) throw std::invalid_argument("camera: a pixel does not see the plane");
      plane_nodes.push_back(*point);
    }
  }
}

bool KerfCamera::Model::renderBlock(TileJob& job, const Eigen::Isometry2d& X_NV, std::size_t bx,
                                    std::size_t by, std::vector<float>& light) const {
  const std::size_t stride = 2 * edges_x.size() - 1;
  PlanePatch::Nodes corners;
  Eigen::AlignedBox2d box;  // Of the block, in the spline's unit.
  for (std::size_t n = 0; n < 9; ++n) {
    const Vector2d& p_V_mm = plane_nodes[(2 * by + n / 3) * stride + 2 * bx + n % 3];
    corners[n] = (X_NV * p_V_mm) / Sheet::kCellMm;
    box.extend(corners[n]);
  }
  // One node more than the spline needs: a patch may bulge a little between its corners.
  const int column = static_cast<int>(std::floor(box.min().x())) - 2;
  const int row = static_cast<int>(std::floor(box.min().y())) - 2;
  const int columns = static_cast<int>(std::floor(box.max().x())) + 4 - column;
  const int rows = static_cast<int>(std::floor(box.max().y())) + 4 - row;
  const auto window = static_cast<std::size_t>(columns);
  job.nodes.resize(window * static_cast<std::size_t>(rows));
  bool burnt = job.sheet.copyNodes(column, row, columns, rows, job.nodes) * job.depth_per_fluence >
               static_cast<float>(Sheet::kUntouchedDepth);
  if (burnt && (column < job.piece_min_nodes || column + columns - 1 > job.piece_max_nodes)) {
    for (std::size_t i = 0; i < job.nodes.size(); ++i) {
      const double x = column + static_cast<double>(i % window);
      if (x < job.piece_min_nodes || x > job.piece_max_nodes) job.nodes[i] = 0.0F;
    }
  }
  const double sample_nodes = mm_per_px / samples_per_px / Sheet::kCellMm;
  job.near.clear();
  for (const MarkDisc& mark : job.marks) {
    if (box.exteriorDistance(mark.centre_nodes) < mark.radius_nodes + sample_nodes) job.near.push_back(mark);
  }
  if (!burnt && job.near.empty()) return false;

  const PlanePatch patch(corners);
  const Vector2d origin(column, row);
  const int width = edges_x[bx + 1] - edges_x[bx];
  const int height = edges_y[by + 1] - edges_y[by];
  const float share = 1.0F / static_cast<float>(samples_per_px * samples_per_px);
  for (int y = 0; y < height; ++y) {
    float* const line =
        light.data() + static_cast<std::ptrdiff_t>(edges_y[by] + y) * camera.width_px + edges_x[bx];
    std::fill_n(line, width, 0.0F);
    for (int sub_y = 0; sub_y < samples_per_px; ++sub_y) {
      const double t = (y + (sub_y + 0.5) / samples_per_px) / height;
      const Eigen::Vector2f c0 = (patch.alongRow(t, 0) - origin).cast<float>();
      const Eigen::Vector2f c1 = patch.alongRow(t, 1).cast<float>();
      const Eigen::Vector2f c2 = patch.alongRow(t, 2).cast<float>();
      const float step = 1.0F / static_cast<float>(width * samples_per_px);
      float s = 0.5F * step;
      for (int x = 0; x < width; ++x) {
        float sum = 0.0F;
        for (int sub_x = 0; sub_x < samples_per_px; ++sub_x, s += step) {
          const float px = c0.x() + s * (c1.x() + s * c2.x());
          const float py = c0.y() + s * (c1.y() + s * c2.y());
          const auto nx = static_cast<std::size_t>(px);
          const auto ny = static_cast<std::size_t>(py);
          float depth = 0.0F;
          if (burnt) {
            const float* const nodes = job.nodes.data() + (ny - 1) * window + (nx - 1);
            depth =
                job.depth_per_fluence * splineValue(nodes, window, weights.at(px - static_cast<float>(nx)),
                                                    weights.at(py - static_cast<float>(ny)));
          }
          float gray = job.board.at(depth);
          for (const MarkDisc& mark : job.near) {
            const double dx = px + origin.x() - mark.centre_nodes.x();
            const double dy = py + origin.y() - mark.centre_nodes.y();
            const double outside = (std::sqrt(dx * dx + dy * dy) - mark.radius_nodes) / sample_nodes;
            const auto covered = static_cast<float>(std::clamp(0.5 - outside, 0.0, 1.0));
            gray += covered * (job.print.at(depth) - gray);
          }
          sum += gray;
        }
        line[x] += sum * share;
      }
    }
  }
  return true;
}

KerfCamera::KerfCamera(const CameraDescription& camera, const PrintLayout& print, std::uint64_t seed) {
  std::string faults = faultsOf(camera);
  const auto add = [&faults](const std::string& more) {
    if (!more.empty()) faults += (faults.empty() ? "" : "; ") + more;
  };
  add(faultsOf(print));
  if (camera.psf_sigma_px > kMaxPsfPx) add("psf_sigma_px of the kerf camera must be <= 2");
  if (!faults.empty()) throw std::invalid_argument(faults);
  model_ = std::make_shared<const Model>(camera, print, seed);
}

const CameraDescription& KerfCamera::description() const { return model_->camera; }
const PrintLayout& KerfCamera::print() const { return model_->print; }
Eigen::AlignedBox2d KerfCamera::field() const { return model_->field.inscribed; }

GrayImage KerfCamera::render(const Sheet& sheet, int unit, const Vector2d& p_TV_mm,
                             const Eigen::Isometry2d& X_TS, const PieceSpan& piece) const {
  const Model& model = *model_;
  if (unit < 0 || unit >= model.print.units) throw std::invalid_argument("KerfCamera::render: no such unit");
  // Sk of the unit in S of unit 0, where the sheet keeps its burns; N is that frame too.
  const Vector2d p_SSk_mm(-unit * model.print.pitch_mm, 0.0);
  const Eigen::Isometry2d X_NV =
      Eigen::Translation2d(p_SSk_mm) * X_TS.inverse() * Eigen::Translation2d(p_TV_mm);
  const Vector2d middle = X_NV * model.field.circumscribed.center();
  if (!X_NV.matrix().allFinite() || !(middle.cwiseAbs().maxCoeff() < kFarMm)) {
    throw std::invalid_argument("KerfCamera::render: tile or sheet out of reach");
  }
  const auto toNodes = [&](double x_S_mm) { return (x_S_mm + p_SSk_mm.x()) / Sheet::kCellMm; };
  TileJob job{sheet,
              LightTable(sheet.board().transmission),
              LightTable(sheet.board().print_transmission),
              static_cast<float>(1.0 / sheet.board().cut_fluence_j_mm2),
              toNodes(piece.min_x_S_mm),
              toNodes(piece.max_x_S_mm),
              {},
              {},
              {}};
  for (const RegistrationMark& mark : model.print.marks) {
    job.marks.push_back(
        {(mark.p_SM_mm + p_SSk_mm) / Sheet::kCellMm, 0.5 * mark.diameter_mm / Sheet::kCellMm});
  }

  GrayImage image(model.camera.width_px, model.camera.height_px);
  std::vector<float> light(image.pixels.size(), job.board.at(0.0F));
  const std::size_t blocks_x = model.edges_x.size() - 1;
  const std::size_t blocks_y = model.edges_y.size() - 1;
  std::vector<char> drawn(blocks_x * blocks_y, 0);
  for (std::size_t by = 0; by < blocks_y; ++by) {
    for (std::size_t bx = 0; bx < blocks_x; ++bx) {
      if (model.renderBlock(job, X_NV, bx, by, light)) drawn[by * blocks_x + bx] = 1;
    }
  }
  model.blur.apply(light, model.camera.width_px, model.camera.height_px, model.edges_x, model.edges_y, drawn);

  const auto nanometres = [](double mm) { return static_cast<std::uint64_t>(std::llround(mm * 1e6)); };
  const CounterRandom place(static_cast<std::uint64_t>(unit), nanometres(p_TV_mm.x()));
  const CounterRandom random(model.seed ^ kTileSeed, place.bits(nanometres(p_TV_mm.y())));
  model.noise.expose(light, random, 0, image.pixels.data());
  return image;
}

}  // namespace kerfbench::twin
