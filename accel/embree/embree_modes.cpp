#include "accel/embree/embree_modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/trace/intersector.h"
#include "core/trace/slices.h"

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// What Embree is called with and by, for N rays at a time.
template <int N>
struct Width;
template <>
struct Width<1> {
  using RayHit = RTCRayHit;
  using Ray = RTCRay;
  static void intersect(const int*, RTCScene scene, RTCIntersectContext* context, RayHit* rays) noexcept { rtcIntersect1(scene, context, rays); }
  static void occluded(const int*, RTCScene scene, RTCIntersectContext* context, Ray* rays) noexcept { rtcOccluded1(scene, context, rays); }
};
template <>
struct Width<4> {
  using RayHit = RTCRayHit4;
  using Ray = RTCRay4;
  static constexpr auto intersect = rtcIntersect4;
  static constexpr auto occluded = rtcOccluded4;
};
template <>
struct Width<8> {
  using RayHit = RTCRayHit8;
  using Ray = RTCRay8;
  static constexpr auto intersect = rtcIntersect8;
  static constexpr auto occluded = rtcOccluded8;
};
template <>
struct Width<16> {
  using RayHit = RTCRayHit16;
  using Ray = RTCRay16;
  static constexpr auto intersect = rtcIntersect16;
  static constexpr auto occluded = rtcOccluded16;
};

/// Embree's FLT_LARGE: coordinates beyond it are not supported, and Debian's build of Embree ends the program where it meets such a ray among coherent ones.
constexpr float kLargestCoordinate = 1.844e18f;

bool valid(const RayView& rays, std::int32_t i) noexcept {
  bool supported = true, moves = false;
  for (int a = 0; a < 3; ++a) {
    supported = supported && std::abs(rays.org[a][i]) <= kLargestCoordinate && std::abs(rays.dir[a][i]) <= kLargestCoordinate;  // no NaN is
    moves = moves || rays.dir[a][i] != 0;
  }
  return supported && moves && rays.t_min[i] <= rays.t_max[i];
}

/// Field f of ray i in a packet of N: Embree's packets are arrays of N floats in the order of the fields of its single ray.
enum Field : int {
  org_x,
  org_y,
  org_z,
  t_near,
  dir_x,
  dir_y,
  dir_z,
  time_of,
  t_far,
  mask,
  id,
  flags,
  kRayFields,
  normal_x = kRayFields,
  normal_y,
  normal_z,
  u_of,
  v_of,
  prim_of,
  geometry_of,
  instance_of,
  kRayHitFields
};
static_assert(sizeof(RTCRay) == kRayFields * sizeof(float) && sizeof(RTCRayHit16) == kRayHitFields * 16 * sizeof(float));

/// Fills `count` rays of a packet of N; those beyond, and invalid ones, end before they begin.
template <int N>
void fill_ray(float* field, const RayView& rays, std::int32_t first, std::int32_t count) noexcept {
  for (int a = 0; a < 3; ++a) {
    std::memcpy(field + (org_x + a) * N, rays.org[a] + first, N * sizeof(float));  // columns are readable a packet past their end
    std::memcpy(field + (dir_x + a) * N, rays.dir[a] + first, N * sizeof(float));
  }
  std::memcpy(field + t_near * N, rays.t_min + first, N * sizeof(float));
  std::memcpy(field + t_far * N, rays.t_max + first, N * sizeof(float));
  for (int lane = 0; lane < N; ++lane) field[t_near * N + lane] = std::max(field[t_near * N + lane], 0.0f);  // Embree looks ahead only, and asserts so
  std::fill_n(field + time_of * N, N, 0.0f);
  std::memset(field + mask * N, 0xFF, N * sizeof(float));
  std::memset(field + id * N, 0, 2 * N * sizeof(float));  // and flags
  for (int lane = 0; lane < N; ++lane) {
    if (lane < count && valid(rays, first + lane)) continue;
    for (int a = 0; a < 3; ++a) {
      field[(org_x + a) * N + lane] = 0;
      field[(dir_x + a) * N + lane] = 1;
    }
    field[t_near * N + lane] = kInf;
    field[t_far * N + lane] = -kInf;
  }
}

template <int N, Query Q>
using Packet = std::conditional_t<Q == Query::closest, typename Width<N>::RayHit, typename Width<N>::Ray>;

template <int N, Query Q>
void fill(const RayView& rays, std::byte* out) noexcept {
  auto* const packet = reinterpret_cast<Packet<N, Q>*>(out);
  for (std::int32_t first = 0, p = 0; first < rays.count; first += N, ++p) {
    fill_ray<N>(reinterpret_cast<float*>(&packet[p]), rays, first, std::min(N, rays.count - first));
    if constexpr (Q == Query::closest) {
      std::memset(&packet[p].hit.geomID, 0xFF, sizeof packet[p].hit.geomID);
      std::memset(&packet[p].hit.instID, 0xFF, sizeof packet[p].hit.instID);
    }
  }
}

