// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// A region that limits what is drawn, as closed polygons in mm.
struct PdfRegion {
  std::vector<std::vector<Eigen::Vector2d>> polygons_mm;
  bool is_even_odd{};
};

/// Everything that limits what is drawn at a place: a box, and regions that are no box. Cheap to copy.
class PdfClip {
 public:
  explicit PdfClip(const Eigen::AlignedBox2d& box_mm) : box_mm_(box_mm) {}

  /// The clip within which only `region` is drawn as well.
  [[nodiscard]] PdfClip within(PdfRegion region) const;
  /// Number of regions that are no box.
  [[nodiscard]] std::size_t regions() const { return regions_ ? regions_->number : 0; }

  enum class Side { kInside, kOutside, kAcross };
  /// On which side a curve lies. Along an edge it is inside, to 0.01 mm: there a half of a stroke is seen.
  /// `work` is raised by the number of places that were looked at.
  [[nodiscard]] Side sideOf(const Curve& curve, std::size_t& work) const;

 private:
  struct Link {
    PdfRegion region;
    std::shared_ptr<const Link> outer;
    std::size_t number{};
  };

  Eigen::AlignedBox2d box_mm_;
  std::shared_ptr<const Link> regions_;
};

}  // namespace kerfbench::dieline
