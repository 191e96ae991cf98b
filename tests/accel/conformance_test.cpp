// What every row of the table of techniques must keep, on every instruction set, scene and packet size, with its default parameters and others.

#include <algorithm>
#include <array>
#include <ostream>
#include <set>

#include <gtest/gtest.h>

#include "accel/registry.h"
#include "accel/weak_settings.h"
#include "experiments/verify/verify.h"
#include "tests/support/capsule_bvh.h"
#include "tests/support/test_rays.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Blockers;
using test::expect_same_hits;
using test::Reference;
using test::scene_named;
using test::scenes;
using test::trace;
using test::trace_list;
using test::Traced;

struct Case {
  const StructureEntry* entry;
  Isa isa;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  const auto add = [&](const StructureEntry& entry) {
    for (const Isa isa : kIsas) cases.push_back({&entry, isa});
  };
  for (const StructureEntry& entry : structures()) add(entry);
  add(test::capsule_bvh_entry());
  return cases;
}

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.entry->name << '_' << name(c.isa); }

std::vector<int> packet_sizes(Isa isa) {
  std::set<int> sizes{1, 3, simd_width(isa), 2 * simd_width(isa), 16, kMaxPacket};
  return {sizes.begin(), sizes.end()};
}

/// Other values of a parameter: all choices, both switches, the least number and three times the default.
std::vector<ParamValue> other_values(const ParamInfo& info) {
  std::vector<ParamValue> values;
  if (const auto* flag = std::get_if<bool>(&info.default_value)) values.emplace_back(!*flag);
  if (const auto* whole = std::get_if<std::int64_t>(&info.default_value)) {
    for (const double number : {info.min, std::clamp(3.0 * static_cast<double>(*whole), info.min, info.max)})
      values.emplace_back(static_cast<std::int64_t>(number));
  }
  if (const auto* number = std::get_if<double>(&info.default_value)) {
    for (const double other : {info.min, std::clamp(3 * *number, info.min, info.max)}) values.emplace_back(other);
  }
  for (const std::string_view choice : info.choices) values.emplace_back(std::string(choice));
  std::erase(values, info.default_value);
  return values;
}

/// Parameters that mean something only together, besides those that are tried one at a time. An asterisk stands for all choices of its parameter.
constexpr std::array kTogether{
    "list:volume=aabb,around=object",
    "list:volume=sphere,tight=on,around=object",
    "list:volume=obb,axes=object,around=object",
    "list:volume=kdop,k=26,around=object",
    "bvh:volume=sphere,traversal=heap",
    "bvh:volume=sphere,tight=on,builder=goldsmith_salmon",
    "bvh:volume=obb,traversal=heap,axes=pca",
    "bvh:volume=obb,axes=object,width=4",
    "bvh:volume=kdop,traversal=heap,k=26",
    "bvh:volume=kdop,k=6,builder=goldsmith_salmon",
    "bvh:volume=kdop,directions=1 0.25 0/-0.5 2 0.125/3 1 -4/0 0 1",
    "bvh:traversal=heap,builder=goldsmith_salmon",
    "bvh:builder=*",
    "bvh:traversal=beam,builder=*",
    "bvh:traversal=beam,builder=goldsmith_salmon,leaf_boxes=off",
    "bvh:traversal=beam,builder=sweep_sah,reinsertion=2",
    "bvh:traversal=beam,max_leaf_size=1",
    "bvh:traversal=stream,builder=sbvh",
    "bvh:traversal=stream,max_leaf_size=1",
    "bvh:traversal=single,builder=sbvh",
    "bvh:traversal=single,max_leaf_size=1",
    "bvh:builder=goldsmith_salmon,insertion_order=*",
    "bvh:builder=goldsmith_salmon,inherited=off",
    "bvh:builder=goldsmith_salmon,leaf_boxes=off",
    "bvh:builder=sbvh,split_overlap=0,split_budget=8",
    "bvh:builder=ploc,ploc_radius=1",
};

