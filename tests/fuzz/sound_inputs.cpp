// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/sound_inputs.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "hil/camera/png.h"
#include "hil/source/analyser/sr_file.h"
#include "hil/source/vcd.h"
#include "hil/trace/trace_file.h"
#include "tests/fuzz/targets.h"
#include "tests/hil/dieline/pdf_writer.h"
#include "tests/hil/source/vcd_sample.h"
#include "twin/base/image.h"

namespace kerfbench::fuzz {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

namespace {

std::string pictureBytes() {
  GrayImage image(5, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(13 * i);
  const std::vector<std::uint8_t> png = camera::encodePng(image);
  return {png.begin(), png.end()};
}

std::string recordingAs(const char* name) {
  const fs::path path = asFile(name, std::string_view());
  const source::PinRecording recording = source::sampleRecording(20, {1, 1'000'000});
  if (path.extension() == ".sr") {
    source::writeSr(path, recording, source::sampleMap());
  } else {
    (void)source::writeVcd(path, recording, source::sampleMap());
  }
  return contentOf(path);
}

std::string traceBytes() {
  const fs::path path = asFile("sound.mcap", std::string_view());
  trace::TraceFile file(path, {{"scenario", "fuzz"}});
  file.close();
  return contentOf(path);
}

void put(std::string& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>(value >> (8 * i) & 0xffU);
}

std::string message(std::uint8_t type, const std::string& payload) {
  std::string bytes;
  put(bytes, payload.size(), 4);
  return bytes + static_cast<char>(type) + payload;
}

/// HELLO of 16 MHz, and a quantum without an event.
std::string replies() {
  std::string hello, batch;
  put(hello, 1, 4);
  put(hello, 1, 8);
  put(hello, 16'000'000, 8);
  put(hello, 0, 4);
  put(hello, 0, 2);
  put(batch, 0, 1);
  put(batch, 8000, 8);
  put(batch, 0, 4);
  put(batch, 0, 4);
  put(batch, 0, 2);
  return message(65, hello) + message(67, batch);
}

/// A page with a layer, a form, an ink, a matrix and a dash: what the reader of PDF asks for.
std::string pdfBytes() {
  dieline::PdfPage page;
  page.resources =
      "/XObject << /F 5 0 R >> /Properties << /L 6 0 R >> /ColorSpace << /I [/Separation /Cut /DeviceRGB 7 0 "
      "R] >> /ExtGState << /G << /CA .5 >> >>";
  page.catalogue = "/OCProperties << /OCGs [6 0 R] /D << /ON [6 0 R] >> >>";
  page.objects = {dieline::pdfForm("1 0 0 RG 10 10 m 36 36 l S"), "<< /Type /OCG /Name (Cut) >>",
                  "<< /FunctionType 2 /Domain [0 1] /C0 [1 1 1] /C1 [1 0 0] /N 1 >>"};
  return dieline::pdfPage(
      "q 1 0 0 1 9 9 cm 1 0 0 RG 72 72 m 144 72 l 144 72 180 108 216 72 c h S Q "
      "/OC /L BDC /G gs 9 9 72 36 re W n 1 0 0 RG 10 10 m 20 20 l S /F Do EMC",
      page);
}

/// Lines, an arc and a SUB that is placed twice.
constexpr const char* kCf2 =
    "$BOF\r\nV2\r\nORDER\r\nEND\r\nMAIN,A\r\nUM\r\nLL,0,0\r\nUR,99,99\r\nSCALE,1,1\r\n"
    "L,2,1,0,0,0,10,5,1,1\r\nA,2,2,0,0,0,10,0,5,0,1,0,0\r\nT,0,0\r\nwords\r\nC,B,5,5,90,1,1\r\n"
    "C,B,0,0,0,-1,1\r\nEND\r\nSUB,B\r\nL,3,2,0,1,1,2,2,0,0\r\nEND\r\n$EOF\r\n";

}  // namespace

std::vector<std::pair<std::string, std::string>> soundInputs() {
  const fs::path root = KERFBENCH_SOURCE_DIR;
  const std::string nodes =
      "x_mm,y_mm,dx_mm,dy_mm\n-1,-1,0,0\n0,-1,0,0\n1,-1,0,0\n-1,0,0,0\n0,0,.1,0\n1,0,0,0\n-1,1,0,0\n0,1,0,"
      "0\n1,"
      "1,0,0\n";
  const std::string png = pictureBytes();
  return {
      {"drawing_dxf", contentOf(root / "fixtures/dielines/label-60x40.dxf")},
      {"drawing_svg", contentOf(root / "fixtures/dielines/label-60x40.svg")},
      {"drawing_pdf", pdfBytes()},
      {"drawing_cf2", kCf2},
      {"scenario", contentOf(root / "fixtures/scenarios/label-on-belt.yaml")},
      {"recording_vcd", recordingAs("sound.vcd")},
      {"recording_sr", recordingAs("sound.sr")},
      {"gcode",
       "LINE\nG00 X-3 Y20 Z0 (E4 cut)\nG01 X-57 Y20 Z1 (E4 cut)\nARC\nG03 X-60 Y17 I0 J-3 Z1 (E5 cut)\n"},
      {"correction_table", nodes},
      {"controller_table", nodes},
      {"image_hex", ":0400000001020304F2\n:00000001FF\n"},
      {"pin_stream_replies", replies()},
      {"pin_stream_requests", message(5, "")},
      {"tile_list", "version: 1\ntiles:\n  - {file: a.png, unit: 0, p_TV_mm: [0, 0]}\n%%%%\n" + png},
      {"picture", png},
      {"trace_recover", traceBytes()},
      {"http_head", "GET /api/files?path=a HTTP/1.1\r\nHost: localhost:8000\r\n\r\n"},
  };
}

}  // namespace kerfbench::fuzz
