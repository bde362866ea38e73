// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "twin/base/image.h"
#include "twin/base/random.h"
#include "twin/camera/camera.h"
#include "twin/camera/gaussian_blur.h"
#include "twin/camera/kerf_light.h"
#include "twin/camera/picture_shading.h"
#include "twin/camera/plane_grid.h"
#include "twin/camera/projection.h"
#include "twin/camera/sensor_noise.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr int kKerfBlockPx = 16;
constexpr double kSampleMm = 0.0145;  // Supersampling pitch: finer than the spline's cells.
constexpr int kMostSamples = 8;       // Samples per pixel, each way.
static_assert(kKerfBlockPx * kMostSamples <= kMostInRow);
constexpr double kMaxPsfPx = 2.0;  // The blur must not reach beyond the next block.
constexpr double kFarMm = 1e6;
// Ways through the board, in cells of the spline: below the first a line of sight counts as square to the
// sheet (0.02 um), and one slice is no longer than the second, a quarter of the spline's cell.
constexpr double kSquareNodes = 1e-3;
constexpr double kSliceNodes = 0.25;
constexpr std::uint64_t kKerfGrainStream = 1;
constexpr std::uint64_t kTileSeed = 0x3a8f05c5d2b17e49ULL;

/// Copies the window's nodes; nodes whose `effect_nodes` further on lies off the piece are set to zero. False
/// if nothing that is left is above `limit_j_mm2`: what lies off the piece decides nothing about it.
bool fill(Window& window, const TileJob& job, double effect_nodes, double limit_j_mm2) {
  if (!job.sheet.hasNodes(window.column, window.row, window.columns, window.rows)) return false;
  const auto columns = static_cast<std::size_t>(window.columns);
  window.nodes.resize(columns * static_cast<std::size_t>(window.rows));
  float largest = job.sheet.copyNodes(window.column, window.row, window.columns, window.rows, window.nodes);
  const double first = window.column + effect_nodes;
  if (first < job.piece_min_nodes || first + window.columns - 1 > job.piece_max_nodes) {
    for (std::size_t i = 0; i < window.nodes.size(); ++i) {
      const double x = first + static_cast<double>(i % columns);
      if (x < job.piece_min_nodes || x > job.piece_max_nodes) window.nodes[i] = 0.0F;
    }
    largest = *std::ranges::max_element(window.nodes);
  }
  return largest > static_cast<float>(limit_j_mm2);
}

}  // namespace

struct KerfCamera::Model {
  CameraDescription camera;
  PrintLayout print;
  std::uint64_t seed;
  PlaneProjection projection;
  SensorNoise noise;
  GaussianBlur blur;
  GaussianBlur foot;
  PlaneField field;
  PlaneGrid grid;
  PictureShading shading;
  std::optional<BoardField> grain;
  int samples_per_px{};
  double mm_per_px{};
  SplineWeightTable weights;

  Model(const CameraDescription& camera_, const PrintLayout& print_, std::uint64_t seed_);
  /// Renders one block into `light`; false if it is plain board.
  bool renderBlock(TileJob& job, const Eigen::Isometry2d& X_NV, std::size_t bx, std::size_t by,
                   std::vector<float>& light) const;
  template <class Painter>
  void paint(const PlaneGrid::Block& block, const PlanePatch& patch, Painter painter,
             std::vector<float>& light) const;
  void setSight(const Eigen::Isometry2d& X_NV, TileJob& job) const;
  /// Number of slices that a block's lines of sight are followed in; the box grows by where they lead.
  static int slicesOf(const ObliqueSight& sight, Eigen::AlignedBox2d& box);
  void blurAll(const std::vector<char>& drawn, std::vector<float>& light) const;
  void findPrint(TileJob& job, const Eigen::AlignedBox2d& box, double sample_nodes) const;
  [[nodiscard]] TileJob jobFor(const Sheet& sheet, int unit, const PieceSpan& piece) const;
  void addGrain(const Eigen::Isometry2d& X_NV, float board_gray, std::vector<float>& light) const;
  /// What the back light loses where a line of sight leaves it aslant.
  void dimByAngle(std::vector<float>& light) const;
};

