// Parameters that mean nothing beside others make no cells of their own, nor builds.

#include <gtest/gtest.h>

#include <set>

#include "accel/registry.h"
#include "core/base/error.h"
#include "experiments/config/expand.h"
#include "experiments/record/tables.h"
#include "tests/support/expect_error.h"

namespace raymeter {
namespace {

std::vector<Experiment> cells(const std::string& structure, const std::string& more = "") {
  const std::string text = R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": )" + structure + "}" + more + "}";
  return expand(parse_config(text, "c.json", {}, [](const std::string&) -> const char* { return nullptr; }));
}

TEST(UsedParams, AreAllThatIsResolved) {
  EXPECT_EQ(params_text(parse_technique("list").params), "volume=none");
  EXPECT_EQ(params_text(parse_technique("list:volume=kdop").params), "volume=kdop,around=primitive,k=14,directions=");
  EXPECT_EQ(params_text(parse_technique("bvh:builder=ploc,volume=sphere").params),
            "volume=sphere,builder=ploc,traversal=packet,max_leaf_size=8,node_cost=1,ploc_radius=14,reinsertion=0,width=0,tight=false");
  EXPECT_EQ(params_text(parse_technique("bvh:builder=goldsmith_salmon,insertion_order=file").params),
            "volume=aabb,builder=goldsmith_salmon,traversal=auto,group=256,max_leaf_size=8,insertion_order=file,inherited=true,leaf_boxes=true,reinsertion=0");
  EXPECT_EQ(params_text(parse_technique("bvh:builder=goldsmith_salmon,insertion_order=file,traversal=packet").params),
            "volume=aabb,builder=goldsmith_salmon,traversal=packet,insertion_order=file,inherited=true,leaf_boxes=true,reinsertion=0,width=0,box_test=padded,"
            "box_bounds=padded,reciprocal=divide,triangle_test=woop_kahan,sphere_test=robust");
}

TEST(UsedParams, BringPacketsWhereNothingElseServes) {
  const auto traversal = [](const char* technique) {
    for (const auto& [key, value] : parse_technique(technique).params) {
      if (key == "traversal") return to_string(value);
    }
    return std::string();
  };
  for (const char* any : {"bvh", "bvh:builder=sbvh", "bvh:max_leaf_size=1", "bvh:box_test=padded", "bvh:width=0"}) EXPECT_EQ(traversal(any), "auto") << any;
  for (const char* bound : {"bvh:volume=sphere", "bvh:width=4", "bvh:box_test=fma", "bvh:triangle_test=moeller_trumbore,precision=double",
                            "bvh:sphere_test=naive", "bvh:traversal=auto,volume=obb"}) {
    EXPECT_EQ(traversal(bound), "packet") << bound;
  }
  expect_error_message([] { (void)parse_technique("bvh:traversal=beam,volume=sphere"); }, "bvh:traversal: beam needs volume=aabb, got sphere");
  expect_error_message([] { (void)parse_technique("bvh:group=40"); }, "bvh:group: expected a multiple of 16, got 40");
}

TEST(UsedParams, OthersAreRefusedUnlessTheyAreAtTheirDefaults) {
  EXPECT_EQ(params_text(parse_technique("list:k=14").params), "volume=none");
  expect_error_message([] { (void)parse_technique("list:volume=aabb,k=26"); },
                       "list:k: does nothing beside the other parameters, expected its default, 14, got 26 (kdop without directions: planes; 6, 8, 12, 14, "
                       "18, 20 or 26)");
  expect_error_message(
      [] { (void)cells(R"({"name": "bvh", "volume": ["aabb", "sphere"], "k": 26})"); },
      "c.json: matrix.structure.k: does nothing beside the other parameters, expected its default, 14, got 26 (kdop without directions: planes; 6, "
      "8, 12, 14, 18, 20 or 26)");
}

TEST(UsedParams, MakeTheCellsOfAProduct) {
  EXPECT_EQ(cells(R"({"name": "bvh", "volume": ["aabb", "sphere", "obb", "kdop"], "k": [6, 14, 26]})").size(), 6u);
  EXPECT_EQ(cells(R"({"name": "bvh", "builder": ["lbvh", "sbvh"], "bins": [8, 32], "split_budget": [0.5, 1]})").size(), 5u);
}

TEST(UsedParams, AtTheirDefaultsChangeNoId) {
  const Experiment cell = cells(R"({"name": "bvh", "bins": 16})").front();
  Experiment older = cell;  // of a time when bvh had fewer parameters
  std::erase_if(older.params, [](const auto& param) { return param.first == "reinsertion"; });
  EXPECT_NE(canonical_json(older), canonical_json(cell)) << "records show all";
  EXPECT_EQ(cells(R"({"name": "bvh", "bins": 16, "reinsertion": 0})").front().id, cell.id);
  EXPECT_EQ(cell_identity(older), cell.id);
  EXPECT_NE(cells(R"({"name": "bvh", "bins": 16, "reinsertion": 1})").front().id, cell.id);
}

TEST(UsedParams, AReferenceMayHaveFewerOfThem) {
  const std::string reference = R"(, "measure": {"reference": {"structure.volume": "aabb"}})";
  const std::string structure = R"({"name": "bvh", "traversal": "packet", "volume": ["aabb", "kdop"], "k": [6, 14]})";
  const Config config = parse_config(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": )" + structure + "}" + reference + "}", "c.json", {},
                                     [](const std::string&) -> const char* { return nullptr; });
  EXPECT_EQ(reference_cells(config, expand(config)), (std::vector<std::optional<std::size_t>>{0, 0, 0}));
}

TEST(UsedParams, PacketsAndTheHeapShareABuildAndBeamsAndStreamsAnother) {
  const std::vector<Experiment> all = cells(R"({"name": "bvh", "traversal": ["packet", "heap", "beam", "stream"]})");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(build_text(all[0]), "bvh:volume=aabb,builder=binned_sah,traversal=packet|heap,bins=32,max_leaf_size=8,node_cost=1,reinsertion=0,width=0");
  EXPECT_EQ(build_text(all[1]), build_text(all[0]));
  EXPECT_EQ(build_text(all[2]), "bvh:volume=aabb,builder=binned_sah,traversal=beam|stream|single|auto,bins=32,max_leaf_size=8,node_cost=1,reinsertion=0");
  EXPECT_EQ(build_text(all[3]), build_text(all[2]));
}

TEST(UsedParams, ChoicesOfAQueryOutsideItsGroupsHaveBuildsOfTheirOwn) {
  const std::vector<Experiment> all =
      cells(R"({"name": "bvh", "traversal": "packet", "triangle_test": ["woop_kahan", "pluecker", "baldwin_weber"], "box_bounds": ["padded", "tight"]})");
  ASSERT_EQ(all.size(), 6u);
  std::set<std::string> builds;
  for (const Experiment& cell : all) builds.insert(build_text(cell));
  EXPECT_EQ(builds.size(), 4u) << "as usual, tight, with maps, both";
}

}  // namespace
}  // namespace raymeter
