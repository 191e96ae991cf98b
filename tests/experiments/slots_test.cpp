// First hits and occlusions as slots of a technique: on the command line, in configs, in cells.
#include <gtest/gtest.h>

#include <algorithm>

#include "accel/registry.h"
#include "core/base/error.h"
#include "experiments/config/expand.h"
#include "experiments/record/catalog.h"

namespace raymeter {
namespace {

Config parse(const std::string& matrix) {
  const std::string text = R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": ["list", {"name": "bvh"}])" + matrix + "}}";
  return parse_config(text, "c.json", {}, [](const std::string&) -> const char* { return nullptr; });
}

template <class Act>
std::string error_of(Act act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of_technique(const char* text) {
  return error_of([&] { (void)parse_technique(text); });
}

TEST(SlotsOfATechnique, HoldTheFirstRowsWhereNothingIsSaid) {
  const TechniqueSpec spec = parse_technique("bvh:bins=8");
  EXPECT_EQ(spec.structure->name, "bvh");
  EXPECT_EQ(technique_text(spec.first_hit), "cast");
  EXPECT_EQ(technique_text(spec.occlusion), "none");
}

TEST(SlotsOfATechnique, AreReadInAnyOrder) {
  for (const char* text : {"grid+none+cast", "grid:density=2+cast+none", "grid+none", "grid+cast"}) {
    const TechniqueSpec spec = parse_technique(text);
    EXPECT_EQ(spec.structure->name, "grid") << text;
    EXPECT_EQ(spec.first_hit.entry, &first_hit_entry("cast")) << text;
    EXPECT_EQ(spec.occlusion.entry, &occlusion_entry("none")) << text;
  }
}

TEST(SlotsOfATechnique, LeavePlusSignsToNumbers) { EXPECT_EQ(parse_technique("grid:density=2e+0").params, parse_technique("grid:density=2").params); }

TEST(SlotsOfATechnique, SayWhatIsWrong) {
  EXPECT_EQ(error_of_technique("bvh+nune"), "unknown technique 'nune'; did you mean none?");
  EXPECT_EQ(error_of_technique("bvh+"), "unknown technique 'bvh+'; did you mean bvh?");
  EXPECT_EQ(error_of_technique("bvh+cast+cast"), "cast: stands in the same slot as cast");
  EXPECT_EQ(error_of_technique("bvh+grid"), "grid: stands in the same slot as bvh");
  EXPECT_EQ(error_of_technique("cast"), "cast: comes after a structure, as in bvh+cast");
  EXPECT_EQ(error_of_technique("bvh+none:key=light"), "none:key: unknown parameter; there are none");
}

TEST(SlotsOfAConfig, TakeNamesAndObjects) {
  const std::vector<Experiment> names = expand(parse(R"(, "first_hit": "cast", "occlusion": ["none"], "rays": ["primary", "shadow"])"));
  const std::vector<Experiment> objects = expand(parse(R"(, "first_hit": [{"name": "cast"}], "occlusion": {"name": "none"}, "rays": ["primary", "shadow"])"));
  ASSERT_EQ(names.size(), 4u);
  ASSERT_EQ(objects.size(), 4u);
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(names[i].id, objects[i].id);
  EXPECT_EQ(error_of([] { (void)parse(R"(, "occlusion": {"name": "shade"})"); }).substr(0, 56), "c.json: matrix.occlusion.name: unknown technique 'shade'");
  EXPECT_EQ(error_of([] { (void)parse(R"(, "occlusion": {"name": "none", "key": 1})"); }).substr(0, 43), "c.json: matrix.occlusion.key: unknown key; ");
}

TEST(SlotsOfAConfig, DoNotChangeTheIdsOfCellsThatNameNone) {
  const Experiment cell = expand(parse("")).front();
  EXPECT_EQ(expand(parse(R"(, "first_hit": "cast", "occlusion": {"name": "none"})")).front().id, cell.id);
  // As it stood there before slots had tables.
  for (const char* member : {R"("first_hit":"cast")", R"("occlusion":"none")"}) EXPECT_NE(canonical_json(cell).find(member), std::string::npos) << member;
}

TEST(SlotsOfAConfig, AreFieldsOfCells) {
  const Experiment cell = expand(parse("")).front();
  EXPECT_EQ(field(cell, "first_hit"), "cast");
  EXPECT_EQ(field(cell, "first_hit.name"), "cast");
  EXPECT_EQ(field(cell, "occlusion"), "none");
  EXPECT_EQ(technique_text(cell), "list:" + params_text(cell.params));
  const std::vector<std::string> keys = field_keys();
  for (const TechniqueInfo& technique : techniques()) {
    for (const ParamInfo& info : technique.params()) {
      EXPECT_TRUE(std::ranges::count(keys, std::string(technique.slot) + "." + std::string(info.key)) == 1) << info.key;
    }
  }
}

TEST(SlotsOfAConfig, ExpandTheirParameters) {
  const std::vector<Experiment> cells =
      expand(parse(R"(, "rays": "shadow", "occlusion": ["none", {"name": "shadow_cache", "key": ["light", "light_object"]}])"));
  ASSERT_EQ(cells.size(), 6u);
  EXPECT_EQ(field(cells[1], "occlusion.key"), "light");
  EXPECT_EQ(field(cells[0], "occlusion.key"), std::nullopt);
  EXPECT_EQ(technique_text(cells[1]), technique_text("list", cells[1].params) + "+shadow_cache:key=light,update=batch,batch=512,forget=false");
  EXPECT_NE(cells[1].id, cells[2].id);
  EXPECT_EQ(
      error_of([] { (void)expand(parse(R"(, "rays": "shadow", "occlusion": {"name": "shadow_cache", "update": "serial", "batch": 2})")); }),
      "c.json: matrix.occlusion.batch: does nothing beside the other parameters, expected its default, 512, got 2 (rays of a batch, in images within a tile of "
      "4096 pixels: fewer learn "
      "sooner, more share packets and threads)");
}

TEST(SlotsOfAConfig, AreFilteredAndExcludedBy) {
  const std::string matrix = R"(, "rays": "shadow", "occlusion": ["none", {"name": "shadow_cache", "key": ["light", "light_object"]}])";
  EXPECT_EQ(expand(parse(matrix), parse_filter("occlusion=shadow_cache")).size(), 4u);
  EXPECT_EQ(expand(parse(matrix), parse_filter("occlusion=*key=light,*")).size(), 2u);
  EXPECT_EQ(expand(parse(matrix), parse_filter("occlusion.key=light_object;structure=bvh")).size(), 1u);
  EXPECT_EQ(expand(parse(matrix), parse_filter("occlusion.name=none")).size(), 2u);
  const std::string excluded =
      R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": "bvh")" + matrix + R"(}, "exclude": [{"occlusion.key": "light"}]})";
  EXPECT_EQ(expand(parse_config(excluded, "c.json", {}, nullptr)).size(), 2u);
}

TEST(SlotsOfAConfig, HoldTheirDefaultsWhereRaysDoNotComeByThem) {
  const std::vector<Experiment> cells = expand(parse(R"(, "rays": ["primary", "ambient_occlusion", "shadow"], "occlusion": ["none", "shadow_cache"])"));
  EXPECT_EQ(cells.size(), 2u * (1 + 1 + 2));
  for (const Experiment& cell : cells) {
    EXPECT_TRUE(cell.rays.name == "shadow" || technique_text(cell.occlusion) == "none") << cell.rays.name;
  }
  EXPECT_EQ(error_of([] { (void)expand(parse(R"(, "rays": ["primary", "random"], "occlusion": ["none", "shadow_cache"])")); }),
            "c.json: matrix.occlusion[1]: shadow_cache has no part in matrix.rays, expected shadow or image there");
}

TEST(SlotsOfAConfig, AreWhatAReferenceMayDifferIn) {
  const Config config = parse_config(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": ["list", "bvh"], "rays": "shadow",
      "occlusion": ["none", {"name": "shadow_cache", "key": ["light", "light_object"]}]}, "measure": {"reference": {"occlusion": "none"}}})",
                                     "c.json", {}, nullptr);
  EXPECT_EQ(reference_cells(config, expand(config)), (std::vector<std::optional<std::size_t>>{0, 0, 0, 3, 3, 3}));
}

TEST(SlotsOfAConfig, AreKnownToTheCatalogue) {
  const std::string json = techniques_json();
  for (const TechniqueInfo& technique : techniques()) {
    EXPECT_NE(json.find("\"name\": \"" + std::string(technique.name) + "\",\n    \"slot\": \"" + std::string(technique.slot) + '"'), std::string::npos);
    EXPECT_EQ(technique_info(technique.name).slot, technique.slot);
  }
}

}  // namespace
}  // namespace raymeter
