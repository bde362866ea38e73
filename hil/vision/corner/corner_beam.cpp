// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_beam.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "twin/base/multiversion.h"
#include "twin/base/wide_math.h"

namespace kerfbench::vision {
namespace {

constexpr int kModelArcPieces = 12;
constexpr float kFarRadii = 2.4F;  // Farther off there is less than 1e-5 of the middle.
constexpr float kFarPiece = 2.0F * kFarRadii * kFarRadii;
constexpr float kSqrt2 = std::numbers::sqrt2_v<float>;
constexpr float kSqrt2OverPi = kSqrt2 * std::numbers::inv_sqrtpi_v<float>;

/// Numbers of a leg as a loop over many places wants them, or how fast they change.
struct LegNumbers {
  float peak, end_mm, per_radius, cosine, offset_mm, slope, half_curvature, sixth_twist;

  explicit LegNumbers(const LegBeam& leg)
      : peak(static_cast<float>(leg.peak)),
        end_mm(static_cast<float>(leg.end_mm)),
        per_radius(static_cast<float>(leg.per_radius)),
        cosine(static_cast<float>(leg.cosine)),
        offset_mm(static_cast<float>(leg.offset_mm)),
        slope(static_cast<float>(leg.slope)),
        half_curvature(static_cast<float>(leg.half_curvature)),
        sixth_twist(static_cast<float>(leg.sixth_twist)) {}

  /// Offset of the line; before the corner it runs straight on.
  [[nodiscard]] float lineAt(float along_mm) const {
    const float bent_mm = along_mm > 0.0F ? along_mm : 0.0F;
    return offset_mm + slope * along_mm + bent_mm * bent_mm * (half_curvature + sixth_twist * bent_mm);
  }
};

/// Light of a leg at a place.
struct LightOfLeg {
  float off;  ///< Distance from the line, in radii.
  float light;

  [[gnu::always_inline]] LightOfLeg(const LegNumbers& leg, float along_mm, float beside_mm) {
    const float beyond = (leg.end_mm - along_mm) * leg.per_radius;
    off = (beside_mm - leg.lineAt(along_mm)) * leg.cosine * leg.per_radius;
    // Not a number falls to the bound as well.
    const float n2 = off * off < kFarRadii * kFarRadii ? off * off : kFarRadii * kFarRadii;
    const float near = beyond > -kFarRadii ? beyond : -kFarRadii;
    const float end = near < kFarRadii ? near : kFarRadii;
    const float across = leg.peak * wideExp(-2.0F * n2);
    const float reaching = end > -kFarRadii ? across * 0.5F * wideErfc(kSqrt2 * end) : across;
    const bool seen = n2 < kFarRadii * kFarRadii && end < kFarRadii;
    light = seen ? reaching : 0.0F;
  }
};

KERFBENCH_WIDE void addLeg(const LegNumbers& leg, const std::vector<float>& along_mm,
                           const std::vector<float>& beside_mm, std::vector<float>& share) {
  const float* const along = along_mm.data();
  const float* const beside = beside_mm.data();
  float* const sum = share.data();
  const std::size_t count = share.size();
  for (std::size_t i = 0; i < count; ++i) sum[i] += LightOfLeg(leg, along[i], beside[i]).light;
}

KERFBENCH_WIDE void setLeg(LegNumbers leg, const std::vector<float>& along_mm,
                           const std::vector<float>& beside_mm, std::vector<float>& off,
                           std::vector<float>& light) {
  const float* const along = along_mm.data();
  const float* const beside = beside_mm.data();
  float* const off_at = off.data();
  float* const light_at = light.data();
  const std::size_t count = along_mm.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LightOfLeg place(leg, along[i], beside[i]);
    off_at[i] = place.off;
    light_at[i] = place.light;
  }
}

/// Sets the derivative of a leg's light by the distance beyond its end, in radii.
KERFBENCH_WIDE void setEdge(LegNumbers leg, const std::vector<float>& along_mm, const std::vector<float>& off,
                            const std::vector<float>& light, std::vector<float>& edge) {
  const float* const along = along_mm.data();
  const float* const off_at = off.data();
  const float* const light_at = light.data();
  float* const edge_at = edge.data();
  const std::size_t count = along_mm.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float beyond = (leg.end_mm - along[i]) * leg.per_radius;
    const bool ends = light_at[i] > 0.0F && beyond * beyond < kFarRadii * kFarRadii;
    const float d2 = ends ? off_at[i] * off_at[i] + beyond * beyond : 0.0F;
    const float slope = -kSqrt2OverPi * leg.peak * wideExp(-2.0F * d2);
    edge_at[i] = ends ? slope : 0.0F;
  }
}

/// Factors of a leg's change: of the logarithm of its light, and of lengths in radii.
struct LegRate {
  float log_peak, log_across, log_along;
  LegNumbers line;  ///< Changes of line and end, in radii.
};

