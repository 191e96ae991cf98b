#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "accel/registry.h"
#include "core/base/error.h"
#include "experiments/config/expand.h"
#include "experiments/config/schema.h"

namespace raymeter {
namespace {

const char* environment(const std::string& name) { return name == "SCENES" ? "../shared" : nullptr; }

Config parse(const std::string& text, const std::vector<std::string>& settings = {}) { return parse_config(text, "c.json", settings, environment); }

/// A config with these members of matrix, and these others.
std::string config(const std::string& matrix, const std::string& more = "") {
  return R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": [{"name": "list"}, {"name": "bvh"}])" + matrix + "}" + more + "}";
}

std::string message(const std::string& text, const std::vector<std::string>& settings = {}) {
  try {
    (void)expand(parse(text, settings));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Config, SaysWhichKeyIsUnknown) {
  EXPECT_EQ(message(config("", R"(, "sed": 3)")), "c.json: sed: unknown key; did you mean seed?");
  EXPECT_EQ(message(config(R"(, "packets": 3)")), "c.json: matrix.packets: unknown key; did you mean packet?");
  EXPECT_EQ(message(config("", R"(, "measure": {"smaples": 3})")), "c.json: measure.smaples: unknown key; did you mean samples?");
  EXPECT_EQ(message(config("", R"(, "exclude": [{"structure.nam": "list"}])")), "c.json: exclude[0].structure.nam: unknown key; did you mean structure.name?");
  EXPECT_EQ(message(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": [{"name": "list"}, {"name": "bvh", "bns": 8}]}})"),
            "c.json: matrix.structure[1].bns: unknown key; did you mean bins?");
}

TEST(Config, AsksForWalksOnlyWhereSomethingWalks) {
  const auto walked = [](const std::string& structure, const std::string& rays) {
    return R"({"name": "n", "verify": {"oracle": false, "cells": true}, "matrix": {"scene": "spd:balls:1", "structure": [{"name": "bvh"}, )" + structure +
           R"(], "rays": )" + rays + "}}";
  };
  const std::string nothing_walks = "c.json: verify.cells: no structure walks through cells, expected grid with traversal=lanes among matrix.structure";
  EXPECT_EQ(message(walked(R"({"name": "grid"})", R"("primary")")), "no error");
  EXPECT_EQ(message(walked(R"({"name": "grid", "traversal": ["slices", "lanes"]})", R"(["image", "primary"])")), "no error");
  EXPECT_EQ(message(walked(R"({"name": "grid", "traversal": "slices"})", R"("primary")")), nothing_walks);
  EXPECT_EQ(message(walked(R"({"name": "recursive_grid"})", R"("primary")")), nothing_walks);
  EXPECT_EQ(message(walked(R"({"name": "grid"})", R"("image")")),
            "c.json: verify.cells: walks are those of ray sets, expected another than \"image\" among matrix.rays");
}

TEST(Config, HoldsNumbersOutsideOfARangeThatAreAllowed) {
  const auto with_bits = [](const char* bits) {
    return std::string(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": {"name": "bvh", "traversal": "stream", "plane_bits": )") + bits + "}}}";
  };
  EXPECT_EQ(message(with_bits("[2, 16, 32]")), "no error");
  EXPECT_EQ(message(with_bits("[8, 20]")), "c.json: matrix.structure.plane_bits[1]: expected a whole number from 2 to 16 or 32, got 20");
}

TEST(Config, OptionalScenesMayBeAbsentAndNothingElse) {
  const auto with_scene = [](const std::string& scene) { return R"({"name": "n", "matrix": {"scene": [)" + scene + R"(], "structure": {"name": "list"}}})"; };
  const std::vector<Experiment> cells = expand(parse(with_scene(R"({"file": "${NOWHERE}/a.ply", "optional": true}, {"file": "absent.ply", "optional": true},
      {"name": "seen", "file": "spd:balls:1", "optional": true, "view": {"eye": [1, 2, 3], "look_at": [0, 0, 0], "fov": 30, "light": [4, 5, 6]}})")));
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_NE(cells[0].scene.absent.find("environment variable NOWHERE is not set"), std::string::npos) << cells[0].scene.absent;
  EXPECT_EQ(cells[1].scene.absent, "absent.ply is not there");
  EXPECT_EQ(cells[2].scene.absent, "");
  EXPECT_EQ(cells[2].scene.name, "seen");
  ASSERT_TRUE(cells[2].scene.view && cells[2].scene.view->light);
  EXPECT_EQ(cells[2].scene.view->eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(cells[2].scene.view->up, glm::dvec3(0, 1, 0));
  EXPECT_EQ(*cells[2].scene.view->light, glm::dvec3(4, 5, 6));

  EXPECT_EQ(message(with_scene(R"({"file": "absent.ply"})")), "c.json: matrix.scene[0]: absent.ply: cannot be opened");
  EXPECT_EQ(message(with_scene(R"({"file": "spd:bals:1", "optional": true})")).substr(0, 24), "c.json: matrix.scene[0]:");
  const std::string seen = R"({"name": "a", "file": "spd:balls:1", "view": {"eye": [1, 2, 3], "look_at": [0, 0, 0]}})";
  EXPECT_EQ(message(with_scene(seen + "," + seen)), "c.json: matrix.scene[1]: a is the name of another scene too, expected a \"name\" of its own");
  EXPECT_NE(message(with_scene(R"({"file": "spd:balls:1", "view": {"eye": [1, 2], "look_at": [0, 0, 0]}})")).find("matrix.scene[0]"), std::string::npos);
  EXPECT_NE(message(with_scene(R"({"file": "spd:balls:1", "view": {"eye": [1, 2, 3], "look_at": [1, 2, 3]}})"))
                .find("matrix.scene[0].view.look_at: is where the eye is, expected another point"),
            std::string::npos);
}

TEST(Config, SaysWhichValueIsWrong) {
  EXPECT_EQ(message(config(R"(, "isa": ["avx2", "axv512"])")),
            "c.json: matrix.isa[1]: expected one of scalar, sse42, avx2, avx512, best, got \"axv512\"; did you mean avx512?");
  EXPECT_EQ(message(config(R"(, "packet": 65)")), "c.json: matrix.packet: expected a whole number from 1 to 64, got 65");
  EXPECT_EQ(message(config(R"(, "packet": [1, 2.5])")), "c.json: matrix.packet[1]: expected a whole number from 1 to 64, got 2.5");
  EXPECT_EQ(message(config(R"(, "packet": [])")), "c.json: matrix.packet: expected at least one value");
  EXPECT_EQ(message(config(R"(, "threads": "many")")), "c.json: matrix.threads: expected a whole number from 1 to 4096 or all, got \"many\"");
  EXPECT_EQ(message(config(R"(, "first_hit": 3)")), "c.json: matrix.first_hit: expected one of cast, zbuffer or an object, got 3");
  EXPECT_EQ(message(config(R"(, "occlusion": ["none", "nune"])")),
            "c.json: matrix.occlusion[1]: expected one of none, shadow_cache or an object, got \"nune\"; did you mean none?");
  EXPECT_EQ(message(config(R"(, "max_depth": 101)")), "c.json: matrix.max_depth: expected a whole number from 1 to 100, got 101");
  EXPECT_EQ(
      message(config(R"(, "rays": "images")")),
      "c.json: matrix.rays: expected one of primary, shadow, reflection, ambient_occlusion, diffuse, random, vertices, edges, faces, invalid, case, "
      "image or secondary rays with the offset of their origins, as diffuse:offset=1e-4 or a .npy file or an object, got \"images\"; did you mean image?");
  EXPECT_EQ(message(config(R"(, "rays": "diffuse:offset=1e")")), "c.json: matrix.rays: diffuse:offset=1e: expected an offset such as bound, 1e-4 or 16ulp");
  EXPECT_EQ(message(config(R"(, "rays": ["diffuse:offset=1e-4", "shadow:offset=16ulp", "reflection:offset=bound"])")), "no error");
  EXPECT_EQ(message(config(R"(, "rays": "absent.npy")")), "c.json: matrix.rays: absent.npy cannot be read");
  EXPECT_EQ(message(config("", R"(, "measure": {"order": "random"})")), "c.json: measure.order: expected interleaved, got \"random\"");
  EXPECT_EQ(message(config("", R"(, "verify": {"oracle": "yes"})")), "c.json: verify.oracle: expected true or false, got \"yes\"");
  EXPECT_EQ(message(config("", R"(, "schema_version": 2)")), "c.json: schema_version: expected 1, got 2");
  EXPECT_EQ(message(R"({"name": "a/b", "matrix": {"scene": "spd:balls:1", "structure": {"name": "list"}}})"),
            "c.json: name: expected letters, digits, '.', '_' and '-', got \"a/b\"");
  EXPECT_EQ(message("[]"), "c.json: config: expected an object, got []");
}

TEST(Config, SaysWhichTechniqueOrSceneIsUnknown) {
  const auto with_structure = [](const std::string& structure) {
    return R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": )" + structure + "}}";
  };
  EXPECT_EQ(message(with_structure(R"([{"name": "bwh"}])")), "c.json: matrix.structure[0].name: unknown technique 'bwh'; did you mean bvh?");
  EXPECT_EQ(message(with_structure("{}")), "c.json: matrix.structure.name: is missing");
  EXPECT_EQ(message(with_structure(R"({"name": "bvh", "bins": 1})")), "c.json: matrix.structure.bins: expected a whole number from 2 to 64, got 1");
  EXPECT_EQ(message(R"({"name": "n", "matrix": {"structure": {"name": "list"}}})"), "c.json: matrix.scene: is missing");
  const auto with_scene = [](const std::string& scene) { return R"({"name": "n", "matrix": {"scene": [)" + scene + R"(], "structure": {"name": "list"}}})"; };
  EXPECT_NE(message(with_scene(R"("spd:bals")")).find("c.json: matrix.scene[0]: spd:bals: unknown generator"), std::string::npos);
  EXPECT_NE(message(with_scene(R"("spd:balls:99")")).find("c.json: matrix.scene[0]: spd:balls:99: expected a size"), std::string::npos);
  EXPECT_EQ(message(with_scene(R"({"file": "absent.nff"})")), "c.json: matrix.scene[0]: absent.nff: cannot be opened");
  EXPECT_EQ(message(with_scene(R"({"file": "${NOWHERE}/a.nff"})")), "c.json: matrix.scene[0]: environment variable NOWHERE is not set");
  EXPECT_EQ(message(with_scene(R"({"file": "${SCENES}/absent.nff"})")), "c.json: matrix.scene[0]: ../shared/absent.nff: cannot be opened");
}

TEST(Config, SaysWhereItIsNotJson) {
  EXPECT_EQ(message("{\n\"name\": }").substr(0, 25), "c.json: line 2: not JSON:");
  EXPECT_EQ(message(R"({"name": "n", "name": "m"})"), "c.json: key 'name' stands twice in one object");
  EXPECT_EQ(message(R"({"seed": 1e999})"), "c.json: not JSON: a number is out of range");
  EXPECT_EQ(message(R"({"na\nme": 1})"), "c.json: 'na\\x0ame' has a control character");
  EXPECT_EQ(message("{\"name\": " + std::string(100000, '[') + std::string(100000, ']') + "}"), "c.json: nested deeper than 32 levels");
  EXPECT_EQ(message(R"({"name": ")" + std::string(5000, 'a') + "\"}"), "c.json: '" + std::string(40, 'a') + "...' has more than 4096 bytes");
  EXPECT_EQ(message("{}"), "c.json: name: is missing");
}

TEST(Config, AllowsComments) { EXPECT_EQ(message("// a comment\n" + config("") + "/* another */"), "no error"); }

TEST(Config, AppliesSettings) {
  const Config c = parse(config(""), {"measure.samples=3", "matrix.packet=[1,8]", "name=other", "matrix.structure[1].bins=[8,16]"});
  EXPECT_EQ(c.measure.samples, 3);
  EXPECT_EQ(c.matrix.packet, (std::vector<int>{1, 8}));
  EXPECT_EQ(c.name, "other");
  EXPECT_EQ(expand(c).size(), 6u);
  EXPECT_EQ(message(config(""), {"measure.smaples=3"}), "c.json: measure.smaples: unknown key; did you mean samples?");
  EXPECT_EQ(message(config(""), {"samples"}), "c.json: --set: expected KEY=VALUE, got 'samples'");
  EXPECT_EQ(message(config(""), {"matrix.structure[7].bins=8"}), "c.json: --set matrix.structure[7].bins=8: no element [7]");
  EXPECT_EQ(message(config(""), {"name.x=8"}), "c.json: --set name.x=8: x is not in an object");
}

TEST(Expand, MultipliesAllLists) {
  const std::string text = R"({"name": "n", "matrix": {"scene": ["spd:balls:1", "spd:balls:2"],
    "structure": [{"name": "list"}, {"name": "bvh", "bins": [8, 16, 32], "max_leaf_size": [4, 8]}],
    "isa": ["scalar", "avx2"], "packet": [1, 8, 16], "rays": ["primary", "shadow"], "threads": [1, "all"]}})";
  EXPECT_EQ(expand(parse(text)).size(), std::size_t{2 * (1 + 6) * 2 * 3 * 2 * 2});
}

TEST(Expand, RefusesMoreThanAMillionCells) {
  const auto ones = [](int count) {
    std::string list = "[1";
    for (int i = 1; i < count; ++i) list += ", 1";
    return list + "]";
  };
  const std::string matrix = R"(, "packet": )" + ones(1001) + R"(, "threads": )" + ones(1000);
  EXPECT_EQ(message(config(matrix)), "c.json: matrix has 2.002e+06 cells, expected at most 1e+06");
}

TEST(Expand, MakesEveryCellOnce) {
  EXPECT_EQ(expand(parse(config(R"(, "packet": [1, 1, 8])"))).size(), 4u);
  // A default that is written out is the same cell.
  EXPECT_EQ(expand(parse(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": [{"name": "bvh"}, {"name": "bvh", "bins": 32}]}})")).size(), 1u);
}

TEST(Expand, LeavesOutWhatIsExcluded) {
  const std::string matrix = R"(, "threads": [1, "all"], "packet": [1, 8])";
  EXPECT_EQ(expand(parse(config(matrix))).size(), 8u);
  EXPECT_EQ(expand(parse(config(matrix, R"(, "exclude": [{"structure.name": "list", "threads": "all"}])"))).size(), 6u);
  EXPECT_EQ(expand(parse(config(matrix, R"(, "exclude": [{"packet": [1, 8]}])"))).size(), 0u);
  EXPECT_EQ(expand(parse(config(matrix, R"(, "exclude": [{"structure.bins": 32}])"))).size(), 4u);
}

TEST(Expand, FiltersByPattern) {
  const Config c =
      parse(R"({"name": "n", "matrix": {"scene": ["spd:balls:1", "spd:balls:2"], "structure": [{"name": "list"}, {"name": "bvh", "bins": [8, 16]}]}})");
  EXPECT_EQ(expand(c, parse_filter("structure=bvh*")).size(), 4u);
  EXPECT_EQ(expand(c, parse_filter("structure=bvh*;scene=spd:balls:2")).size(), 2u);
  EXPECT_EQ(expand(c, parse_filter("structure=*bins=16*")).size(), 2u);
  EXPECT_EQ(expand(c, parse_filter("structure.bins=8")).size(), 2u);
  EXPECT_EQ(expand(c, parse_filter("")).size(), 6u);
  EXPECT_THROW((void)parse_filter("structure.bin=8"), Error);
  EXPECT_THROW((void)parse_filter("structure"), Error);
}

TEST(Expand, ShardsAreAPartitionByScene) {
  const Config c =
      parse(R"({"name": "n", "matrix": {"scene": ["spd:balls:1", "spd:balls:2", "spd:balls:3"], "structure": [{"name": "list"}, {"name": "bvh"}]}})");
  std::map<std::string, int> times;
  for (const char* shard : {"1/2", "2/2"}) {
    for (const Experiment& cell : expand(c, {}, parse_shard(shard))) ++times[cell.id];
  }
  EXPECT_EQ(times.size(), 6u);
  for (const auto& [id, count] : times) EXPECT_EQ(count, 1) << id;
  for (const char* bad : {"0/2", "3/2", "1", "1/", "a/2", "1/2x"}) EXPECT_THROW((void)parse_shard(bad), Error) << bad;
}

TEST(Expand, IdsSayWhatIsMeasuredAndNothingElse) {
  const auto first_id = [](const std::string& text, const std::vector<std::string>& settings) { return expand(parse(text, settings)).front().id; };
  const std::string id = first_id(config(""), {});
  EXPECT_EQ(first_id(config(""), {"measure.samples=3", "verify.oracle=false", "name=other"}), id);
  EXPECT_NE(first_id(config(""), {"seed=2"}), id);
  EXPECT_NE(first_id(config(""), {"image.width=64"}), id);
  EXPECT_NE(first_id(config(""), {"matrix.packet=1"}), id);
}

TEST(Expand, FindsTheReferenceCell) {
  const Config c = parse(config(R"(, "packet": [1, 8])"));
  const std::vector<Experiment> cells = expand(c);  // list 1, list 8, bvh 1, bvh 8
  const auto references = reference_cells(c, cells);
  EXPECT_EQ(references, (std::vector<std::optional<std::size_t>>{0, 1, 0, 1}));
  const Config pinned = parse(config(R"(, "packet": [1, 8])", R"(, "measure": {"reference": {"packet": 1}})"));
  EXPECT_EQ(reference_cells(pinned, expand(pinned)), (std::vector<std::optional<std::size_t>>{0, 0, 2, 2}));
}

TEST(Schema, CommittedCopyIsCurrent) {
  std::ostringstream text;
  text << std::ifstream("configs/schema/experiment.schema.json").rdbuf();
  EXPECT_TRUE(text.str() == config_schema_text()) << "write it anew: build/release/raymeter schema > configs/schema/experiment.schema.json";
}

TEST(Configs, GateAndQuickHaveEveryStructure) {
  for (const char* path : {"configs/gate.json", "configs/quick.json"}) {
    const std::vector<Experiment> cells = expand(load_config(path, {}, environment));
    for (const StructureEntry& entry : structures()) {
      EXPECT_TRUE(std::any_of(cells.begin(), cells.end(), [&](const Experiment& cell) { return cell.structure == &entry; })) << path << " " << entry.name;
    }
  }
}

TEST(Schema, KnowsEveryStructureAndParameter) {
  for (const StructureEntry& entry : structures()) {
    std::string object = R"({"name": ")" + std::string(entry.name) + '"';
    for (const ParamInfo& info : entry.params()) {
      const bool text = std::holds_alternative<std::string>(info.default_value);
      object += ", \"" + std::string(info.key) + "\": " + (text ? '"' + to_string(info.default_value) + '"' : to_string(info.default_value));
    }
    EXPECT_EQ(message(R"({"name": "n", "matrix": {"scene": "spd:balls:1", "structure": )" + object + "}}}"), "no error");
  }
}

}  // namespace
}  // namespace raymeter
