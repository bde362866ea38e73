// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/dieline/faults.h"

namespace kerfbench::dieline {

/// Most bytes of a PDF, and most of what the page draws after it is unpacked, all forms together.
inline constexpr std::size_t kLargestPdf = 64U << 20U;
inline constexpr std::size_t kLargestPdfContent = 64U << 20U;

/// Colours of a stroke (ISO 32000-1, 8.6).
struct PdfColourSpace {
  enum class Kind { kGray, kRgb, kCmyk, kSpot, kPattern, kOther };
  Kind kind{Kind::kOther};
  std::size_t components{};
  std::vector<std::string> inks;  ///< Names of a Separation or DeviceN.
  std::string name;               ///< For messages, "Lab".
};

/// An optional content group, which programs call a layer (ISO 32000-1, 8.11).
struct PdfGroup {
  std::string name;
  bool is_visible{true};
  /// Processing step of ISO 19593-1, "Structural" and "Cutting"; empty if it is none.
  std::string step_group;
  std::string step_type;
};

/// What a marked section or a form belongs to.
struct PdfMembership {
  std::vector<std::size_t> groups;  ///< Places in PdfDocument::groups.
  bool is_visible{true};
};

/// Parameters of a named graphics state.
struct PdfStateChange {
  std::optional<double> stroke_opacity;
  std::optional<bool> has_dashes;
  std::optional<bool> has_mask;
};

/// What a content stream can name.
struct PdfResources {
  std::map<std::string, PdfColourSpace, std::less<>> colours;
  std::map<std::string, PdfMembership, std::less<>> sections;
  std::map<std::string, PdfStateChange, std::less<>> states;
  std::map<std::string, std::size_t, std::less<>> forms;   ///< Places in PdfDocument::contents.
  std::map<std::string, std::string, std::less<>> others;  ///< Other XObjects and what they are, "Image".
};

/// The page's content, or a form's.
struct PdfContent {
  std::string operators;                           ///< Unpacked.
  Eigen::Affine2d X{Eigen::Affine2d::Identity()};  ///< A form's, into the content that draws it.
  std::optional<Eigen::AlignedBox2d> box;          ///< A form's; clips what it draws.
  std::optional<PdfMembership> membership;         ///< A form's.
  std::size_t resources{};                         ///< Place in PdfDocument::resources.
};

/// All of a PDF with one page that decides what the page draws, without a reference to the file.
struct PdfDocument {
  Eigen::Affine2d X{Eigen::Affine2d::Identity()};  ///< Default user space -> mm in S, y up.
  Eigen::AlignedBox2d page_mm;                     ///< What a viewer shows, in S; from (0, 0).
  std::vector<PdfContent> contents;                ///< The page's first.
  std::vector<PdfResources> resources;
  std::vector<PdfGroup> groups;
  std::size_t annotations{};
  std::vector<std::string> warnings;  ///< What the library says of the file.
};

/// Reads a page, which must be named (from 1) where the file has several. The origin of S is the lower left
/// corner of the page as it is shown: its CropBox, turned by Rotate.
/// @throws DielineError for a file that is encrypted, broken or too large, that has not the page, or several
/// without one being named.
PdfDocument readPdfDocument(const std::string& bytes, std::optional<int> page, FaultList& faults);

}  // namespace kerfbench::dieline
