#include "accel/bvh/triangle_block.h"

#include <algorithm>
#include <cstring>

namespace raymeter {

namespace {

Row4 row_at(const float* values) noexcept {
  Row4 row;
  std::memcpy(&row, values, sizeof row);
  return row;
}

/// Which of the first `count` columns (rounded up to four) equal a vertex, as bits.
std::uint64_t equal_to(const float* const* at, int count, float x, float y, float z) noexcept {
  std::uint64_t same = 0;
  for (int i = 0; i < count; i += 4) {
    const auto equal = (row_at(at[0] + i) == Row4{x, x, x, x}) & (row_at(at[1] + i) == Row4{y, y, y, y}) & (row_at(at[2] + i) == Row4{z, z, z, z});
    same |= static_cast<std::uint64_t>(static_cast<unsigned>(__builtin_ia32_movmskps(std::bit_cast<Row4>(equal)))) << i;
  }
  return same;
}

using Words4 = std::int32_t __attribute__((vector_size(16)));

/// The corners of a block's triangles. They are told apart by a word made of their coordinates, four at once; where words alone are equal by the coordinates.
struct Corners {
  static constexpr int kMost = 3 * TriangleBlock::kTriangles;
  alignas(16) float at[3][kMost];
  alignas(16) std::int32_t word[kMost];
  int count = 0;

  void add(float x, float y, float z) noexcept {
    at[0][count] = x;
    at[1][count] = y;
    at[2][count] = z;
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };  // of both zeros the same
    word[count++] = static_cast<std::int32_t>(bits(x) * 0x9E3779B1u + bits(y) * 0x85EBCA77u + bits(z) * 0xC2B2AE3Du);
  }
  [[nodiscard]] bool alike(int i, int j) const noexcept { return at[0][i] == at[0][j] && at[1][i] == at[1][j] && at[2][i] == at[2][j]; }
  /// The first corner in the same place as corner i.
  [[nodiscard]] int first_like(int i) const noexcept {
    const Words4 own{word[i], word[i], word[i], word[i]};
    std::uint64_t same = std::uint64_t{1} << i;
    for (int j = 0; j < i; j += 4) {
      Words4 words;
      std::memcpy(&words, word + j, sizeof words);
      same |= static_cast<std::uint64_t>(static_cast<unsigned>(__builtin_ia32_movmskps(std::bit_cast<Row4>(words == own)))) << j;
    }
    int first = std::countr_zero(same);
    while (!alike(first, i)) first = std::countr_zero(same &= same - 1);
    return first;
  }
};

}  // namespace

SharedVertices::SharedVertices(const TrianglePool& pool, std::span<const PrimRef> triangles, std::uint8_t (*number)[TriangleBlock::kTriangles]) noexcept {
  Corners corners;
  for (const PrimRef triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) corners.add(pool.vertex[k][0][triangle.index], pool.vertex[k][1][triangle.index], pool.vertex[k][2][triangle.index]);
  }
  std::uint8_t number_of[kMost];
  const auto& corner = corners.at;
  for (int i = 0; i < corners.count; ++i) {
    const int first = corners.first_like(i);
    number_of[i] = static_cast<std::uint8_t>(count_);
    number_of[i] = number_of[first];
    for (int a = 0; a < 3; ++a) at_[a][number_of[i]] = corner[a][first];
    if (number != nullptr) number[i % 3][i / 3] = number_of[i];
    count_ += first == i ? 1 : 0;
  }
}

bool SharedVertices::add(const SharedVertices& others) noexcept {
  const float* const own[3] = {at_[0], at_[1], at_[2]};
  const int known = count_;
  for (int i = 0; i < others.count_; ++i) {
    const float x = others.at_[0][i], y = others.at_[1][i], z = others.at_[2][i];
    const bool is_new = (equal_to(own, known, x, y, z) & ((std::uint64_t{1} << known) - 1)) == 0;
    at_[0][count_] = x;
    at_[1][count_] = y;
    at_[2][count_] = z;
    count_ += is_new ? 1 : 0;
  }
  return count_ <= TriangleBlock::kVertices;
}

bool fits_leaf(const Pools& pools, std::span<const PrimRef> refs, int max_leaf_size) noexcept {
  const PrimKind kind = refs[0].kind();
  if (!std::all_of(refs.begin(), refs.end(), [&](PrimRef ref) { return ref.kind() == kind; })) return false;
  if (kind != PrimKind::triangle) return refs.size() <= static_cast<std::size_t>(max_leaf_size);
  return 3 * refs.size() <= TriangleBlock::kVertices ||
         (refs.size() <= TriangleBlock::kTriangles && SharedVertices(pools.triangles, refs).count() <= TriangleBlock::kVertices);
}

bool fill_block(const TrianglePool& pool, std::span<const PrimRef> refs, TriangleBlock& block) noexcept {
  if (refs.size() > TriangleBlock::kTriangles) return false;
  block = {};
  const SharedVertices vertices(pool, refs, block.corner);
  if (vertices.count() > TriangleBlock::kVertices) return false;
  for (int a = 0; a < 3; ++a) {
    for (int v = 0; v < vertices.count(); ++v) block.vertex[a][v] = vertices.at(a, v);
  }
  for (std::size_t t = 0; t < refs.size(); ++t) block.prim[t] = pool.prim[refs[t].index];
  block.count = static_cast<std::int32_t>(refs.size());
  return true;
}

}  // namespace raymeter