LegRate rateOf(const LegBeam& leg, const LegBeam& next, double step) {
  const auto rate = [step](double from, double to) { return (to - from) / step; };
  const double across_per_mm = leg.cosine * leg.per_radius;
  const auto ofLine = [&](double from, double to) { return rate(from, to) * across_per_mm; };
  LegBeam line;
  line.end_mm = rate(leg.end_mm, next.end_mm) * leg.per_radius;
  line.offset_mm = ofLine(leg.offset_mm, next.offset_mm);
  line.slope = ofLine(leg.slope, next.slope);
  line.half_curvature = ofLine(leg.half_curvature, next.half_curvature);
  line.sixth_twist = ofLine(leg.sixth_twist, next.sixth_twist);
  return {static_cast<float>(rate(leg.peak, next.peak) / leg.peak),
          static_cast<float>(rate(across_per_mm, next.cosine * next.per_radius) / across_per_mm),
          static_cast<float>(rate(leg.per_radius, next.per_radius) / leg.per_radius), LegNumbers(line)};
}

/// Where the light of a leg is and what it is, as BesideLeg has it.
struct LegParts {
  const float *along_mm, *off, *light, *edge;
};

/// Adds the derivative of a leg's light.
KERFBENCH_WIDE void addLegRate(const LegBeam& leg, const LegRate& rate, const LegParts& parts,
                               std::vector<float>& share_rate) {
  const float end_mm = static_cast<float>(leg.end_mm);
  const float per_radius = static_cast<float>(leg.per_radius);
  float* const sum = share_rate.data();
  const std::size_t count = share_rate.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float along = parts.along_mm[i];
    const float off = parts.off[i];
    const float off_rate = off * rate.log_across - rate.line.lineAt(along);
    const float end_rate = rate.line.end_mm + (end_mm - along) * per_radius * rate.log_along;
    sum[i] += parts.light[i] * (rate.log_peak - 4.0F * off * off_rate) + parts.edge[i] * end_rate;
  }
}

struct PieceNumbers {
  float x_mm, y_mm, share;

  explicit PieceNumbers(const ArcPiece& piece)
      : x_mm(static_cast<float>(piece.p_mm.x())),
        y_mm(static_cast<float>(piece.p_mm.y())),
        share(static_cast<float>(piece.share)) {}

  [[nodiscard, gnu::always_inline]] float lightAt(float x, float y, float per_radius2) const {
    const float dx = x - x_mm;
    const float dy = y - y_mm;
    const float d2 = (dx * dx + dy * dy) * per_radius2;
    const float near = d2 < kFarPiece ? d2 : kFarPiece;
    return near < kFarPiece ? share * wideExp(-near) : 0.0F;
  }
};

KERFBENCH_WIDE void addPiece(const PieceNumbers& piece, float per_radius2, const std::vector<float>& x_mm,
                             const std::vector<float>& y_mm, std::vector<float>& share) {
  const float* const x = x_mm.data();
  const float* const y = y_mm.data();
  float* const sum = share.data();
  const std::size_t count = share.size();
  for (std::size_t i = 0; i < count; ++i) sum[i] += piece.lightAt(x[i], y[i], per_radius2);
}

/// Change of a piece's light: of its logarithm, per mm of its move, and of the logarithm of 2/w².
struct PieceRate {
  float log_share, x_mm, y_mm, log_per_radius2;
};

/// Adds the derivative of a piece's light.
KERFBENCH_WIDE void addPieceRate(const PieceNumbers& piece, const PieceRate& rate, float per_radius2,
                                 const std::vector<float>& x_mm, const std::vector<float>& y_mm,
                                 const std::vector<float>& light, std::vector<float>& share_rate) {
  const float* const x = x_mm.data();
  const float* const y = y_mm.data();
  const float* const shines = light.data();
  float* const sum = share_rate.data();
  const std::size_t count = share_rate.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - piece.x_mm;
    const float dy = y[i] - piece.y_mm;
    const float moved = 2.0F * (dx * rate.x_mm + dy * rate.y_mm) - (dx * dx + dy * dy) * rate.log_per_radius2;
    sum[i] += shines[i] * (rate.log_share + per_radius2 * moved);
  }
}

float perRadius2(const CornerBeam& beam) {
  return static_cast<float>(2.0 * beam.in.per_radius * beam.in.per_radius);
}

LegBeam legBeam(const CornerLeg& leg, double peak, double end_mm, double radius_mm) {
  return {.peak = peak,
          .end_mm = end_mm,
          .per_radius = 1.0 / radius_mm,
          .cosine = 1.0 / std::hypot(1.0, leg.slope),
          .offset_mm = leg.offset_mm,
          .slope = leg.slope,
          .half_curvature = leg.curvature_per_mm / 2.0,
          .sixth_twist = leg.twist_per_mm2 / 6.0};
}

}  // namespace

