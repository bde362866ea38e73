// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

namespace kerfbench::dieline {

enum class FileFormat { kDxf, kSvg, kCf2, kPdf };

/// The format of a drawing by its extension: .dxf, .svg, .cf2, .cff, .cff2, .pdf. A file with another one is
/// a PDF or CF2 if it begins as these do, as Illustrator's .ai may. Nothing for all others, and for those
/// that cannot be read.
std::optional<FileFormat> fileFormatOf(const std::filesystem::path& path);

}  // namespace kerfbench::dieline
