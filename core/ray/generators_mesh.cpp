#include "core/ray/generators_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "core/base/random.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

using glm::dvec3;
using Vertex = std::array<float, 3>;

/// Vertex k of the triangle or polygon, k counting round the outline.
Vertex vertex(const Pools& pools, PrimRef ref, std::size_t k) {
  const bool triangle = ref.kind() == PrimKind::triangle;
  const FloatColumns3& columns = triangle ? pools.triangles.vertex[k % 3] : pools.polygons.vertex;
  std::size_t i = ref.index;
  if (!triangle) {
    const auto first = static_cast<std::size_t>(pools.polygons.first_vertex[ref.index]);
    i = first + k % (static_cast<std::size_t>(pools.polygons.first_vertex[ref.index + 1]) - first);
  }
  return {columns[0][i] + 0.0f, columns[1][i] + 0.0f, columns[2][i] + 0.0f};  // + 0: no -0
}

std::size_t vertex_count(const Pools& pools, PrimRef ref) {
  if (ref.kind() == PrimKind::triangle) return 3;
  return static_cast<std::size_t>(pools.polygons.first_vertex[ref.index + 1] - pools.polygons.first_vertex[ref.index]);
}

bool is_facet(PrimRef ref) noexcept { return !ref.dropped() && (ref.kind() == PrimKind::triangle || ref.kind() == PrimKind::polygon); }

std::vector<PrimRef> facets(const Scene& scene) {
  std::vector<PrimRef> refs;
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    if (is_facet(scene.prim(prim))) refs.push_back(scene.prim(prim));
  }
  return refs;
}

/// Without those that lie on one another in pairs, as in a sheet of two sides: no solid lies between them.
std::vector<PrimRef> bounding_facets(const Scene& scene) {
  std::vector<std::pair<std::vector<Vertex>, PrimRef>> outlines;
  for (const PrimRef ref : facets(scene)) {
    std::vector<Vertex> outline(vertex_count(scene.pools(), ref));
    for (std::size_t k = 0; k < outline.size(); ++k) outline[k] = vertex(scene.pools(), ref, k);
    std::ranges::sort(outline);
    outlines.emplace_back(std::move(outline), ref);
  }
  std::ranges::sort(outlines, {}, [](const auto& one) -> const std::vector<Vertex>& { return one.first; });
  std::vector<PrimRef> left;
  for (std::size_t first = 0; first < outlines.size();) {
    std::size_t end = first + 1;
    while (end < outlines.size() && outlines[end].first == outlines[first].first) ++end;
    if ((end - first) % 2 != 0) left.push_back(outlines[first].second);
    first = end;
  }
  return left;
}

dvec3 point(const Vertex& v) noexcept { return {v[0], v[1], v[2]}; }

/// Lets rays that start on the scene's box, on one of whose sides facets may lie, start well outside it.
void start_outside(RayBatch& lines) {
  double reach2 = 0;
  for (const Column<float>& org : lines.org) {
    const auto [least, most] = std::minmax_element(org.begin(), org.end());
    if (!org.empty()) reach2 += (double{*most} - double{*least}) * (double{*most} - double{*least});
  }
  std::fill(lines.t_min.begin(), lines.t_min.end(), static_cast<float>(-0.01 * std::sqrt(reach2)));
}