KerfCamera::Model::Model(const CameraDescription& camera_, const PrintLayout& print_, std::uint64_t seed_)
    : camera(camera_),
      print(print_),
      seed(seed_),
      projection(camera_),
      noise(camera_.read_noise, camera_.full_well_electrons, camera_.bits),
      // The average over a pixel's area is part of the blur; the supersampling does it.
      blur(camera_.psf_sigma_px * camera_.psf_sigma_px - 1.0 / 12.0),
      foot(camera_.foot.sigma_px * camera_.foot.sigma_px),
      field(fieldOf(projection, camera_.width_px, camera_.height_px)),
      grid(projection, camera_.width_px, camera_.height_px, kKerfBlockPx),
      shading(camera_) {
  mm_per_px = 1.0 / std::sqrt(std::abs(projection.jacobianAt(field.inscribed.center()).determinant()));
  samples_per_px = std::clamp(static_cast<int>(std::ceil(mm_per_px / kSampleMm)), 3, kMostSamples);
  if (camera.texture.grain_gray > 0.0)
    grain.emplace(camera.board_seed, kKerfGrainStream, camera.texture.grain_length_mm);
}

void KerfCamera::Model::setSight(const Eigen::Isometry2d& X_NV, TileJob& job) const {
  const BoardDescription& board = job.sheet.board();
  // From V to N the plane is turned and moved, so the slope's direction turns and its zero moves.
  const SightSlope slope = projection.sightSlope();
  const Vector2d at_origin_V = slope.at(X_NV.inverse().translation());
  job.oblique.emplace(ObliqueSight{WallTable(job.sheet),
                                   grayOfLeft(job.sheet, board.transmission, camera.open_gray),
                                   grayOfLeft(job.sheet, board.print_transmission, camera.open_gray),
                                   board.thickness_mm / Sheet::kCellMm * (X_NV.linear() * at_origin_V),
                                   board.thickness_mm * slope.per_mm, 0});
}

int KerfCamera::Model::slicesOf(const ObliqueSight& sight, Eigen::AlignedBox2d& box) {
  double longest = 0.0;
  Eigen::AlignedBox2d reached = box;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    const Vector2d way = sight.through(box.corner(corner));
    longest = std::max(longest, way.norm());
    reached.extend(box.corner(corner) + way);
  }
  box = reached;
  if (longest < kSquareNodes) return 0;
  return std::max(1, static_cast<int>(std::ceil(longest / kSliceNodes)));
}

void KerfCamera::Model::blurAll(const std::vector<char>& drawn, std::vector<float>& light) const {
  blur.apply(light, camera.width_px, camera.height_px, grid.edgesX(), grid.edgesY(), drawn);
  if (!(camera.foot.share > 0.0)) return;
  std::vector<float> scattered = light;
  foot.apply(scattered, camera.width_px, camera.height_px, grid.edgesX(), grid.edgesY(), drawn);
  const auto share = static_cast<float>(camera.foot.share);
  for (std::size_t i = 0; i < light.size(); ++i) light[i] += share * (scattered[i] - light[i]);
}

void KerfCamera::Model::findPrint(TileJob& job, const Eigen::AlignedBox2d& box, double sample_nodes) const {
  job.near.clear();
  const Vector2d middle = box.center();
  const double reach = 0.5 * box.diagonal().norm() + sample_nodes;
  for (const PrintShape& shape : job.print_shapes) {
    if (shape.outside(middle.x(), middle.y()) < reach) job.near.push_back(shape);
  }
}

