// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/dxf_entities.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/spline.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kFlat = 1e-6;  // Drawing units; more height than this is a drawing in space.

/// The counter-clockwise way from one angle to another, in (0, 2 pi]; equal angles are a full turn.
double sweepBetween(double start_rad, double end_rad) {
  const double sweep = std::fmod(end_rad - start_rad, 2 * pi);
  return sweep <= 1e-12 ? sweep + 2 * pi : sweep;
}

class Reader {
 public:
  Reader(const std::vector<DxfRecord>& records, std::size_t index, FaultList& faults, NoteList& notes)
      : records_(records),
        index_(index),
        record_(records[index]),
        fields_(record_, faults),
        faults_(faults),
        notes_(notes) {}

  std::vector<DxfCurve> read() {
    const std::string_view type = record_.type();
    if (type == "LINE") {
      line();
    } else if (type == "ARC") {
      arc();
    } else if (type == "CIRCLE") {
      circle();
    } else if (type == "ELLIPSE") {
      ellipse();
    } else if (type == "LWPOLYLINE") {
      lightPolyline();
    } else if (type == "POLYLINE") {
      polyline();
    } else if (type == "SPLINE") {
      spline();
    } else {
      throw DxfUnsupported(fmt::format("{} is not a curve this reader takes", type));
    }
    return std::move(curves_);
  }

 private:
  struct Vertex {
    Vector2d p;
    double bulge{};
  };

  [[nodiscard]] std::string origin() const {
    return fmt::format("line {}: {}", record_.line(), record_.type());
  }
  void emit(Curve curve) { curves_.push_back({std::move(curve), origin()}); }
  void emitPart(Curve curve, std::string_view part, std::size_t number) {
    curves_.push_back({std::move(curve), fmt::format("{} {} {}", origin(), part, number)});
  }

  /// A radius, or 0 after a fault or for a dot.
  double radius() {
    const double r = fields_.number(40);
    if (r == 0.0)
      notes_.add(record_.line(), fmt::format("{} of radius 0", record_.type()), "left out: nothing to cut");
    else if (!(r > 0))
      faults_.add(record_.line(), fmt::format("{} has radius {}", record_.type(), r));
    return r > 0 ? r : 0.0;
  }

  void line() {
    const Vector2d a(fields_.number(10), fields_.number(20));
    const Vector2d b(fields_.number(11), fields_.number(21));
    if (std::abs(fields_.number(31, 0.0) - fields_.number(30, 0.0)) > kFlat)
      throw DxfUnsupported("LINE is not flat in z");
    emit(LineCurve{a, b});
  }

  void arc() {
    const double sign = extrusionSign(record_, faults_);
    const Vector2d c(sign * fields_.number(10), fields_.number(20));
    const double r = radius();
    const double start = fields_.number(50) * pi / 180;
    const double sweep = sweepBetween(start, fields_.number(51) * pi / 180);
    if (r <= 0) return;
    emit(sign > 0 ? ArcCurve{c, r, start, sweep} : ArcCurve{c, r, pi - start, -sweep});
  }

  void circle() {
    const double sign = extrusionSign(record_, faults_);
    const Vector2d c(sign * fields_.number(10), fields_.number(20));
    const double r = radius();
    if (r > 0) emit(ArcCurve{c, r, 0.0, 2 * pi});
  }

  void ellipse() {
    // Centre and axis are in the world frame; the extrusion direction only says on which side the minor axis
    // lies.
    const double sign = extrusionSign(record_, faults_);
    const Vector2d c(fields_.number(10), fields_.number(20));
    const Vector2d major(fields_.number(11), fields_.number(21));
    if (std::abs(fields_.number(31, 0.0)) > kFlat) throw DxfUnsupported("ELLIPSE is not flat in z");
    const double ratio = fields_.number(40);
    const double start = fields_.number(41, 0.0);
    const double sweep = sweepBetween(start, fields_.number(42, 2 * pi));
    if (!(major.norm() > 0) || !(ratio > 0)) {
      faults_.add(record_.line(), "ELLIPSE without extent, or its ratio is not > 0");
      return;
    }
    if (ratio > 1 + 1e-6)
      notes_.add(record_.line(), "ELLIPSE with a ratio above 1",
                 "read with the second axis as the longer one");
    const Vector2d minor = sign * ratio * Vector2d(-major.y(), major.x());
    if (std::abs(ratio - 1) < 1e-12) {
      emit(ArcCurve{c, major.norm(), std::atan2(major.y(), major.x()) + sign * start, sign * sweep});
    } else {
      emit(EllipseCurve{c, major, minor, start, sweep});
    }
  }

  void lightPolyline() {
    const double sign = extrusionSign(record_, faults_);
    std::vector<Vertex> vertices;
    bool has_y = true;
    for (const DxfTag& tag : record_.tags) {
      if (tag.code == 10) {
        if (!has_y) faults_.add(tag.line, "LWPOLYLINE vertex without y");
        vertices.push_back({Vector2d(sign * dxfNumber(tag, faults_), 0.0)});
        has_y = false;
      } else if (tag.code == 20 && !has_y) {
        vertices.back().p.y() = dxfNumber(tag, faults_);
        has_y = true;
      } else if (tag.code == 42 && !vertices.empty()) {
        vertices.back().bulge = sign * dxfNumber(tag, faults_);
      }
    }
    if (!has_y) faults_.add(record_.line(), "LWPOLYLINE vertex without y");
    const int announced = fields_.integer(90, static_cast<int>(vertices.size()));
    if (announced != static_cast<int>(vertices.size())) {
      faults_.add(record_.line(),
                  fmt::format("LWPOLYLINE announces {} vertices and has {}", announced, vertices.size()));
    }
    segments(vertices, (fields_.integer(70, 0) & 1) != 0);
  }

