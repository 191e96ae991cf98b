#include "tests/support/traces.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <ios>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"

namespace raymeter::test {

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> scenes = hard_scenes();
  return scenes;
}

const Scene& scene_named(std::string_view name) {
  const auto at = std::ranges::find(scenes(), name, &Scene::name);
  if (at == scenes().end()) throw Error("no scene '" + std::string(name) + "'");
  return *at;
}

Traced trace(const Structure& structure, const QueryOptions& options, const RayBatch& rays, int threads) {
  const auto intersector = structure.intersector(options);
  Traced out, timed;
  intersector->prepare(rays.view(), Query::closest, threads);
  trace_closest(*intersector, rays, out.hits, threads, &out.closest);
  trace_closest(*intersector, rays, timed.hits, threads);
  intersector->prepare(rays.view(), Query::any, threads);
  trace_any(*intersector, rays, out.blockers, threads, &out.any);
  trace_any(*intersector, rays, timed.blockers, threads);
  EXPECT_TRUE(bits_equal(out.hits, timed.hits)) << "timed and counted kernels differ";
  EXPECT_TRUE(std::ranges::equal(out.blockers.span(), timed.blockers.span())) << "timed and counted kernels differ";
  return out;
}

Listed trace_list(const Scene& scene, Isa isa, const RayBatch& rays) {
  const StructureEntry& list = structure_entry("list");
  const ParamValues params = list.resolve({});
  const auto structure = list.build(scene, params, 1);
  const auto intersector = structure->intersector({isa, 16, params});
  Listed out;
  trace_closest(*intersector, rays, out.hits, 1);
  trace_any(*intersector, rays, out.blockers, 1);
  return out;
}

RayBatch reference_rays(const Scene& scene, Isa isa) {
  RayBatch rays = hard_rays(scene, 7);
  rays.append(coherent_rays(scene));
  rays.append(cut_at_hits(rays, trace_list(scene, isa, rays).hits));
  return rays;
}

std::vector<std::string> all_traversals() {
  std::vector<std::string> texts;
  for (const StructureEntry& entry : structures()) texts.emplace_back(entry.name);
  for (const char* setting : {"traversal=packet", "traversal=heap", "traversal=single", "traversal=beam", "traversal=beam,group=16", "traversal=stream",
                              "traversal=auto", "traversal=auto,group=16", "traversal=stream,plane_bits=8", "traversal=single,plane_bits=5",
                              "builder=sbvh,split_overlap=0", "volume=sphere", "volume=obb", "volume=kdop", "volume=kdop,k=26"})
    texts.push_back("bvh:" + std::string(setting));
  // ray_classification: with many rays a cell, so that its lists are long and packets' beams cull them.
  for (const char* technique : {"grid:traversal=slices", "kdtree:traversal=packet", "bsp:traversal=packet", "octree:tracking=point_location",
                                "octree:tracking=neighbour", "ray_classification:beams=true", "ray_classification:beams=true,min_rays=1000"})
    texts.emplace_back(technique);
  return texts;
}

std::string test_name(std::string_view technique) {
  std::string name(technique);
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

void expect_same_hits(const HitBatch& hits, const HitBatch& expected, const RayBatch& rays) {
  if (bits_equal(hits, expected)) return;
  int shown = 0, different = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const bool same = std::bit_cast<std::uint32_t>(hits.t[i]) == std::bit_cast<std::uint32_t>(expected.t[i]) && hits.prim[i] == expected.prim[i] &&
                      std::bit_cast<std::uint32_t>(hits.u[i]) == std::bit_cast<std::uint32_t>(expected.u[i]) &&
                      std::bit_cast<std::uint32_t>(hits.v[i]) == std::bit_cast<std::uint32_t>(expected.v[i]);
    if (same) continue;
    ++different;
    if (shown++ > 2) continue;
    const Ray ray = rays[i];
    ADD_FAILURE() << std::hexfloat << "ray " << i << ": t " << hits.t[i] << " prim " << hits.prim[i] << ", the list has t " << expected.t[i] << " prim "
                  << expected.prim[i] << "; org " << ray.org[0] << ' ' << ray.org[1] << ' ' << ray.org[2] << " dir " << ray.dir[0] << ' ' << ray.dir[1] << ' '
                  << ray.dir[2] << " in " << ray.t_min << ' ' << ray.t_max;
  }
  ADD_FAILURE() << different << " of " << hits.size() << " hits differ from the list's";
}

}  // namespace raymeter::test
