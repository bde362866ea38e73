// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/frame_recording.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/input_file.h"
#include "hil/base/number_from.h"
#include "hil/base/unique_fd.h"
#include "hil/base/yaml_reader.h"

namespace kerfbench::camera {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRaw = "frames.raw";
constexpr const char* kIndex = "frames.csv";
constexpr const char* kCamera = "camera.yaml";
constexpr std::size_t kChecksumDigits = 32;
constexpr std::uint64_t kLargestIndex_bytes = std::uint64_t{256} << 20U;  // Two million frames.
constexpr std::array<std::string_view, 3> kClocks{"unknown", "monotonic", "copied"};

/// As YAML takes any text.
std::string yamlText(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte > 0x7e) {
      result += fmt::format("\\x{:02x}", byte);
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string contentOf(const fs::path& path) {
  base::InputContent content = base::readInput(path, kLargestIndex_bytes);
  if (!content.bytes) throw base::ConfigError(fmt::format("{}: {}", path.string(), content.refusal));
  return *std::move(content.bytes);
}

void requireWritten(const std::ofstream& file, const fs::path& path) {
  if (!file) throw std::system_error(errno, std::generic_category(), "cannot write " + path.string());
}

/// The rest of a line up to the next comma.
std::string_view cell(std::string_view& line) {
  const std::size_t end = std::min(line.find(','), line.size());
  const std::string_view found = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return found;
}

template <typename T>
bool parse(std::string_view text, T& value) {
  const std::optional<T> number = base::numberFrom<T>(text);
  value = number.value_or(T{});
  return number.has_value();
}

bool parseFlag(std::string_view text, bool& value) {
  value = text == "1";
  return value || text == "0";
}

bool parseClock(std::string_view text, StampClock& clock) {
  for (std::size_t i = 0; i < kClocks.size(); ++i) {
    if (text != kClocks.at(i)) continue;
    clock = static_cast<StampClock>(i);
    return true;
  }
  return false;
}

}  // namespace

FrameRecordingWriter::FrameRecordingWriter(fs::path folder, RecordedCamera camera)
    : folder_(std::move(folder)), camera_(std::move(camera)) {
  fs::create_directories(folder_);
  if (!fs::is_empty(folder_))
    throw std::invalid_argument(
        fmt::format("{}: is not empty; a recording needs a folder of its own", folder_.string()));
  raw_.open(folder_ / kRaw, std::ios::binary);
  requireWritten(raw_, folder_ / kRaw);
  index_.open(folder_ / kIndex, std::ios::binary);
  index_ << kIndexColumns << '\n';
  requireWritten(index_, folder_ / kIndex);
}

void FrameRecordingWriter::add(const StreamEvent& frame) {
  const BufferNote& note = frame.note;
  raw_.write(reinterpret_cast<const char*>(frame.bytes.data()),
             static_cast<std::streamsize>(frame.bytes.size()));
  requireWritten(raw_, folder_ / kRaw);
  index_ << fmt::format("{},{},{},{},{:d},{:d},{:d},{},{}\n", note.sequence, note.stamp_ns, note.arrival_ns,
                        kClocks.at(static_cast<std::size_t>(note.clock)), note.is_start_of_exposure,
                        note.has_error, note.is_short, frame.bytes.size(), base::checksum(frame.bytes));
  requireWritten(index_, folder_ / kIndex);
  ++frames_;
}

void FrameRecordingWriter::finish(const std::string& ended) {
  for (auto [file, name] : {std::pair{&raw_, kRaw}, std::pair{&index_, kIndex}}) {
    file->close();
    requireWritten(*file, folder_ / name);
    const base::UniqueFd fd(::open((folder_ / name).c_str(), O_RDONLY | O_CLOEXEC));
    if (!fd.valid() || ::fsync(fd.get()) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot sync " + (folder_ / name).string());
  }
  const CameraSetup& setup = camera_.setup;
  const FrameLayout& layout = setup.layout;
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\nversion: 1\ndevice: {}\ncard: {}\ndriver: {}\nbus: {}\nformat: "
      "{}\n"
      "size_px: [{}, {}]\nstride_bytes: {}\nbits: {}\nfull_range: {}\ntriggered: {}\nsensor_has_noise: {}\n",
      yamlText(camera_.device), yamlText(camera_.card), yamlText(camera_.driver), yamlText(camera_.bus),
      layout.format->name, layout.width_px, layout.height_px, layout.stride_bytes, layout.bits,
      layout.full_range, camera_.is_triggered, camera_.sensor_has_noise);
  if (layout.left_px != 0 || layout.top_px != 0)
    text += fmt::format("first_px: [{}, {}]\n", layout.left_px, layout.top_px);
  if (setup.frame_period_s) text += fmt::format("frame_period_s: {:.17g}\n", *setup.frame_period_s);
  if (setup.exposure_s) text += fmt::format("exposure_s: {:.17g}\n", *setup.exposure_s);
  if (!setup.outcomes.empty()) text += "settings:\n";
  for (const SettingOutcome& one : setup.outcomes)
    text += fmt::format("  - {{setting: {}, wanted: {:.17g}, got: {:.17g}}}\n", yamlText(one.setting),
                        one.wanted, one.got);
  text += fmt::format("ended: {}\nframes: {}\nindex_sha256: {}\n", yamlText(ended), frames_,
                      base::sha256(contentOf(folder_ / kIndex)));
  base::writeFileAtomically(folder_ / kCamera, text);
}

FrameRecording::FrameRecording(fs::path folder) : folder_(std::move(folder)) {
  if (!fs::is_regular_file(folder_ / kCamera)) {
    throw base::ConfigError(
        fs::exists(folder_ / kRaw)
            ? fmt::format("{}: the recording of frames was not finished", folder_.string())
            : fmt::format("{}: there is no recording of frames ({})", folder_.string(), kCamera));
  }
  digest_ = base::sha256(contentOf(folder_ / kCamera));
  readCamera();
  readIndex(contentOf(folder_ / kIndex));
  base::OpenedInput raw = base::openInput(folder_ / kRaw, base::kAnySize);
  if (!raw.fd.valid()) throw base::ConfigError(fmt::format("{}: {}", (folder_ / kRaw).string(), raw.refusal));
  raw_ = std::move(raw.fd);
  const std::uint64_t promised = entries_.empty() ? 0 : entries_.back().at + entries_.back().bytes;
  if (raw.size_bytes != promised)
    throw base::ConfigError(fmt::format("{}: has {} bytes, and {} has {}", (folder_ / kRaw).string(),
                                        raw.size_bytes, kIndex, promised));
}

void FrameRecording::readCamera() {
  auto file = base::YamlReader::openFile(folder_ / kCamera);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  camera_.device = file.text("device");
  camera_.card = file.text("card", "");
  camera_.driver = file.text("driver", "");
  camera_.bus = file.text("bus", "");
  FrameLayout& layout = camera_.setup.layout;
  const std::string format = file.text("format");
  layout.format = findPixelFormat(format);
  if (layout.format == nullptr) file.fault("format", fmt::format("'{}' cannot be read", format));
  constexpr double kMostPixels = 1 << 20;
  const auto size = file.numbers("size_px", 2, {.min = 1, .max = kMostPixels});
  layout.width_px = static_cast<int>(size[0]);
  layout.height_px = static_cast<int>(size[1]);
  const auto first = file.numbers("first_px", 2, {.min = 0, .max = kMostPixels, .fallback = 0.0});
  layout.left_px = static_cast<int>(first[0]);
  layout.top_px = static_cast<int>(first[1]);
  layout.stride_bytes =
      static_cast<std::size_t>(file.integer("stride_bytes", {.min = 0, .max = 16 * kMostPixels}));
  layout.bits = static_cast<int>(file.integer("bits", {.min = 8, .max = 16}));
  layout.full_range = file.boolean("full_range");
  camera_.is_triggered = file.boolean("triggered");
  camera_.sensor_has_noise = file.boolean("sensor_has_noise");
  constexpr double kShort_s = 1e-9;
  constexpr double kLong_s = 1e4;
  if (file.has("frame_period_s"))
    camera_.setup.frame_period_s = file.number("frame_period_s", {.min = kShort_s, .max = kLong_s});
  if (file.has("exposure_s"))
    camera_.setup.exposure_s = file.number("exposure_s", {.min = kShort_s, .max = kLong_s});
  for (base::YamlReader& one : file.list("settings"))
    camera_.setup.outcomes.push_back({one.text("setting"), one.number("wanted", {}), one.number("got", {})});
  ended_ = file.text("ended", "");
  promised_ = static_cast<std::uint64_t>(file.integer("frames", {.min = 0, .max = 9e15}));
  index_digest_ = file.text("index_sha256");
  file.finish();
}

void FrameRecording::readIndex(const std::string& text) {
  const std::string path = (folder_ / kIndex).string();
  if (base::sha256(text) != index_digest_)
    throw base::ConfigError(path + ": was changed since it was recorded");
  std::string_view rest = text;
  const auto nextLine = [&rest] {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return line;
  };
  if (nextLine() != FrameRecordingWriter::kIndexColumns)
    throw base::ConfigError(path + ":1: has other columns");
  std::uint64_t at = 0;
  for (std::size_t number = 2; !rest.empty(); ++number) {
    std::string_view line = nextLine();
    Entry entry;
    BufferNote& note = entry.note;
    const bool is_good = parse(cell(line), note.sequence) && parse(cell(line), note.stamp_ns) &&
                         parse(cell(line), note.arrival_ns) && parseClock(cell(line), note.clock) &&
                         parseFlag(cell(line), note.is_start_of_exposure) &&
                         parseFlag(cell(line), note.has_error) && parseFlag(cell(line), note.is_short) &&
                         parse(cell(line), entry.bytes);
    entry.digest = line;
    // The sum of all must be the size of the file of the frames: none may carry it past 64 bits.
    if (!is_good || entry.digest.size() != kChecksumDigits || entry.bytes > UINT64_MAX - at)
      throw base::ConfigError(fmt::format("{}:{}: is no line of a buffer", path, number));
    entry.at = at;
    at += entry.bytes;
    entries_.push_back(std::move(entry));
  }
  if (entries_.size() != promised_)
    throw base::ConfigError(
        fmt::format("{}: has {} frames, and {} says {}", path, entries_.size(), kCamera, promised_));
}

StreamEvent FrameRecording::failed(const char* what) const {
  return {StreamEvent::Kind::kFailed, {}, {}, fmt::format("{}: frame {} {}", folder_.string(), next_, what)};
}

StreamEvent FrameRecording::next(int /*timeout_ms*/) {
  if (next_ == entries_.size())
    return {StreamEvent::Kind::kEnd, {}, {}, ended_.empty() ? "the recording is over" : ended_};
  const Entry& entry = entries_[next_];
  buffer_.resize(entry.bytes);
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t got = ::pread(raw_.get(), buffer_.data() + done, buffer_.size() - done,
                                static_cast<off_t>(entry.at + done));
    if (got == 0 || (got < 0 && errno != EINTR)) return failed("cannot be read");
    done += got > 0 ? static_cast<std::size_t>(got) : 0;
  }
  if (base::checksum(buffer_) != entry.digest) return failed("was changed since it was recorded");
  ++next_;
  return {StreamEvent::Kind::kFrame, entry.note, buffer_, {}};
}

}  // namespace kerfbench::camera
