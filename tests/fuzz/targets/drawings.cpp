// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

bool drawing(std::string_view name, Bytes bytes) {
  return takes<dieline::DielineError>(
      [&] { (void)dieline::readDieline(asFile(name, bytes), dieline::DrawingOptions()); });
}

}  // namespace

bool drawingDxf(Bytes bytes) { return drawing("drawing.dxf", bytes); }
bool drawingSvg(Bytes bytes) { return drawing("drawing.svg", bytes); }
bool drawingPdf(Bytes bytes) { return drawing("drawing.pdf", bytes); }
bool drawingCf2(Bytes bytes) { return drawing("drawing.cf2", bytes); }

}  // namespace kerfbench::fuzz
