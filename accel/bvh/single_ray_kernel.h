#pragma once

// One ray against the eight children of a node, children in lanes, by the slab test of core/bounds/slab_kernel.h. What the ray needs stays in registers for the
// whole traversal. Far sides are negated: one maximum serves both ends.

#include "accel/bvh/wide_layout.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

/// A register of rays, laid down so that each can be taken out alone.
template <class L>
struct RayColumns {
  alignas(64) float org[3][L::kWidth];
  alignas(64) float inv_dir[3][L::kWidth];
  alignas(64) float shear[3][L::kWidth];
  alignas(64) float slack[L::kWidth];
  alignas(64) float t_min[L::kWidth];
  alignas(64) float t_end[L::kWidth];  ///< -inf: not to be traced
  alignas(64) float t_unit[L::kWidth];
  std::uint32_t negative[3];  ///< signs of the direction, lanes as bits
  std::uint32_t axis_is_y, axis_is_z;

  void lay_down(const RayPacket<L>& ray, const HitPacket<L>& hit) noexcept {
    for (int a = 0; a < 3; ++a) {
      L::store(org[a], ray.org[a]);
      L::store(inv_dir[a], ray.inv_dir[a]);
      L::store(shear[a], ray.shear[a]);
      negative[a] = L::bits(ray.negative[a]);
    }
    L::store(slack, ray.slab_slack);
    L::store(t_min, ray.t_min);
    L::store(t_end, hit.t);
    L::store(t_unit, ray.t_unit);
    axis_is_y = L::bits(ray.axis_is_y);
    axis_is_z = L::bits(ray.axis_is_z);
  }
  /// Signs of a ray's direction, as bits.
  [[nodiscard]] std::uint32_t octant(int lane) const noexcept {
    return (negative[0] >> lane & 1) | (negative[1] >> lane & 1) << 1 | (negative[2] >> lane & 1) << 2;
  }
  /// The axis of the largest |dir|.
  [[nodiscard]] int axis(int lane) const noexcept { return static_cast<int>((axis_is_y >> lane & 1) + 2 * (axis_is_z >> lane & 1)); }
};

/// Entries of a ray's stack: a child and where the ray enters its box, in columns. Registers are stored whole, past the entries that count.
struct SingleStack {
  float* enter;
  WideRef* child;
  std::int32_t size = 0;

  SingleStack(std::byte* scratch, std::int32_t capacity) noexcept
      : enter(reinterpret_cast<float*>(scratch)), child(reinterpret_cast<WideRef*>(enter + capacity + kWideChildren)) {}
};

/// The ray, to be tested against boxes.
template <class L>
class RayAtNodes {
public:
  using Float = typename L::Float;

  RayAtNodes(const RayColumns<L>& rays, int lane) noexcept : slack_(-rays.slack[lane]), t_min_(rays.t_min[lane]), octant_(rays.octant(lane)) {
    for (int a = 0; a < 3; ++a) {
      org_[a] = Float(rays.org[a][lane]);
      first_[a] = Float(rays.inv_dir[a][lane]);
      last_[a] = Float(-rays.inv_dir[a][lane]);
      first_row_[a] = (octant_ >> a & 1) != 0 ? a + 3 : a;
      last_row_[a] = (octant_ >> a & 1) != 0 ? a : a + 3;
    }
  }
  /// Pushes the children that the ray meets before `t_end`, the nearest last.
  [[gnu::always_inline]] void push_met(const WideNode& node, float t_end, SingleStack& stack) const noexcept {
    constexpr int kStep = L::kWidth < kWideChildren ? L::kWidth : kWideChildren;
    alignas(64) float enter[kWideChildren];
    std::uint32_t met = 0;
    for (int c = 0; c < kWideChildren; c += kStep) {
      Float in(-kInfinity), out(-kInfinity);  // out is negated
      for (int a = 0; a < 3; ++a) {
        in = L::max((L::load(node.plane[first_row_[a]] + c) - org_[a]) * first_[a], in);
        out = L::max((L::load(node.plane[last_row_[a]] + c) - org_[a]) * last_[a], out);
      }
      in = L::max(L::mul_add(in, Float(1.0f - kSlabPadding), slack_), t_min_);
      out = L::max(L::mul_add(out, Float(1.0f + kSlabPadding), slack_), Float(-t_end));
      L::store(enter + c, in);
      met |= L::bits(in + out <= Float(0.0f)) << c;
    }
    if ((met & (met - 1)) == 0) {
      if (met == 0) return;
      const int place = __builtin_ctz(met);
      stack.enter[stack.size] = enter[place];
      stack.child[stack.size++] = node.child[place];
      return;
    }
    const std::uint32_t order = node.order[octant_];
    for (int i = kWideChildren - 1; i >= 0; --i) {
      const std::uint32_t place = order >> 4 * i & 7;
      stack.enter[stack.size] = enter[place];
      stack.child[stack.size] = node.child[place];
      stack.size += static_cast<std::int32_t>(met >> place & 1);
    }
  }

private:
  Float org_[3], first_[3], last_[3];  ///< 1 / dir, and negated
  Float slack_, t_min_;                ///< slack is negated
  std::uint32_t octant_;
  int first_row_[3], last_row_[3];
};