bool KerfCamera::Model::renderBlock(TileJob& job, const Eigen::Isometry2d& X_NV, std::size_t bx,
                                    std::size_t by, std::vector<float>& light) const {
  const PlanePatch::Nodes p_V_mm = grid.nodes(bx, by);
  PlanePatch::Nodes corners;
  Eigen::AlignedBox2d box;  // Bounds of the block, in the spline's unit.
  for (std::size_t n = 0; n < corners.size(); ++n) {
    corners[n] = (X_NV * p_V_mm[n]) / Sheet::kCellMm;
    box.extend(corners[n]);
  }
  const Eigen::AlignedBox2d face = box;
  if (job.oblique) job.oblique->slices = slicesOf(*job.oblique, box);
  // The spline needs one node less: a patch may bulge a little between its corners.
  const int margin = job.rough ? job.rough->reachNodes() : 0;
  Window& burn = job.burn;
  burn.column = static_cast<int>(std::floor(box.min().x())) - 2 - margin;
  burn.row = static_cast<int>(std::floor(box.min().y())) - 2 - margin;
  burn.columns = static_cast<int>(std::floor(box.max().x())) + 4 + margin - burn.column;
  burn.rows = static_cast<int>(std::floor(box.max().y())) + 4 + margin - burn.row;
  const bool burnt = fill(burn, job, 0.0, job.sheet.untouchedFluence_j_mm2());
  bool scorched = false;
  if (job.scorch.fitted) {
    const Vector2d& shift = job.scorch.shift_nodes;
    job.charred.column = static_cast<int>(std::floor(burn.column - shift.x()));
    job.charred.row = static_cast<int>(std::floor(burn.row - shift.y()));
    job.charred.columns = burn.columns + 1;
    job.charred.rows = burn.rows + 1;
    scorched = fill(job.charred, job, shift.x(), job.sheet.unscorchedFluence_j_mm2());
  }
  const double sample_nodes = mm_per_px / samples_per_px / Sheet::kCellMm;
  findPrint(job, face, sample_nodes);
  if (!burnt && !scorched && job.near.empty()) return false;

  const PlanePatch patch(corners);
  const PlaneGrid::Block block = grid.block(bx, by);
  if (burnt) {
    const int slices = job.oblique ? job.oblique->slices : 0;
    findWhole(static_cast<float>(job.sheet.untouchedFluence_j_mm2()),
              static_cast<int>(std::ceil(kSliceNodes * slices)), burn);
  }
  const bool rough = burnt && job.rough;
  if (rough) job.rough->fill(face);
  const auto paintBy = [&](auto scorch, auto roughness, auto oblique) {
    using Painter =
        BlockPainter<decltype(scorch)::value, decltype(roughness)::value, decltype(oblique)::value>;
    paint(block, patch, Painter(job, weights, burnt, sample_nodes), light);
  };
  const auto chosen = [](bool is, const auto& go) { is ? go(std::true_type{}) : go(std::false_type{}); };
  chosen(scorched, [&](auto scorch) {
    chosen(rough, [&](auto roughness) {
      chosen(burnt && job.oblique && job.oblique->slices > 0,
             [&](auto oblique) { paintBy(scorch, roughness, oblique); });
    });
  });
  return true;
}

template <class Painter>
void KerfCamera::Model::paint(const PlaneGrid::Block& block, const PlanePatch& patch, Painter painter,
                              std::vector<float>& light) const {
  const int samples = samples_per_px;
  const int width = block.x1 - block.x0;
  const int height = block.y1 - block.y0;
  const float share = 1.0F / static_cast<float>(samples * samples);
  SampleRow row{static_cast<std::size_t>(width * samples), {}, {}};
  RowValues across;  // Places of the samples across the block.
  const float step = 1.0F / static_cast<float>(width * samples);
  float s = 0.5F * step;
  for (std::size_t i = 0; i < row.count; ++i, s += step) across[i] = s;
  RowValues gray;
  for (int y = 0; y < height; ++y) {
    float* const line = light.data() + static_cast<std::ptrdiff_t>(block.y0 + y) * camera.width_px + block.x0;
    std::fill_n(line, width, 0.0F);
    for (int sub_y = 0; sub_y < samples; ++sub_y) {
      const double t = (y + (sub_y + 0.5) / samples) / height;
      const Eigen::Vector2f c0 = (patch.alongRow(t, 0) - painter.origin()).template cast<float>();
      const Eigen::Vector2f c1 = patch.alongRow(t, 1).cast<float>();
      const Eigen::Vector2f c2 = patch.alongRow(t, 2).cast<float>();
      for (std::size_t i = 0; i < row.count; ++i) {
        row.x[i] = c0.x() + across[i] * (c1.x() + across[i] * c2.x());
        row.y[i] = c0.y() + across[i] * (c1.y() + across[i] * c2.y());
      }
      painter.paint(row, gray);
      const float* sample = gray.data();
      for (int x = 0; x < width; ++x) {
        float sum = 0.0F;
        for (int sub_x = 0; sub_x < samples; ++sub_x) sum += *sample++;
        line[x] += sum * share;
      }
    }
  }
}