template <class T>
T lane_of(const T& single, int) noexcept {
  return single;
}
template <class T>
T lane_of(const T* packet, int lane) noexcept {
  return packet[lane];
}

template <int N>
void store_hits(const EmbreeScene& scene, const typename Width<N>::RayHit* packet, const HitView& hits, std::int32_t count) noexcept {
  for (std::int32_t i = 0; i < count; ++i) {
    const auto& p = packet[i / N];
    const int lane = i % N;
    const unsigned geometry = lane_of(p.hit.geomID, lane);
    const bool met = geometry != RTC_INVALID_GEOMETRY_ID;
    const bool has_uv = geometry == 0;
    hits.t[i] = met ? lane_of(p.ray.tfar, lane) : kInf;
    hits.prim[i] = met ? scene.prim(geometry, lane_of(p.hit.primID, lane)) : -1;
    hits.u[i] = has_uv ? lane_of(p.hit.u, lane) : 0;
    hits.v[i] = has_uv ? lane_of(p.hit.v, lane) : 0;
  }
}

std::int32_t blocked(float t_far, float t_near) noexcept {
  // A blocked ray's end is -inf; so is the end of a ray that is not to be traced, which begins at +inf.
  return t_far == -kInf && t_near != kInf ? kUnknownBlocker : -1;
}

template <int N, Query Q>
void trace_packets(const EmbreeScene& scene, RTCIntersectContext& context, std::byte* rays, const HitView& hits, std::int32_t* blocker,
                   std::int32_t count) noexcept {
  auto* const packet = reinterpret_cast<Packet<N, Q>*>(rays);
  alignas(64) int live[N];
  for (std::int32_t first = 0, p = 0; first < count; first += N, ++p) {
    const auto* const field = reinterpret_cast<const float*>(&packet[p]);
    for (int lane = 0; lane < N; ++lane) live[lane] = field[t_near * N + lane] <= field[t_far * N + lane] ? -1 : 0;
    if constexpr (Q == Query::closest)
      Width<N>::intersect(live, scene.get(), &context, &packet[p]);
    else
      Width<N>::occluded(live, scene.get(), &context, &packet[p]);
  }
  if constexpr (Q == Query::closest) {
    store_hits<N>(scene, packet, hits, count);
  } else {
    for (std::int32_t i = 0; i < count; ++i) blocker[i] = blocked(lane_of(packet[i / N].tfar, i % N), lane_of(packet[i / N].tnear, i % N));
  }
}

template <Query Q>
void trace_stream(const EmbreeScene& scene, RTCIntersectContext& context, std::byte* rays, const HitView& hits, std::int32_t* blocker,
                  std::int32_t count) noexcept {
  auto* const ray = reinterpret_cast<Packet<1, Q>*>(rays);
  const auto size = static_cast<unsigned>(count);
  if constexpr (Q == Query::closest) {
    rtcIntersect1M(scene.get(), &context, ray, size, sizeof *ray);
    store_hits<1>(scene, ray, hits, count);
  } else {
    rtcOccluded1M(scene.get(), &context, ray, size, sizeof *ray);
    for (std::int32_t i = 0; i < count; ++i) blocker[i] = blocked(ray[i].tfar, ray[i].tnear);
  }
}

/// A slice's columns one behind the other, each of kStride floats: those of rays, then for closest those of hits.
constexpr std::int32_t kStride = kSliceRays;

void fill_columns(const RayView& rays, Query query, float* column) noexcept {
  for (std::int32_t first = 0; first < rays.count; first += 16) {
    float packet[kRayFields * 16];
    fill_ray<16>(packet, rays, first, std::min(16, rays.count - first));
    for (int f = 0; f < kRayFields; ++f) std::memcpy(column + f * kStride + first, packet + f * 16, sizeof(float) * 16);
  }
  if (query == Query::closest) std::memset(column + geometry_of * kStride, 0xFF, 2 * kStride * sizeof(float));
}