#ifdef __AVX512DQ__
/// Sixteen lanes: the planes that the ray meets first of eight children, then those that it meets last.
template <>
class RayAtNodes<Lanes<Isa::avx512>> {
public:
  using L = Lanes<Isa::avx512>;

  RayAtNodes(const RayColumns<L>& rays, int lane) noexcept : octant_(rays.octant(lane)) {
    const auto halves = [](float first, float last) noexcept { return _mm512_mask_blend_ps(0xFF00, _mm512_set1_ps(first), _mm512_set1_ps(last)); };
    for (int a = 0; a < 3; ++a) {
      org_[a] = _mm512_set1_ps(rays.org[a][lane]);
      inv_dir_[a] = halves(rays.inv_dir[a][lane], -rays.inv_dir[a][lane]);
      first_row_[a] = (octant_ >> a & 1) != 0 ? a + 3 : a;
      last_row_[a] = (octant_ >> a & 1) != 0 ? a : a + 3;
    }
    padding_ = halves(1.0f - kSlabPadding, 1.0f + kSlabPadding);
    slack_ = _mm512_set1_ps(-rays.slack[lane]);
    t_min_ = _mm512_set1_ps(rays.t_min[lane]);
  }
  [[gnu::always_inline]] void push_met(const WideNode& node, float t_end, SingleStack& stack) const noexcept {
    __m512 ends = _mm512_set1_ps(-kInfinity);
    for (int a = 0; a < 3; ++a) {
      const __m512 planes = _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_load_ps(node.plane[first_row_[a]])), _mm256_load_ps(node.plane[last_row_[a]]), 1);
      ends = _mm512_max_ps(_mm512_mul_ps(_mm512_sub_ps(planes, org_[a]), inv_dir_[a]), ends);
    }
    ends = _mm512_max_ps(_mm512_fmadd_ps(ends, padding_, slack_), _mm512_mask_mov_ps(t_min_, 0xFF00, _mm512_set1_ps(-t_end)));
    const __m256 enter = _mm512_castps512_ps256(ends);
    const __m256 apart = _mm256_add_ps(enter, _mm512_extractf32x8_ps(ends, 1));
    const __m512i place = _mm512_srlv_epi64(_mm512_set1_epi64(node.order[octant_]), _mm512_setr_epi64(28, 24, 20, 16, 12, 8, 4, 0));
    const __m256i order = _mm512_cvtepi64_epi32(place);
    const __mmask8 met = _mm256_cmp_ps_mask(_mm256_permutevar8x32_ps(apart, order), _mm256_setzero_ps(), _CMP_LE_OQ);
    const __m256i child = _mm256_permutevar8x32_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), order);
    _mm256_storeu_ps(stack.enter + stack.size, _mm256_maskz_compress_ps(met, _mm256_permutevar8x32_ps(enter, order)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(stack.child + stack.size), _mm256_maskz_compress_epi32(met, child));
    stack.size += __builtin_popcount(met);
  }

private:
  __m512 org_[3], inv_dir_[3];  ///< 1 / dir, negated in the upper half
  __m512 padding_, slack_, t_min_;
  std::uint32_t octant_;
  int first_row_[3], last_row_[3];
};
#endif

}  // namespace raymeter