  void polyline() {
    constexpr int kClosed = 1;
    constexpr int kInSpace = 8;
    constexpr int kMesh = 16 | 64;
    const int flags = fields_.integer(70, 0);
    if ((flags & kMesh) != 0) throw DxfUnsupported("POLYLINE is a mesh");
    const double sign = (flags & kInSpace) != 0 ? 1.0 : extrusionSign(record_, faults_);
    std::vector<Vertex> vertices;
    std::optional<double> height;
    for (std::size_t i = index_ + 1; i < records_.size() && records_[i].type() == "VERTEX"; ++i) {
      const DxfFields vertex(records_[i], faults_);
      constexpr int kSplineFrame =
          16;  // A control point that was kept beside the points of the smoothed curve.
      if ((vertex.integer(70, 0) & kSplineFrame) != 0) continue;
      const double z = vertex.number(30, 0.0);
      if ((flags & kInSpace) != 0 && std::abs(z - height.value_or(z)) > kFlat)
        throw DxfUnsupported("POLYLINE is not flat in z");
      height = z;
      vertices.push_back(
          {Vector2d(sign * vertex.number(10), vertex.number(20)), sign * vertex.number(42, 0.0)});
    }
    segments(vertices, (flags & kClosed) != 0);
  }

  void segments(const std::vector<Vertex>& vertices, bool closed) {
    if (vertices.size() < 2) {
      notes_.add(record_.line(), fmt::format("{} with fewer than 2 vertices", record_.type()),
                 "left out: there is no line in it");
      return;
    }
    const std::size_t count = closed ? vertices.size() : vertices.size() - 1;
    for (std::size_t i = 0; i < count; ++i) {
      const Vertex& from = vertices[i];
      const Vertex& to = vertices[(i + 1) % vertices.size()];
      // A closed polyline that repeats its first vertex at the end has no segment between the two.
      if (i + 1 == vertices.size() && (to.p - from.p).norm() < 1e-9) continue;
      emitPart(segment(from.p, to.p, from.bulge), "segment", i + 1);
    }
  }

  /// The bulge is tan(sweep / 4).
  static Curve segment(const Vector2d& a, const Vector2d& b, double bulge) {
    const Vector2d chord = b - a;
    if (std::abs(bulge) < 1e-12 || chord.norm() == 0) return LineCurve{a, b};
    const Vector2d left(-chord.y(), chord.x());
    const Vector2d centre = (a + b) / 2 + left * (1 - bulge * bulge) / (4 * bulge);
    const Vector2d r = a - centre;
    return ArcCurve{centre, chord.norm() * (1 + bulge * bulge) / (4 * std::abs(bulge)),
                    std::atan2(r.y(), r.x()), 4 * std::atan(bulge)};
  }

  void spline() {
    Nurbs s;
    s.degree = fields_.integer(71, 3);
    std::optional<double> height;
    for (const DxfTag& tag : record_.tags) {
      switch (tag.code) {
        case 40:
          s.knots.push_back(dxfNumber(tag, faults_));
          break;
        case 41:
          s.weights.push_back(dxfNumber(tag, faults_));
          break;
        case 10:
          s.control_mm.emplace_back(dxfNumber(tag, faults_), 0.0);
          break;
        case 20:
          if (!s.control_mm.empty()) s.control_mm.back().y() = dxfNumber(tag, faults_);
          break;
        case 30: {
          const double z = dxfNumber(tag, faults_);
          if (std::abs(z - height.value_or(z)) > kFlat) throw DxfUnsupported("SPLINE is not flat in z");
          height = z;
          break;
        }
        default:
          break;
      }
    }
    if (s.control_mm.empty()) throw DxfUnsupported("SPLINE has fit points only; save it with control points");
    if (s.weights.empty()) s.weights.assign(s.control_mm.size(), 1.0);
    try {
      std::size_t span = 0;
      for (Curve& curve : toBeziers(s)) emitPart(std::move(curve), "span", ++span);
    } catch (const std::invalid_argument& error) {
      throw DxfUnsupported(fmt::format("SPLINE: {}", error.what()));
    }
  }

  const std::vector<DxfRecord>& records_;
  std::size_t index_;
  DxfRecord record_;
  DxfFields fields_;
  FaultList& faults_;
  NoteList& notes_;
  std::vector<DxfCurve> curves_;
};

}  // namespace

double extrusionSign(const DxfRecord& record, FaultList& faults) {
  const DxfFields fields(record, faults);
  const double x = fields.number(210, 0.0);
  const double y = fields.number(220, 0.0);
  const double z = fields.number(230, 1.0);
  if (z == 0 || std::abs(x) > 1e-9 * std::abs(z) || std::abs(y) > 1e-9 * std::abs(z)) {
    throw DxfUnsupported(fmt::format("{} lies in a tilted plane", record.type()));
  }
  return z > 0 ? 1.0 : -1.0;
}

std::vector<DxfCurve> dxfCurves(const std::vector<DxfRecord>& records, std::size_t index, FaultList& faults,
                                NoteList& notes) {
  return Reader(records, index, faults, notes).read();
}

}  // namespace kerfbench::dieline