/// The techniques that a text with an asterisk stands for.
std::vector<std::string> spelt_out(const StructureEntry& entry, std::string_view text) {
  const auto star = text.find('*');
  if (star == std::string_view::npos) return {std::string(text)};
  const std::string_view before = text.substr(0, star - 1);
  const std::string_view key = before.substr(before.find_last_of(":,") + 1);
  std::vector<std::string> texts;
  for (const ParamInfo& info : entry.params()) {
    if (info.key != key) continue;
    for (const std::string_view choice : info.choices)
      texts.push_back(std::string(text.substr(0, star)) + std::string(choice) + std::string(text.substr(star + 1)));
  }
  return texts;
}

/// The technique with its defaults first, then with one parameter changed at a time, then with those that go together.
std::vector<ParamValues> variants(const StructureEntry& entry) {
  std::vector<ParamValues> out{entry.resolve({})};
  const auto add = [&](ParamValues values) {  // one that means nothing alone makes the default
    if (answers_for_itself(entry, values)) return;
    if (std::find(out.begin(), out.end(), values) == out.end()) out.push_back(std::move(values));
  };
  for (const ParamInfo& info : entry.params()) {
    for (const ParamValue& value : other_values(info)) {
      try {
        add(entry.resolve({{std::string(info.key), value}}));
      } catch (const Error&) {
        // A value that needs another parameter to go with it is for the technique's own tests.
      }
    }
  }
  for (const std::string_view technique : kTogether) {
    if (technique.substr(0, technique.find(':')) != entry.name) continue;
    for (const std::string& one : spelt_out(entry, technique)) add(parse_technique(one).params);
  }
  return out;
}

std::string text(const ParamValues& values) {
  std::string out;
  for (const auto& [key, value] : values) out += key + "=" + to_string(value) + " ";
  return out;
}

/// Blocked exactly where a nearest hit exists, by a primitive that the oracle accepts. `accepted` remembers (ray, blocker) pairs.
void expect_blockers(const Blockers& blockers, const HitBatch& hits, const RayBatch& rays, const Oracle& oracle,
                     std::set<std::pair<std::size_t, int>>& accepted) {
  for (std::size_t i = 0; i < blockers.size(); ++i) {
    ASSERT_EQ(blockers[i] >= 0, hits.prim[i] >= 0) << "ray " << i;
    if (blockers[i] < 0 || blockers[i] == hits.prim[i] || !accepted.insert({i, blockers[i]}).second) continue;
    ASSERT_EQ(oracle.any(rays[i], blockers[i]).verdict, Verdict::correct) << "ray " << i << " blocker " << blockers[i];
  }
}

void expect_sane(const Counters& counters, int width, std::size_t rays) {
  EXPECT_EQ(counters.ray_count, rays);
  for (std::size_t e = 0; e < kEventCount; ++e) {
    EXPECT_LE(counters.rays[e], counters.packets[e] * static_cast<std::uint64_t>(width)) << "event " << e;
  }
  EXPECT_LE(counters.live(Event::prim_hit), counters.live(Event::prim_test));
  EXPECT_LE(counters.live(Event::cache_hit), counters.live(Event::cache_test));
  EXPECT_LE(counters.live(Event::empty_leaf_visit), counters.live(Event::leaf_visit));
}

class Conformance : public testing::TestWithParam<Case> {
protected:
  void SetUp() override {
    if (!available(GetParam().isa)) GTEST_SKIP() << name(GetParam().isa) << " is not available on this machine";
  }
};

TEST_P(Conformance, AgreesWithTheListBitForBit) {
  const auto& [entry, isa] = GetParam();
  const std::vector<ParamValues> params = variants(*entry);
  for (const Scene& scene : scenes()) {
    const Reference reference(scene, isa);
    const Oracle oracle(scene);
    std::set<std::pair<std::size_t, int>> accepted;
    for (const ParamValues& values : params) {
      const bool is_default = &values == &params.front();
      if (!is_default && scene.prim_count() > 250) continue;  // for time's sake
      const auto structure = entry->build(scene, values, 1);
      // A partial register and the largest packet tell enough of what is not the default: in turn, so that each scene and each variant meets both.
      const bool largest = ((&scene - scenes().data()) + (&values - params.data())) % 2 == 0;
      const std::vector<int> sizes = is_default ? packet_sizes(isa) : std::vector<int>{largest ? kMaxPacket : 3};
      for (const int packet : sizes) {
        SCOPED_TRACE(scene.name + ", " + text(values) + "packet " + std::to_string(packet));
        const Traced traced = trace(*structure, {isa, packet, values}, reference.rays);
        expect_same_hits(traced.hits, reference.list.hits, reference.rays);
        expect_blockers(traced.blockers, reference.list.hits, reference.rays, oracle, accepted);
        expect_sane(traced.closest, simd_width(isa), reference.rays.size());
        expect_sane(traced.any, simd_width(isa), reference.rays.size());
        if (HasFailure()) return;
      }
    }
  }
}

