// SPDX-License-Identifier: Apache-2.0
#pragma once

// Figures of a head's report, as SVG.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::head_service {

/// Error of the beam at a wanted place.
struct PlaceError {
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d e_mm{Eigen::Vector2d::Zero()};
};

/// "9.19 mm", "6.2 µm"
std::string lengthText(double mm);

/// Factor by which errors are drawn larger: 1, 2 or 5 times a power of ten, so that the largest is less than
/// a twelfth of the field's longer side. 1 where there is no error.
double exaggerationFor(double largest_mm, const Eigen::AlignedBox2d& field_W_mm);

/// The field as the beam draws it, exaggerated: `error_mm` at any place, nullopt where it does not get to;
/// and the marks, as measured.
std::string deformedGrid(
    const Eigen::AlignedBox2d& field_W_mm,
    const std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>& error_mm,
    const std::vector<PlaceError>& marks);

/// Each error as an arrow, exaggerated, in the colour of its share of the limit.
std::string errorArrows(const Eigen::AlignedBox2d& field_W_mm, const std::vector<PlaceError>& errors,
                        double limit_mm);

/// Histogram of the errors of places, with the limit; empty for no errors.
std::string errorHistogram(const std::vector<PlaceError>& errors, double limit_mm);

/// Errors along x and y, with the limit as a circle; empty for no errors.
std::string errorScatter(const std::vector<PlaceError>& errors, double limit_mm);

}  // namespace kerfbench::head_service