TileJob KerfCamera::Model::jobFor(const Sheet& sheet, int unit, const PieceSpan& piece) const {
  const Vector2d p_SSk_mm(-unit * print.pitch_mm, 0.0);
  const auto toNodes = [&](double x_S_mm) { return (x_S_mm + p_SSk_mm.x()) / Sheet::kCellMm; };
  const ScorchDescription& scorch = sheet.board().scorch;
  const bool scorches = scorch.fluence_j_mm2 > 0.0 && scorch.darkening > 0.0;
  TileJob job{sheet,
              grayOfFluence(sheet, sheet.board().transmission, camera.open_gray),
              grayOfFluence(sheet, sheet.board().print_transmission, camera.open_gray),
              static_cast<float>(camera.open_gray),
              static_cast<float>(1.0 / sheet.board().cut_fluence_j_mm2),
              toNodes(piece.min_x_S_mm),
              toNodes(piece.max_x_S_mm),
              {},
              {scorches, Vector2d(scorch.shift_mm[0], scorch.shift_mm[1]) / Sheet::kCellMm,
               scorches ? static_cast<float>(1.0 / scorch.fluence_j_mm2) : 0.0F,
               static_cast<float>(scorch.darkening)},
              {},
              {},
              {},
              std::nullopt,
              std::nullopt};
  if (camera.roughness.rms_mm > 0.0) job.rough.emplace(camera.board_seed, camera.roughness);
  for (const RegistrationMark& mark : print.marks) {
    const Vector2d half_mm = Vector2d::Constant(0.5 * mark.diameter_mm);
    job.print_shapes.push_back({.round = true,
                                .centre_nodes = (mark.p_SM_mm + p_SSk_mm) / Sheet::kCellMm,
                                .half_nodes = half_mm / Sheet::kCellMm});
  }
  for (const PrintedArea& area : print.areas) {
    job.print_shapes.push_back({.round = false,
                                .centre_nodes = (area.p_SA_mm + p_SSk_mm) / Sheet::kCellMm,
                                .half_nodes = 0.5 * area.size_mm / Sheet::kCellMm,
                                .cos = std::cos(area.angle_rad),
                                .sin = std::sin(area.angle_rad),
                                .ink = static_cast<float>(area.ink)});
  }
  return job;
}

void KerfCamera::Model::addGrain(const Eigen::Isometry2d& X_NV, float board_gray,
                                 std::vector<float>& light) const {
  FieldPainter painter(*grain);
  const auto open = static_cast<float>(camera.open_gray);
  const float board = std::max(board_gray, 1.0F);
  const float above_board = std::max(open - board_gray, 1.0F);
  std::vector<float> grains;
  for (std::size_t by = 0; by < grid.rows(); ++by) {
    for (std::size_t bx = 0; bx < grid.columns(); ++bx) {
      const PlaneGrid::Block block = grid.block(bx, by);
      PlanePatch::Nodes p_N_mm = grid.nodes(bx, by);
      for (Vector2d& point : p_N_mm) point = X_NV * point;
      const int width = block.x1 - block.x0;
      grains.assign(static_cast<std::size_t>(width * (block.y1 - block.y0)), 0.0F);
      painter.add(p_N_mm, width, block.y1 - block.y0, static_cast<float>(camera.texture.grain_gray), grains);
      const float* from = grains.data();
      for (int y = block.y0; y < block.y1; ++y, from += width) {
        float* const line = light.data() + static_cast<std::ptrdiff_t>(y) * camera.width_px + block.x0;
        for (int x = 0; x < width; ++x) {
          const float whole = std::min(line[x] / board, (open - line[x]) / above_board);
          line[x] += from[x] * std::max(whole, 0.0F);
        }
      }
    }
  }
}

