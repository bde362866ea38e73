// SPDX-License-Identifier: Apache-2.0
#include "hil/base/time_left.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>

namespace kerfbench::base {

std::optional<int> TimeLeft::after(std::string_view work, double share, Time now) {
  if (work != work_ || share < begun_share_) {
    work_ = work;
    begun_ = now;
    begun_share_ = share;
    return std::nullopt;
  }
  const double spent_s = std::chrono::duration<double>(now - begun_).count();
  const double done = share - begun_share_;
  if (spent_s < 1.0 || done < 0.01 || share >= 1.0) return std::nullopt;
  return static_cast<int>(std::clamp(std::ceil(spent_s / done * (1.0 - share)), 1.0, 1e6));
}

std::optional<double> shareIn(std::string_view words) {
  const std::size_t sign = words.rfind(" %");
  if (sign == std::string_view::npos) return std::nullopt;
  int share = 0, factor = 1;
  std::size_t at = sign;
  for (; at > 0 && factor <= 1000 && std::isdigit(static_cast<unsigned char>(words[at - 1])) != 0; --at) {
    share += factor * (words[at - 1] - '0');
    factor *= 10;
  }
  if (at == sign || share > 100) return std::nullopt;
  return share / 100.0;
}

}  // namespace kerfbench::base
