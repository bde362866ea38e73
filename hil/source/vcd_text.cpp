// SPDX-License-Identifier: Apache-2.0
#include "hil/source/vcd_text.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>

namespace kerfbench::source {
namespace {

constexpr std::size_t kMostWords = 64;

}  // namespace

VcdText::VcdText(const std::filesystem::path& path, const base::ProgressFn& progress, std::size_t piece)
    : file_(path, path.string()),
      progress_(progress, "reading " + path.filename().string(), file_.size()),
      piece_(piece),
      buffer_(2 * piece) {
  at_ = end_ = digested_ = buffer_.data();
}

std::string_view VcdText::wordAcrossPieces() {
  const char* at = at_;
  for (;;) {
    for (; at != end_ && static_cast<unsigned char>(*at) <= ' '; ++at) line_ += *at == '\n' ? 1U : 0U;
    at_ = at;
    if (at != end_ || !more(at)) break;
    at = at_;
  }
  const char* start = at_;
  for (at = start;;) {
    const char* const end = end_;
    while (at != end && static_cast<unsigned char>(*at) > ' ') ++at;
    at_ = at;
    if (at != end) break;
    const auto length = at - start;
    const bool has_more = more(start);
    at = at_;
    start = at - length;
    if (!has_more) break;
  }
  return {start, static_cast<std::size_t>(at - start)};
}

bool VcdText::more(const char* from) {
  const char* const begin = buffer_.data();
  if (kept_) from = begin + *kept_;
  const auto before_at = at_ - from;
  const auto kept = static_cast<std::size_t>(end_ - from);
  if (kept > kMostKept) throw std::length_error("a word or a section of more than 64 MiB");
  if (is_digested_) digestUpTo(std::max(from, digested_));
  const auto digested = std::max<std::ptrdiff_t>(digested_ - from, 0);
  if (buffer_.size() < kept + piece_) {
    std::vector<char> larger(2 * (kept + piece_));
    std::memcpy(larger.data(), from, kept);
    buffer_ = std::move(larger);
  } else if (kept > 0) {
    std::memmove(buffer_.data(), from, kept);
  }
  if (kept_) kept_ = 0;
  const std::size_t got = file_.read(std::span(buffer_).subspan(kept, piece_));
  progress_.done(bytes_ += got);
  at_ = buffer_.data() + before_at;
  end_ = buffer_.data() + kept + got;
  digested_ = buffer_.data() + digested;
  return got > 0;
}

std::optional<VcdText::Section> VcdText::section(std::string_view keyword) {
  struct Place {
    std::size_t at, size;
  };
  std::vector<Place> places;
  kept_ = static_cast<std::size_t>(keyword.data() - buffer_.data());
  std::size_t text_end = 0;
  Section section;
  for (;;) {
    const std::string_view next = word();
    if (next.empty()) {
      kept_.reset();
      return std::nullopt;
    }
    const Place place{static_cast<std::size_t>(next.data() - buffer_.data()) - *kept_, next.size()};
    if (next == "$end") {
      const std::string_view whole(buffer_.data() + *kept_, place.at + place.size);
      kept_.reset();
      section.whole = whole;
      for (const auto& [at, size] : places) section.words.push_back(whole.substr(at, size));
      if (!places.empty()) section.text = whole.substr(places.front().at, text_end - places.front().at);
      return section;
    }
    text_end = place.at + place.size;
    if (places.size() < kMostWords) places.push_back(place);
  }
}

void VcdText::digestUpTo(const char* place) {
  digest_.add({digested_, static_cast<std::size_t>(place - digested_)});
  digested_ = place;
}

std::string VcdText::digestBefore(const char* place) {
  if (!is_digested_ || place < digested_) throw std::logic_error("no digest of what was passed");
  digestUpTo(place);
  return digest_.digest();
}

bool VcdText::onlyBlanksFollow() {
  for (;;) {
    for (; at_ != end_ && (*at_ == ' ' || *at_ == '\n'); ++at_) line_ += *at_ == '\n' ? 1U : 0U;
    if (at_ != end_) return false;
    if (!more(at_)) return true;
  }
}

}  // namespace kerfbench::source
