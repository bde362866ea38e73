// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/loop_camera.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "tests/guest/player.h"
#include "twin/base/image.h"

namespace kerfbench::guest {
namespace {

void require(int fd, unsigned long request, void* argument, const std::string& what) {
  if (::ioctl(fd, request, argument) != 0) throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

GrayImage numberedImage(int width_px, int height_px, std::uint32_t number) {
  GrayImage image(width_px, height_px);
  std::uint32_t at = 0;
  for (std::uint8_t& pixel : image.pixels) {
    // The pixel takes the multiplier's upper bits, so that no two numbers share a picture.
    pixel = static_cast<std::uint8_t>((number * 2'654'435'761U + at * 40'503U) >> 16U);
    ++at;
  }
  return image;
}

std::vector<Exposure> exposures(std::uint32_t first, std::uint32_t last, std::uint64_t period_ns) {
  std::vector<Exposure> list;
  for (std::uint32_t number = first; number <= last; ++number)
    list.push_back({(number - first) * period_ns, number});
  return list;
}

LoopWriter::LoopWriter(const std::string& path, int width_px, int height_px, std::uint32_t rate_hz)
    : path_(path), width_px_(width_px), height_px_(height_px), fd_(::open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), path);
  try {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = static_cast<std::uint32_t>(width_px);
    format.fmt.pix.height = static_cast<std::uint32_t>(height_px);
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    require(fd_, VIDIOC_S_FMT, &format, path + ": VIDIOC_S_FMT");
    v4l2_streamparm rate{};
    rate.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    rate.parm.output.timeperframe = {1, rate_hz};
    require(fd_, VIDIOC_S_PARM, &rate, path + ": VIDIOC_S_PARM");
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    require(fd_, VIDIOC_STREAMON, &type, path + ": VIDIOC_STREAMON");
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

LoopWriter::~LoopWriter() { ::close(fd_); }

void LoopWriter::write(std::uint32_t number) { write(numberedImage(width_px_, height_px_, number)); }

void LoopWriter::write(const GrayImage& image) { write(std::span(image.pixels)); }

void LoopWriter::write(std::span<const std::uint8_t> pixels) {
  // The driver takes no more than its buffers hold.
  if (::write(fd_, pixels.data(), pixels.size()) <= 0)
    throw std::system_error(errno, std::generic_category(), path_ + ": write");
}

void LoopWriter::run(const std::vector<Exposure>& exposures) {
  const std::uint64_t begin_ns = now_ns();
  for (const Exposure& exposure : exposures) {
    sleepUntil_ns(begin_ns + exposure.at_ns);
    write(exposure.number);
  }
}

void LoopWriter::play(const Film& film) {
  const std::uint64_t begin_ns = now_ns() - film.at_ns.front();
  for (std::size_t i = 0; i < film.at_ns.size(); ++i) {
    sleepUntil_ns(begin_ns + film.at_ns[i]);
    write(film.picture(i));
  }
}

}  // namespace kerfbench::guest
