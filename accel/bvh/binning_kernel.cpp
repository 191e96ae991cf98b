// What a box costs in each node above it is the loads, comparisons and stores of three bins. Where registers hold eight floats a box is one of them, with the
// signs of its maxima changed: then the least is what is wanted of all. Calls no function that other files have too (scripts/check_kernels).

#include "accel/bvh/binning_kernel.h"

#include <type_traits>

#include "core/simd/lanes.h"

namespace raymeter {

namespace {

using Row8 = float __attribute__((vector_size(32)));
using Bits8 = std::uint32_t __attribute__((vector_size(32)));
using Ints4 = std::int32_t __attribute__((vector_size(16)));

constexpr bool kWide = kKernelIsa == Isa::avx2 || kKernelIsa == Isa::avx512;
constexpr std::size_t kInTurns = 96;
constexpr std::uint32_t kSign = 0x80000000u;

template <class From, class To>
[[gnu::always_inline]] inline void copy_bits(const From& from, To& to) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  __builtin_memcpy(&to, &from, sizeof to);
}

/// A box as the bins take it in.
struct WideBox {
  Row8 rows;
  [[gnu::always_inline]] explicit WideBox(const Box4& box) noexcept {
    Bits8 bits;
    copy_bits(box, bits);
    bits ^= Bits8{0, 0, 0, 0, kSign, kSign, kSign, kSign};
    copy_bits(bits, rows);
  }
  [[gnu::always_inline]] void grow(Box4& bin) const noexcept {
    Row8 old;
    copy_bits(bin, old);
    old = rows < old ? rows : old;
    copy_bits(old, bin);
  }
  [[gnu::always_inline]] static void merge(const Box4& from, Box4& bin) noexcept {
    bin.min = from.min < bin.min ? from.min : bin.min;
    bin.max = from.max < bin.max ? from.max : bin.max;
  }
  [[gnu::always_inline]] static void clear(Box4& bin) noexcept {
    for (int i = 0; i < 4; ++i) bin.min[i] = bin.max[i] = kInfinite;
  }
  [[gnu::always_inline]] static void finish(Box4& bin) noexcept { bin.max = -bin.max; }
};

struct NarrowBox {
  const Box4& box;
  [[gnu::always_inline]] explicit NarrowBox(const Box4& from) noexcept : box(from) {}
  [[gnu::always_inline]] void grow(Box4& bin) const noexcept {
    bin.min = box.min < bin.min ? box.min : bin.min;
    bin.max = box.max > bin.max ? box.max : bin.max;
  }
  [[gnu::always_inline]] static void merge(const Box4& from, Box4& bin) noexcept { NarrowBox(from).grow(bin); }
  [[gnu::always_inline]] static void clear(Box4& bin) noexcept {
    for (int i = 0; i < 4; ++i) {
      bin.min[i] = kInfinite;
      bin.max[i] = -kInfinite;
    }
  }
  [[gnu::always_inline]] static void finish(Box4&) noexcept {}
};

}  // namespace

template <Isa I>
void BinningKernel<I>::bin(const BinnedBox* boxes, std::size_t count, const BinMapping& mapping, Bins& bins) noexcept {
  using Box = std::conditional_t<kWide, WideBox, NarrowBox>;
  const int used = mapping.bins;
  // Neighbours fall into the same bins, and each waits for what the one before it has stored there: of many, every other box has bins of its own.
  Bins others;
  const bool in_turns = count >= kInTurns;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < used; ++b) {
      Box::clear(bins.box[a][b]);
      bins.entering[a][b] = 0;
      if (!in_turns) continue;
      Box::clear(others.box[a][b]);
      others.entering[a][b] = 0;
    }
  }
  const Row4 offset = mapping.offset, scale = mapping.scale;
  const auto last = static_cast<float>(used - 1);
  const Row4 most{last, last, last, last};
  const auto add = [&](const BinnedBox& one, Bins& to) __attribute__((always_inline)) {
    const Row4 place = (one.box.min + one.box.max - offset) * scale;
    const Ints4 bin = __builtin_convertvector(place < most ? place : most, Ints4);
    const Box box(one.box);
    for (int a = 0; a < 3; ++a) {
      box.grow(to.box[a][bin[a]]);
      ++to.entering[a][bin[a]];
    }
  };
  std::size_t i = 0;
  if (in_turns) {
    for (; i + 1 < count; i += 2) {
      add(boxes[i], bins);
      add(boxes[i + 1], others);
    }
  }
  for (; i < count; ++i) add(boxes[i], bins);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < used; ++b) {
      if (in_turns) {
        Box::merge(others.box[a][b], bins.box[a][b]);
        bins.entering[a][b] += others.entering[a][b];
      }
      Box::finish(bins.box[a][b]);
      bins.leaving[a][b] = bins.entering[a][b];
    }
  }
}

template struct BinningKernel<kKernelIsa>;

}  // namespace raymeter
