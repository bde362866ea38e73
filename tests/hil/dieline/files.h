// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

/// A drawing on disk for the life of a test.
class TempFile {
 public:
  TempFile(const std::string& extension, const std::string& text) {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("kerfbench-dieline-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + extension);
    std::ofstream(path_, std::ios::binary) << text;
  }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  ~TempFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline Dieline readText(const std::string& extension, const std::string& text,
                        const LayerProfile& profile = defaultLayerProfile()) {
  const TempFile file(extension, text);
  return readDieline(file.path(), profile);
}

inline Dieline readText(const std::string& extension, const std::string& text,
                        const DrawingOptions& options) {
  const TempFile file(extension, text);
  return readDieline(file.path(), options);
}

/// Faults reported for a broken file; empty when it is read.
inline std::string faultsOf(const std::string& extension, const std::string& text,
                            const DrawingOptions& options = {}) {
  try {
    readText(extension, text, options);
  } catch (const DielineError& error) {
    return error.what();
  }
  return {};
}

inline std::filesystem::path fixture(const std::string& name) {
  return std::filesystem::path(KERFBENCH_SOURCE_DIR) / "fixtures/dielines" / name;
}

/// Lines of a DXF from "0|LINE|8|CUT".
inline std::string dxfLines(std::string text) {
  std::replace(text.begin(), text.end(), '|', '\n');
  return text + "\n";
}
/// A DXF of entities and, before them, header variables and blocks.
inline std::string dxf(const std::string& entities, const std::string& header = "",
                       const std::string& blocks = "") {
  std::string text;
  if (!header.empty()) text += dxfLines("0|SECTION|2|HEADER|" + header + "|0|ENDSEC");
  if (!blocks.empty()) text += dxfLines("0|SECTION|2|BLOCKS|" + blocks + "|0|ENDSEC");
  text += dxfLines("0|SECTION|2|ENTITIES");
  if (!entities.empty()) text += dxfLines(entities);
  return text + dxfLines("0|ENDSEC|0|EOF");
}
/// An SVG of 100 x 50 mm with one user unit per mm.
inline std::string svg(const std::string& body,
                       const std::string& attributes = "width='100mm' height='50mm' viewBox='0 0 100 50'") {
  return "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' "
         "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' " +
         attributes + ">\n" + body + "\n</svg>\n";
}

/// Largest distance of two curves at equal shares of their parameter.
inline double apart(const Curve& a, const Curve& b) {
  double worst = 0;
  for (int i = 0; i <= 50; ++i) worst = std::max(worst, (pointAt(a, i / 50.0) - pointAt(b, i / 50.0)).norm());
  return worst;
}

}  // namespace kerfbench::dieline