void KerfCamera::Model::dimByAngle(std::vector<float>& light) const {
  if (!(camera.back_light_half_angle_rad > 0.0)) return;
  const SightSlope slope = projection.sightSlope();
  const double per_half_angle = 1.0 / std::tan(camera.back_light_half_angle_rad);
  for (std::size_t by = 0; by < grid.rows(); ++by) {
    for (std::size_t bx = 0; bx < grid.columns(); ++bx) {
      const PlaneGrid::Block block = grid.block(bx, by);
      const PlanePatch patch(grid.nodes(bx, by));
      for (int y = block.y0; y < block.y1; ++y) {
        const double down = (y - block.y0 + 0.5) / (block.y1 - block.y0);
        const Vector2d c0 = patch.alongRow(down, 0);
        const Vector2d c1 = patch.alongRow(down, 1);
        const Vector2d c2 = patch.alongRow(down, 2);
        float* const line = light.data() + static_cast<std::ptrdiff_t>(y) * camera.width_px;
        for (int x = block.x0; x < block.x1; ++x) {
          const double s = (x - block.x0 + 0.5) / (block.x1 - block.x0);
          const double aslant = per_half_angle * slope.at(c0 + s * (c1 + s * c2)).norm();
          line[x] *= static_cast<float>(std::exp2(-aslant * aslant));
        }
      }
    }
  }
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
  // Origin of the unit's frame Sk in S of unit 0, where the sheet keeps its burns; N is that frame too.
  const Vector2d p_SSk_mm(-unit * model.print.pitch_mm, 0.0);
  const Eigen::Isometry2d X_NV =
      Eigen::Translation2d(p_SSk_mm) * X_TS.inverse() * Eigen::Translation2d(p_TV_mm);
  const Vector2d middle = X_NV * model.field.circumscribed.center();
  if (!X_NV.matrix().allFinite() || !(middle.cwiseAbs().maxCoeff() < kFarMm)) {
    throw std::invalid_argument("KerfCamera::render: tile or sheet out of reach");
  }
  TileJob job = model.jobFor(sheet, unit, piece);
  model.setSight(X_NV, job);
  std::vector<float> light(
      static_cast<std::size_t>(model.camera.width_px) * static_cast<std::size_t>(model.camera.height_px),
      job.board.at(0.0F));
  const std::size_t blocks_x = model.grid.columns();
  std::vector<char> drawn(blocks_x * model.grid.rows(), 0);
  for (std::size_t by = 0; by < model.grid.rows(); ++by) {
    for (std::size_t bx = 0; bx < blocks_x; ++bx) {
      if (model.renderBlock(job, X_NV, bx, by, light)) drawn[by * blocks_x + bx] = 1;
    }
  }
  model.blurAll(drawn, light);
  if (model.grain) model.addGrain(X_NV, job.board.at(0.0F), light);
  model.dimByAngle(light);
  const PixelWindow whole{0, 0, model.camera.width_px, model.camera.height_px};
  model.shading.shadeByLamp(whole, light);
  model.shading.shadeByLens(whole, light);
  model.shading.addHotPixels(light);

  const auto nanometres = [](double mm) { return static_cast<std::uint64_t>(std::llround(mm * 1e6)); };
  const CounterRandom place(static_cast<std::uint64_t>(unit), nanometres(p_TV_mm.x()));
  const CounterRandom random(model.seed ^ kTileSeed, place.bits(nanometres(p_TV_mm.y())));
  return model.noise.picture(light, model.camera.width_px, model.camera.height_px, random);
}

}  // namespace kerfbench::twin