TEST_P(Conformance, CountsAndHitsDoNotDependOnThreads) {
  const auto& [entry, isa] = GetParam();
  for (const char* scene_name : {"mixed", "icosphere"}) {
    const Scene& scene = scene_named(scene_name);
    RayBatch rays = test::hard_rays(scene, 3);
    const std::size_t once = rays.size();
    for (std::size_t i = 0; i < 7 * once; ++i) rays.push_back(rays[i % once]);
    const ParamValues values = entry->resolve({});
    const auto structure = entry->build(scene, values, 1);
    for (const int packet : {simd_width(isa), kMaxPacket}) {
      const QueryOptions options{isa, packet, values};
      const Traced one = trace(*structure, options, rays, 1);
      for (const int threads : {2, 7}) {
        SCOPED_TRACE(scene.name + ", packet " + std::to_string(packet) + ", threads " + std::to_string(threads));
        const Traced many = trace(*structure, options, rays, threads);
        expect_same_hits(many.hits, one.hits, rays);
        EXPECT_TRUE(std::ranges::equal(many.blockers.span(), one.blockers.span()));
        EXPECT_EQ(many.closest, one.closest);
        EXPECT_EQ(many.any, one.any);
        const auto built_by_many = entry->build(scene, values, threads);
        const Traced rebuilt = trace(*built_by_many, options, rays, threads);
        expect_same_hits(rebuilt.hits, one.hits, rays);
        EXPECT_EQ(rebuilt.closest, one.closest) << "the structure depends on the threads that built it";
      }
    }
  }
}

TEST_P(Conformance, BatchesOfAnySize) {
  const auto& [entry, isa] = GetParam();
  const Scene& scene = scene_named("mixed");
  const ParamValues values = entry->resolve({});
  const auto structure = entry->build(scene, values, 1);
  const std::size_t width = static_cast<std::size_t>(simd_width(isa));
  const RayBatch all = test::hard_rays(scene, 5);
  ASSERT_GT(all.size(), 1025u);
  for (const std::size_t size : std::set<std::size_t>{0, 1, width - 1, width, width + 1, 2 * width + 1, 1023, 1025}) {
    RayBatch rays;
    for (std::size_t i = 0; i < size; ++i) rays.push_back(all[i]);
    const HitBatch expected = trace_list(scene, isa, rays).hits;
    for (const int packet : packet_sizes(isa)) {
      SCOPED_TRACE("size " + std::to_string(size) + ", packet " + std::to_string(packet));
      const Traced traced = trace(*structure, {isa, packet, values}, rays);
      EXPECT_EQ(traced.hits.size(), size);
      expect_same_hits(traced.hits, expected, rays);
    }
  }
}

TEST_P(Conformance, PacketsShareTheirVisits) {
  const auto& [entry, isa] = GetParam();
  if (simd_width(isa) == 1) GTEST_SKIP() << "a register of one lane shares nothing";
  const Scene& scene = scene_named("mixed");
  const RayBatch rays = test::coherent_rays(scene);
  const ParamValues values = entry->resolve({});
  const auto structure = entry->build(scene, values, 1);
  for (const int packet : {4, kMaxPacket}) {
    const Traced traced = trace(*structure, {isa, packet, values}, rays);
    // What has no nodes shares its tests.
    const bool has_nodes = entry->name != "list" && entry->name != "ray_classification";
    EXPECT_EQ(traced.closest.live(Event::node_visit) > 0, has_nodes) << "packet " << packet;
    const Event event = has_nodes ? Event::node_visit : Event::prim_test;
    EXPECT_LT(traced.closest.executed(event), traced.closest.live(event)) << "packet " << packet;
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, Conformance, testing::ValuesIn(all_cases()), testing::PrintToStringParamName());

}  // namespace
}  // namespace raymeter