CornerBeam::CornerBeam(CornerShape shape, const CornerLight& light) {
  shape.in.offset_mm += light.scorch_in_mm;
  shape.out.offset_mm += light.scorch_out_mm;
  const CornerPath path = pathOf(shape, 2 * kModelArcPieces);
  in = legBeam(shape.in, light.peak_in, path.end_in_mm, light.beam_radius_mm);
  out = legBeam(shape.out, light.peak_out, path.end_out_mm, light.beam_radius_mm);
  const double per_mm =
      0.5 * (light.peak_in + light.peak_out) * std::sqrt(2.0 / std::numbers::pi) / light.beam_radius_mm;
  for (std::size_t i = 1; i < path.arc.size(); i += 2) {
    const double length_mm = (path.arc[i] - path.arc[i - 1]).norm() + (path.arc[i + 1] - path.arc[i]).norm();
    arc.push_back({path.arc[i], per_mm * length_mm});
  }
}

void CornerFluence::addPlace(const Eigen::Vector2d& p_mm) {
  x_mm_.push_back(static_cast<float>(p_mm.x()));
  y_mm_.push_back(static_cast<float>(p_mm.y()));
  const auto add = [&](const CornerLeg& leg, BesideLeg& to) {
    const CornerLeg::Place place = leg.placeOf(p_mm);
    to.along_mm.push_back(static_cast<float>(place.along_mm));
    to.beside_mm.push_back(static_cast<float>(place.beside_mm));
  };
  add(legs_.in, in_);
  add(legs_.out, out_);
}

void CornerFluence::compute(const CornerBeam& beam, std::vector<float>& share) const {
  share.assign(x_mm_.size(), 0.0F);
  addLeg(LegNumbers(beam.in), in_.along_mm, in_.beside_mm, share);
  addLeg(LegNumbers(beam.out), out_.along_mm, out_.beside_mm, share);
  for (const ArcPiece& piece : beam.arc) addPiece(PieceNumbers(piece), perRadius2(beam), x_mm_, y_mm_, share);
}

void CornerFluence::linearizeAt(const CornerBeam& beam, std::vector<float>& share) {
  beam_ = beam;
  share.assign(x_mm_.size(), 0.0F);
  const auto addPart = [&](const std::vector<float>& light) {
    for (std::size_t i = 0; i < share.size(); ++i) share[i] += light[i];
  };
  const auto ofLeg = [&](const LegBeam& leg, BesideLeg& at) {
    for (std::vector<float>* part : {&at.off, &at.light, &at.edge}) part->resize(x_mm_.size());
    setLeg(LegNumbers(leg), at.along_mm, at.beside_mm, at.off, at.light);
    setEdge(LegNumbers(leg), at.along_mm, at.off, at.light, at.edge);
    addPart(at.light);
  };
  ofLeg(beam.in, in_);
  ofLeg(beam.out, out_);
  arc_light_.resize(beam.arc.size());
  for (std::size_t i = 0; i < beam.arc.size(); ++i) {
    arc_light_[i].assign(x_mm_.size(), 0.0F);
    addPiece(PieceNumbers(beam.arc[i]), perRadius2(beam), x_mm_, y_mm_, arc_light_[i]);
    addPart(arc_light_[i]);
  }
}

void CornerFluence::rateTowards(const CornerBeam& next, double step, std::vector<float>& share_rate) const {
  share_rate.assign(x_mm_.size(), 0.0F);
  const auto addOfLeg = [&](const LegBeam& from, const LegBeam& to, const BesideLeg& at) {
    if (from == to) return;
    addLegRate(from, rateOf(from, to, step),
               {at.along_mm.data(), at.off.data(), at.light.data(), at.edge.data()}, share_rate);
  };
  addOfLeg(beam_.in, next.in, in_);
  addOfLeg(beam_.out, next.out, out_);
  const double radius_ratio = next.in.per_radius / beam_.in.per_radius;
  const double log_per_radius2 = (radius_ratio * radius_ratio - 1.0) / step;
  if (beam_.arc == next.arc && log_per_radius2 == 0.0) return;
  for (std::size_t i = 0; i < beam_.arc.size(); ++i) {
    const ArcPiece& piece = beam_.arc[i];
    const Eigen::Vector2d move = (next.arc[i].p_mm - piece.p_mm) / step;
    const PieceRate rate{static_cast<float>((next.arc[i].share / piece.share - 1.0) / step),
                         static_cast<float>(move.x()), static_cast<float>(move.y()),
                         static_cast<float>(log_per_radius2)};
    addPieceRate(PieceNumbers(piece), rate, perRadius2(beam_), x_mm_, y_mm_, arc_light_[i], share_rate);
  }
}

}  // namespace kerfbench::vision
