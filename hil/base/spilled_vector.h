// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <span>
#include <type_traits>
#include <vector>

#include "hil/base/spilled_bytes.h"

namespace kerfbench::base {

/// A vector that only grows at its end and may become larger than the memory: the first megabytes are in
/// memory, what is more in a temporary file. For readers it is one piece of memory, as a std::vector is.
///
/// Whoever reads all of it uses streamed(), which gives the memory behind the reader back to the kernel. A
/// copy shares the file, and of what is in memory it has its own. Appending to both copies is possible;
/// whichever is second gets a file of its own then. References end when something is appended.
template <class T>
class SpilledVector {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  using size_type = std::size_t;
  using difference_type = std::ptrdiff_t;
  using const_reference = const T&;
  using reference = const T&;
  using const_iterator = const T*;
  using iterator = const T*;

  SpilledVector() = default;
  SpilledVector(std::initializer_list<T> values) {
    append(std::span<const T>(values.begin(), values.size()));
  }
  explicit SpilledVector(std::span<const T> values) { append(values); }
  explicit SpilledVector(const std::vector<T>& values) { append(values); }

  [[nodiscard]] std::size_t size() const { return bytes_.size() / sizeof(T); }
  [[nodiscard]] bool empty() const { return bytes_.size() == 0; }
  [[nodiscard]] const T* data() const { return reinterpret_cast<const T*>(bytes_.data()); }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size(); }
  [[nodiscard]] auto rbegin() const { return std::reverse_iterator(end()); }
  [[nodiscard]] auto rend() const { return std::reverse_iterator(begin()); }
  const T& operator[](std::size_t index) const { return data()[index]; }
  [[nodiscard]] const T& front() const { return data()[0]; }
  [[nodiscard]] const T& back() const { return data()[size() - 1]; }

  /// @throws std::system_error with folder and size if the disk has no room, std::bad_alloc. Nothing has
  /// changed then.
  void push_back(T value) {
    if (bytes_.room() == 0) bytes_.makeRoom();
    std::memcpy(bytes_.end(), &value, sizeof(T));
    bytes_.appended(sizeof(T));
  }
  /// `values` are none of this vector. @throws as push_back(), with a beginning of them appended.
  void append(std::span<const T> values) {
    while (!values.empty()) {
      if (bytes_.room() == 0) bytes_.makeRoom();
      const std::size_t count = std::min(values.size(), bytes_.room() / sizeof(T));
      std::memcpy(bytes_.end(), values.data(), count * sizeof(T));
      bytes_.appended(count * sizeof(T));
      values = values.subspan(count);
    }
  }
  void clear() { bytes_ = SpilledBytes(sizeof(T)); }
  /// Room for so many in memory, to be had now: until then nothing is copied, and no disk is waited for.
  void holdInMemory(std::size_t count) { bytes_.holdInMemory(count * sizeof(T)); }

  /// Gives the memory of the elements in [from, to) back to the kernel, which reads them from the file when
  /// they are wanted again.
  void giveBack(std::size_t from, std::size_t to) const { bytes_.giveBack(from * sizeof(T), to * sizeof(T)); }
  /// Elements that a reader passes before it gives back.
  static constexpr std::size_t kStride = std::max<std::size_t>(1, (std::size_t{4} << 20U) / sizeof(T));

  /// The elements in order, once; memory that has been passed is given back.
  class Stream {
   public:
    class Iterator {
     public:
      using value_type = T;
      using difference_type = std::ptrdiff_t;
      using iterator_concept = std::input_iterator_tag;
      Iterator() = default;
      Iterator(const SpilledVector& all, const T* at) : all_(&all), at_(at) { stride(); }
      const T& operator*() const { return *at_; }
      const T* operator->() const { return at_; }
      Iterator& operator++() {
        if (++at_ == stride_end_) pass();
        return *this;
      }
      void operator++(int) { ++*this; }
      friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_; }

     private:
      void stride() {
        const std::size_t left = all_->size() - static_cast<std::size_t>(at_ - all_->begin());
        stride_end_ = at_ + std::min(left, kStride);
      }
      void pass() {
        const auto to = static_cast<std::size_t>(at_ - all_->begin());
        all_->giveBack(to - std::min(to, kStride), to);
        stride();
      }
      const SpilledVector* all_{};
      const T* at_{};
      const T* stride_end_{};
    };
    explicit Stream(const SpilledVector& all) : all_(&all) {}
    [[nodiscard]] Iterator begin() const { return Iterator(*all_, all_->begin()); }
    [[nodiscard]] Iterator end() const { return Iterator(*all_, all_->end()); }

   private:
    const SpilledVector* all_;
  };
  [[nodiscard]] Stream streamed() const { return Stream(*this); }

  friend bool operator==(const SpilledVector& a, const SpilledVector& b) { return std::ranges::equal(a, b); }
  friend bool operator==(const SpilledVector& a, const std::vector<T>& b) { return std::ranges::equal(a, b); }

 private:
  SpilledBytes bytes_{sizeof(T)};
};

}  // namespace kerfbench::base
