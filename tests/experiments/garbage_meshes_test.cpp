// Numerics case 57, after Embree's build_garbage_geom: 1000 meshes whose coordinates are random bits, NaN and infinity among them, and whose indices are
// garbage one time in 32. Read from a PLY file each is refused where an index is out of range; else the faces that cannot be are dropped and counted, and all
// structures end, with the hits of the list.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "accel/registry.h"
#include "core/base/error.h"
#include "core/trace/trace.h"
#include "experiments/scenes/scene_readers.h"
#include "tests/support/random.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Random;

constexpr int kMeshes = 1000;

struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;

  explicit Mesh(std::uint64_t seed) {
    Random random(seed);
    const std::size_t vertex_count = 3 + random.below(253), face_count = 1 + random.below(255);
    for (std::size_t k = 0; k < vertex_count; ++k) {
      auto& vertex = vertices.emplace_back();
      // A quarter are ordinary numbers, so that some triangles can be hit.
      for (float& x : vertex) x = k % 4 == 0 ? static_cast<float>(random.uniform(-1, 1)) : std::bit_cast<float>(random.bits());
    }
    const bool with_garbage = seed % 4 != 0;  // else hardly a mesh would be read
    for (std::size_t k = 0; k < face_count; ++k) {
      auto& face = faces.emplace_back();
      for (std::uint32_t& index : face) {
        index = with_garbage && random.below(32) == 0 ? random.bits() : static_cast<std::uint32_t>(random.below(vertex_count));
        if (k % 3 == 0) index -= index < vertex_count ? index % 4 : 0;  // of ordinary vertices
      }
    }
  }
  [[nodiscard]] bool valid() const {
    return std::ranges::all_of(faces, [&](const auto& face) { return std::ranges::all_of(face, [&](std::uint32_t i) { return i < vertices.size(); }); });
  }
  /// Faces with a coordinate that is no number of at most 2^60.
  [[nodiscard]] std::int32_t unusable() const {
    const auto usable = [&](std::uint32_t i) { return std::ranges::all_of(vertices[i], [](float x) { return std::abs(x) <= 0x1p60f; }); };
    return static_cast<std::int32_t>(std::ranges::count_if(faces, [&](const auto& face) { return !std::ranges::all_of(face, usable); }));
  }
  [[nodiscard]] std::string ply() const {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
        "property list uchar uint vertex_indices\nend_header\n",
        vertices.size(), faces.size());
    const auto put = [&](const auto& values) { bytes.append(reinterpret_cast<const char*>(values.data()), sizeof values); };
    for (const auto& vertex : vertices) put(vertex);
    for (const auto& face : faces) {
      bytes += '\3';
      put(face);
    }
    return bytes;
  }
};

/// Rays of random bits, some of them no rays, and ordinary ones.
RayBatch garbage_rays(std::uint64_t seed) {
  Random random(seed);
  RayBatch rays;
  for (int k = 0; k < 96; ++k) {
    Ray ray{{}, 0, {}, std::numeric_limits<float>::infinity()};
    for (std::size_t a = 0; a < 3; ++a) {
      ray.org[a] = k % 2 == 0 ? std::bit_cast<float>(random.bits()) : static_cast<float>(random.uniform(-2, 2));
      ray.dir[a] = k % 3 == 0 ? std::bit_cast<float>(random.bits()) : static_cast<float>(random.uniform(-1, 1));
    }
    rays.push_back(ray);
  }
  return rays;
}

HitBatch traced(const Scene& scene, const RayBatch& rays, std::string_view technique, Isa isa) {
  const TechniqueSpec spec = parse_technique(technique);
  const auto structure = spec.structure->build(scene, spec.params, 1);
  const auto intersector = structure->intersector({isa, 8, spec.params});
  intersector->prepare(rays.view(), Query::closest, 1);
  HitBatch hits;
  trace_closest(*intersector, rays, hits, 1);
  return hits;
}

/// By a few techniques and one instruction set for each mesh, in turns.
void expect_hits_of_the_list(const Scene& scene, std::uint64_t turn) {
  static const std::vector<std::string> techniques = [] {
    std::vector<std::string> texts = test::all_traversals();
    for (const char* builder : {"sweep_sah", "sbvh", "goldsmith_salmon", "lbvh", "ploc"}) texts.push_back(std::string("bvh:builder=") + builder);
    return texts;
  }();
  const Isa isa = kIsas[turn % std::size(kIsas)];
  if (!available(isa)) return;
  const RayBatch rays = garbage_rays(turn);
  const HitBatch expected = traced(scene, rays, "list", isa);
  for (std::uint64_t k = 0; k < 6; ++k) {
    const std::string& technique = techniques[(6 * turn + k) % techniques.size()];
    SCOPED_TRACE(technique);
    test::expect_same_hits(traced(scene, rays, technique, isa), expected, rays);
  }
}

TEST(GarbageMeshes, AreRefusedOrReadWithoutWhatCannotBe) {
  std::uint64_t read = 0;
  std::int64_t dropped = 0;
  for (int k = 0; k < kMeshes; ++k) {
    SCOPED_TRACE(k);
    const Mesh mesh(static_cast<std::uint64_t>(k));
    try {
      const Scene scene = read_ply({"garbage.ply", mesh.ply(), std::nullopt});
      ASSERT_TRUE(mesh.valid());
      ASSERT_EQ(scene.prim_id_count(), static_cast<std::int32_t>(mesh.faces.size()));
      ASSERT_EQ(scene.dropped_count(), mesh.unusable());
      dropped += scene.dropped_count();
      expect_hits_of_the_list(scene, read++);
    } catch (const Error& error) {
      ASSERT_FALSE(mesh.valid());
      ASSERT_NE(std::string_view(error.what()).find("is out of range; expected 0 to"), std::string_view::npos) << error.what();
    }
  }
  EXPECT_GT(read, 250U);
  EXPECT_LT(read, 500U);
  EXPECT_GT(dropped, 10'000);
}

}  // namespace
}  // namespace raymeter
