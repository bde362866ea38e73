// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/scanned_sheet.h"

#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/scanner/scan_picture.h"
#include "hil/calibrate/scanner/scanner_file.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/picture_file.h"
#include "hil/camera/tile_source.h"
#include "twin/base/image.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr double kAnyCarriage_mm = 0.05;  // What a carriage may be off by, 1 sigma: a pixel of 500 dpi.
constexpr double kUsualDpi = 600.0;

/// One picture of one sheet.
class OneTile final : public camera::TileSource {
 public:
  explicit OneTile(GrayImage image) : tile_{{std::move(image), Eigen::Vector2d::Zero(), 0, true}} {}
  std::vector<camera::KerfTile> nextBatch(std::size_t /*max*/) override { return std::exchange(tile_, {}); }

 private:
  std::vector<camera::KerfTile> tile_;
};

struct ScanFile {
  calibrate::ScanLid lid{};
  std::optional<calibrate::ScannerCalibration> scanner;
  double dpi{};
};

ScanFile readScanFile(const fs::path& path) {
  auto file = base::YamlReader::openFile(path);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  ScanFile scan;
  scan.lid = file.choice("lid", {"black", "white"}) == "black" ? calibrate::ScanLid::kBlack
                                                               : calibrate::ScanLid::kWhite;
  const std::string scanner = file.text("scanner", "");
  scan.dpi = file.number("dpi", {.min = 100, .max = 4800, .fallback = 0.0});
  if (scanner.empty() && scan.dpi == 0.0) file.fault("scanner", "name a scanner's calibration, or tell dpi");
  if (!scanner.empty() && scan.dpi != 0.0) file.fault("dpi", "the scanner's calibration has it: one of both");
  const fs::path folder = file.folderOf("scanner");
  file.finish();
  if (!scanner.empty()) scan.scanner = calibrate::readScannerFile(folder / scanner);
  return scan;
}

calibrate::ScannerMap mapFor(const ScanFile& file, const GrayImage& scan) {
  if (!file.scanner) return calibrate::ScannerMap::ofResolution(scan.width, scan.height, file.dpi);
  const calibrate::ScannerMap& map = file.scanner->map;
  if (map.width_px != scan.width || map.height_px != scan.height) {
    throw calibrate::ScanError(fmt::format(
        "has {} x {} pixels, scanner {} is calibrated for {} x {}: scan the whole glass at {:g} dpi",
        scan.width, scan.height, file.scanner->scanner_id, map.width_px, map.height_px, file.scanner->dpi));
  }
  return map;
}

}  // namespace

fs::path scanIn(const fs::path& folder) {
  for (const char* name : {"scan.png", "scan.jpg", "scan.jpeg"}) {
    std::error_code ignored;
    if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  }
  return {};
}

std::string scanTemplate(const fs::path& scanner_file) {
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Only if the sheet is scanned in place of being photographed: scan the whole glass, the sheet face "
      "down with\n"
      "# its +x along the sensor bar, in grey, without any sharpening or correction, as scan.png beside this "
      "file.\n"
      "version: 1\n"
      "lid: black   # What is behind the sheet: black (a sheet of black card under the lid) or white.\n"
      "{}",
      scanner_file.empty()
          ? fmt::format(
                "# A scanner's scales differ and its carriage wobbles by tens of micrometres. `calibrate "
                "scanner` "
                "measures that;\n# name its file here in place of dpi:\n# scanner: /path/to/scanner.yaml\n"
                "dpi: {:g}\n",
                kUsualDpi)
          : fmt::format("scanner: '{}'\n", fs::absolute(scanner_file).string()));
}

MeasuredSheet measureScan(const fs::path& folder, const calibrate::MarkJob& job, const HeadSetup& setup,
                          int threads) {
  const fs::path picture = scanIn(folder);
  const ScanFile file = readScanFile(folder / kScanList);
  const GrayImage scan = camera::readPicture(picture);
  try {
    calibrate::StraightScan straight = calibrate::straightened(scan, mapFor(file, scan), file.lid, job.print);
    HeadSetup scanned = setup;
    scanned.camera = std::move(straight.camera);
    scanned.open_gray = calibrate::kScanOpenGray;
    scanned.table_sigma_mm = file.scanner ? file.scanner->map_u_mm : kAnyCarriage_mm;
    OneTile tile(std::move(straight.image));
    MeasuredSheet sheet = measureSheet(tile, job, scanned, threads);
    if (!file.scanner)
      sheet.remarks.emplace_back(
          "the scanner is not calibrated: its scales and its carriage are taken on trust, each mark to 0.05 "
          "mm");
    return sheet;
  } catch (const calibrate::ScanError& error) {
    throw HeadEvidenceError(fmt::format("{}: {}", picture.string(), error.what()));
  } catch (const HeadEvidenceError& error) {
    throw HeadEvidenceError(fmt::format("{}: {}", picture.string(), error.what()));
  }
}

}  // namespace kerfbench::head_service