void trace_columns(const EmbreeScene& scene, RTCIntersectContext& context, Query query, float* column, const HitView& hits, std::int32_t* blocker,
                   std::int32_t count) noexcept {
  const auto floats = [&](Field field) { return column + field * kStride; };
  const auto words = [&](Field field) { return reinterpret_cast<unsigned*>(floats(field)); };
  RTCRayHitNp all{{floats(org_x), floats(org_y), floats(org_z), floats(t_near), floats(dir_x), floats(dir_y), floats(dir_z), floats(time_of), floats(t_far),
                   words(mask), words(id), words(flags)},
                  {}};
  const auto size = static_cast<unsigned>(count);
  if (query == Query::any) {
    rtcOccludedNp(scene.get(), &context, &all.ray, size);
    for (std::int32_t i = 0; i < count; ++i) blocker[i] = blocked(all.ray.tfar[i], all.ray.tnear[i]);
    return;
  }
  all.hit = {floats(normal_x), floats(normal_y), floats(normal_z), floats(u_of), floats(v_of), words(prim_of), words(geometry_of), {words(instance_of)}};
  rtcIntersectNp(scene.get(), &context, &all, size);
  for (std::int32_t i = 0; i < count; ++i) {
    const unsigned geometry = all.hit.geomID[i];
    const bool met = geometry != RTC_INVALID_GEOMETRY_ID;
    hits.t[i] = met ? all.ray.tfar[i] : kInf;
    hits.prim[i] = met ? scene.prim(geometry, all.hit.primID[i]) : -1;
    hits.u[i] = geometry == 0 ? all.hit.u[i] : 0;
    hits.v[i] = geometry == 0 ? all.hit.v[i] : 0;
  }
}

constexpr std::array kModes{EmbreeMode{EmbreeLayout::packet16, true},    EmbreeMode{EmbreeLayout::packet16, false}, EmbreeMode{EmbreeLayout::packet8, true},
                            EmbreeMode{EmbreeLayout::packet8, false},    EmbreeMode{EmbreeLayout::packet4, true},   EmbreeMode{EmbreeLayout::packet4, false},
                            EmbreeMode{EmbreeLayout::stream, true},      EmbreeMode{EmbreeLayout::stream, false},   EmbreeMode{EmbreeLayout::stream_soa, true},
                            EmbreeMode{EmbreeLayout::stream_soa, false}, EmbreeMode{EmbreeLayout::single, true}};

constexpr int width_of(EmbreeLayout layout) noexcept {
  switch (layout) {
    case EmbreeLayout::packet4: return 4;
    case EmbreeLayout::packet8: return 8;
    case EmbreeLayout::packet16: return 16;
    default: return 1;
  }
}

/// Calls call.operator()<N, Q>() for the width of a layout of packets and the query.
template <class Call>
void dispatch(EmbreeLayout layout, Query query, Call&& call) noexcept {
  const auto with_query = [&]<int N>() {
    if (query == Query::closest)
      call.template operator()<N, Query::closest>();
    else
      call.template operator()<N, Query::any>();
  };
  switch (width_of(layout)) {
    case 4: return with_query.template operator()<4>();
    case 8: return with_query.template operator()<8>();
    case 16: return with_query.template operator()<16>();
    default: return with_query.template operator()<1>();
  }
}

}  // namespace

std::span<const EmbreeMode> embree_modes() noexcept { return kModes; }

std::string_view name(EmbreeLayout layout) noexcept {
  constexpr std::array names{"single", "packet4", "packet8", "packet16", "stream", "stream_soa"};
  return names[static_cast<std::size_t>(layout)];
}

std::size_t embree_bytes(EmbreeLayout layout, Query query, std::int32_t count) noexcept {
  std::size_t bytes = std::size_t{kStride} * sizeof(float) * (query == Query::closest ? kRayHitFields : kRayFields);
  if (layout == EmbreeLayout::stream_soa) return bytes * ((static_cast<std::size_t>(count) + kStride - 1) / kStride);
  dispatch(layout, query, [&]<int N, Query Q>() { bytes = (static_cast<std::size_t>(count) + N - 1) / N * sizeof(Packet<N, Q>); });
  return bytes;
}

void to_embree(EmbreeLayout layout, Query query, const RayView& rays, std::byte* out) noexcept {
  if (layout == EmbreeLayout::stream_soa) return fill_columns(rays, query, reinterpret_cast<float*>(out));
  dispatch(layout, query, [&]<int N, Query Q>() { fill<N, Q>(rays, out); });
}

void trace_embree(const EmbreeScene& scene, EmbreeMode mode, Query query, std::byte* rays, const HitView& hits, std::int32_t* blocker,
                  std::int32_t count) noexcept {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = mode.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  if (mode.layout == EmbreeLayout::stream_soa) return trace_columns(scene, context, query, reinterpret_cast<float*>(rays), hits, blocker, count);
  dispatch(mode.layout, query, [&]<int N, Query Q>() {
    if (mode.layout == EmbreeLayout::stream)
      trace_stream<Q>(scene, context, rays, hits, blocker, count);
    else
      trace_packets<N, Q>(scene, context, rays, hits, blocker, count);
  });
}

}  // namespace raymeter
