#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace raymeter {

/// Lanes of the largest packet; every column is readable this many elements past its end.
inline constexpr std::size_t kColumnPadding = 64;

/// One column of a structure of arrays: 64-byte aligned, with a zeroed tail that vector loads may read.
template <class T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

public:
  Column() = default;
  explicit Column(std::size_t size, T value = T{}) { resize(size, value); }
  Column(const Column& other) { assign(other.data_.get(), other.size_); }
  Column(Column&& other) noexcept : data_(std::move(other.data_)), size_(std::exchange(other.size_, 0)), capacity_(std::exchange(other.capacity_, 0)) {}
  Column& operator=(Column other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
    return *this;
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] T* data() noexcept { return data_.get(); }
  [[nodiscard]] const T* data() const noexcept { return data_.get(); }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  [[nodiscard]] T& back() noexcept { return data_[size_ - 1]; }
  [[nodiscard]] const T& back() const noexcept { return data_[size_ - 1]; }
  [[nodiscard]] T* begin() noexcept { return data(); }
  [[nodiscard]] T* end() noexcept { return data() + size_; }
  [[nodiscard]] const T* begin() const noexcept { return data(); }
  [[nodiscard]] const T* end() const noexcept { return data() + size_; }
  [[nodiscard]] std::span<const T> span() const noexcept { return {data(), size_}; }

  void push_back(const T& value) {
    const T copy = value;  // value may live in this column
    if (size_ == capacity_) grow(std::max<std::size_t>(16, capacity_ + capacity_ / 2));
    data_[size_++] = copy;
  }
  /// New elements get `value`.
  void resize(std::size_t size, T value = T{}) {
    if (size > capacity_) grow(std::max(size, capacity_ + capacity_ / 2));
    if (size > size_) std::fill(data_.get() + size_, data_.get() + size, value);
    size_ = size;
  }
  /// New elements get whatever is there: for many threads to write, which then also take new pages from the system.
  void resize_for_overwrite(std::size_t size) {
    if (size > capacity_) grow(std::max(size, capacity_ + capacity_ / 2));
    size_ = size;
  }
  void assign(const T* values, std::size_t size) {
    if (size > capacity_) grow(size);
    if (size > 0) std::memcpy(data_.get(), values, size * sizeof(T));
    size_ = size;
  }
  void append(const Column& other) {
    const std::size_t old_size = size_, added = other.size_;
    resize(old_size + added);
    if (added > 0) std::memcpy(data_.get() + old_size, other.data_.get(), added * sizeof(T));
  }
  void reserve(std::size_t capacity) {
    if (capacity > capacity_) grow(capacity);
  }
  void clear() noexcept { size_ = 0; }
  void shrink_to_fit() {
    if (size_ == 0)
      *this = Column();
    else if (capacity_ > size_)
      grow(size_);
  }

  /// Memory held, padding included.
  [[nodiscard]] std::size_t bytes() const noexcept { return data_ ? (capacity_ + kColumnPadding) * sizeof(T) : 0; }

private:
  static constexpr std::align_val_t kAlignment{64};
  static constexpr std::size_t kHugePage = std::size_t{1} << 21;

  struct Free {
    std::size_t mapped = 0;  ///< bytes that came straight from the system; 0: from the heap
    void operator()(T* data) const noexcept {
      if (mapped > 0)
        munmap(data, mapped);
      else
        ::operator delete(static_cast<void*>(data), kAlignment);
    }
  };
  using Data = std::unique_ptr<T[], Free>;

  /// Traversals touch large columns at random, and fewer, larger pages spare address translations. The system gives these only to memory that is new to it and
  /// aligned: what a heap gives out again is in small pages already.
  static Data map(std::size_t bytes) {
    bytes = (bytes + kHugePage - 1) & ~(kHugePage - 1);
    void* const block = mmap(nullptr, bytes + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) throw std::bad_alloc();
    auto* const begin = static_cast<std::byte*>(block);
    const std::size_t before = -reinterpret_cast<std::uintptr_t>(block) & (kHugePage - 1);
    if (before > 0) munmap(begin, before);
    if (before < kHugePage) munmap(begin + before + bytes, kHugePage - before);
    madvise(begin + before, bytes, MADV_HUGEPAGE);  // only a hint
    return Data(reinterpret_cast<T*>(begin + before), Free{bytes});
  }

  void grow(std::size_t capacity) {
    const std::size_t bytes = (capacity + kColumnPadding) * sizeof(T);
    const bool large = bytes >= 2 * kHugePage;
    Data data = large ? map(bytes) : Data(static_cast<T*>(::operator new(bytes, kAlignment)));
    if (size_ > 0) std::memcpy(static_cast<void*>(data.get()), data_.get(), size_ * sizeof(T));
    if (!large) std::memset(static_cast<void*>(data.get() + size_), 0, bytes - size_ * sizeof(T));  // mapped memory is zero
    data_ = std::move(data);
    capacity_ = capacity;
  }

  Data data_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace raymeter