/// Middles of chords: lines at random through the scene's box, from where they enter the scene to where they leave it again.
std::vector<dvec3> inner_points(const Scene& scene, std::uint64_t seed, const Intersector& tracer, int threads) {
  constexpr int kLines = 1024;
  constexpr double kShort = 1e-2;  // of the longest chord: a line that only grazes is in doubt
  RayBatch lines = make_rays(scene, RayKind::random, {scene.camera, CameraConvention::pixel, kLines, 1}, seed, tracer, threads).rays;
  start_outside(lines);
  HitBatch enter, leave;
  trace_closest(tracer, lines, enter, threads);
  for (std::size_t i = 0; i < lines.size(); ++i) lines.t_min[i] = std::nextafter(enter.t[i], std::numeric_limits<float>::infinity());
  trace_closest(tracer, lines, leave, threads);
  std::vector<dvec3> middles;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (leave.prim[i] < 0) continue;
    const Ray ray = lines[i];
    const dvec3 dir(ray.dir[0], ray.dir[1], ray.dir[2]);
    middles.push_back(dvec3(ray.org[0], ray.org[1], ray.org[2]) + (double{enter.t[i]} + double{leave.t[i]}) / 2 * dir);
    lengths.push_back((double{leave.t[i]} - double{enter.t[i]}) * glm::length(dir));
  }
  const double longest = lengths.empty() ? 0 : *std::max_element(lengths.begin(), lengths.end());
  std::vector<dvec3> inner;
  for (std::size_t k = 0; k < middles.size(); ++k) {
    if (lengths[k] > kShort * longest) inner.push_back(middles[k]);
  }
  return inner;
}

dvec3 aim(const Pools& pools, PrimRef ref, RayKind kind, RandomStream& random) {
  const std::size_t k = static_cast<std::size_t>(random.bits() % vertex_count(pools, ref));
  const dvec3 a = point(vertex(pools, ref, k));
  if (kind == RayKind::vertices) return a;
  const dvec3 ab = point(vertex(pools, ref, k + 1)) - a;
  if (kind == RayKind::edges) return a + random.uniform() * ab;
  double u = random.uniform(), v = random.uniform();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return a + u * ab + v * (point(vertex(pools, ref, k + 2)) - a);
}

}  // namespace

bool is_closed(const Scene& scene) {
  for (std::int32_t prim = 0; prim < scene.prim_id_count(); ++prim) {
    if (!scene.prim(prim).dropped() && !is_facet(scene.prim(prim))) return false;
  }
  std::vector<std::array<Vertex, 2>> edges;
  for (const PrimRef ref : bounding_facets(scene)) {
    Vertex a = vertex(scene.pools(), ref, 0);
    for (std::size_t k = 1; k <= vertex_count(scene.pools(), ref); ++k) {
      const Vertex b = vertex(scene.pools(), ref, k);
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
      a = b;
    }
  }
  std::ranges::sort(edges);
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t end = first + 1;
    while (end < edges.size() && edges[end] == edges[first]) ++end;
    if ((end - first) % 2 != 0) return false;
    first = end;
  }
  return !edges.empty();
}

RaySet mesh_rays(const Scene& scene, RayKind kind, std::int32_t count, std::uint64_t seed, const Intersector& tracer, int threads) {
  const std::vector<PrimRef> refs = facets(scene);
  if (refs.empty()) return {};
  const std::vector<dvec3> from = inner_points(scene, seed, tracer, threads);
  if (from.empty()) return {};
  RaySet set;
  set.rays.resize(static_cast<std::size_t>(count));
  set.pixel.resize(set.rays.size());
  for_each_slice(set.rays.size(), threads, [&](std::size_t, std::size_t first, std::size_t slice) {
    for (std::size_t i = first; i < first + slice; ++i) {
      RandomStream random(seed, static_cast<std::uint64_t>(kind) << 40 | i);
      // The origin is rounded first, so that the direction is off by its own rounding only.
      const glm::vec3 org(from[random.bits() % from.size()]);
      const glm::vec3 dir(aim(scene.pools(), refs[random.bits() % refs.size()], kind, random) - dvec3(org));
      set.rays.set(i, {{org.x, org.y, org.z}, 0, {dir.x, dir.y, dir.z}, std::numeric_limits<float>::infinity()});
      set.pixel[i] = static_cast<std::int32_t>(i);
    }
  });
  if (is_closed(scene)) set.expected.prim.resize(set.rays.size(), ExpectedHits::kSomething);
  return set;
}

}  // namespace raymeter
