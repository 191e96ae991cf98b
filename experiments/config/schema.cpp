#include "experiments/config/schema.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "accel/registry.h"
#include "core/ray/generators.h"
#include "core/ray/views.h"
#include "core/simd/isa.h"
#include "experiments/config/config.h"
#include "experiments/record/param_json.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

Json described(Json schema, std::string_view description) {
  schema["description"] = description;
  return schema;
}

/// A value or a list of them: a list where one value is expected is a sweep.
Json sweep(const Json& one, std::string_view description) {
  return described({{"anyOf", {one, {{"type", "array"}, {"minItems", 1}, {"items", one}}}}}, description);
}

Json integer(std::int64_t min, std::int64_t max) { return {{"type", "integer"}, {"minimum", min}, {"maximum", max}}; }

Json closed_object(Json properties, std::vector<std::string> required = {}) {
  Json json{{"type", "object"}, {"properties", std::move(properties)}};
  if (!required.empty()) json["required"] = required;
  json["additionalProperties"] = false;
  return json;
}

Json whole_number_schema(const ParamInfo& info) {
  const Json range = integer(static_cast<std::int64_t>(info.min), static_cast<std::int64_t>(info.max));
  if (info.also.empty()) return range;
  return {{"anyOf", {range, {{"enum", info.also}}}}};
}

Json param_schema(const ParamInfo& info) {
  Json json;
  if (std::holds_alternative<bool>(info.default_value))
    json = {{"type", "boolean"}};
  else if (std::holds_alternative<std::int64_t>(info.default_value))
    json = whole_number_schema(info);
  else if (std::holds_alternative<double>(info.default_value))
    json = {{"type", "number"}, {"minimum", info.min}, {"maximum", info.max}};
  else if (info.choices.empty())
    json = {{"type", "string"}};
  else
    json = {{"type", "string"}, {"enum", info.choices}};
  Json swept = sweep(json, info.help);
  swept["default"] = to_json(info.default_value);
  return swept;
}

Json technique_schema(const TechniqueInfo& technique) {
  Json properties{{"name", {{"const", technique.name}}}};
  for (const ParamInfo& info : technique.params()) properties[std::string(info.key)] = param_schema(info);
  return described(closed_object(properties, {"name"}), technique.summary);
}

/// The slot's techniques: names, or objects with parameters.
Json slot_schema(std::string_view slot) {
  Json names = Json::array(), objects = Json::array();
  for (const TechniqueInfo& technique : techniques()) {
    if (technique.slot != slot) continue;
    names.push_back(technique.name);
    objects.push_back(technique_schema(technique));
  }
  Json alternatives = Json::array({Json{{"enum", names}}});
  alternatives.insert(alternatives.end(), objects.begin(), objects.end());
  return {{"anyOf", alternatives}};
}

Json isa_schema() {
  Json names = Json::array();
  for (const Isa isa : kIsas) names.push_back(name(isa));
  names.push_back("best");
  return {{"type", "string"}, {"enum", names}};
}

Json point_schema() { return {{"type", "array"}, {"minItems", 3}, {"maxItems", 3}, {"items", {{"type", "number"}}}}; }

Json scene_schema() {
  const Json text{{"type", "string"}, {"minLength", 1}};
  const Json fov{{"type", "number"}, {"minimum", 0.001}, {"maximum", 179}};
  const Json view = closed_object({{"eye", point_schema()},
                                   {"look_at", point_schema()},
                                   {"up", described(point_schema(), "default: y")},
                                   {"fov", described(fov, "full angle in degrees; default: 45")},
                                   {"light", described(point_schema(), "default: the lights of the scene")}},
                                  {"eye", "look_at"});
  const Json object = closed_object({{"file", text},
                                     {"name", described(text, "in records; default: the file as written here")},
                                     {"optional", described({{"type", "boolean"}}, "where the file is not there, its cells are skipped")},
                                     {"view", described(view, "from where the scene is seen, instead of what its file says")}},
                                    {"file"});
  return {{"anyOf", {text, object}}};
}

Json rays_schema() {
  Json names = Json::array();
  std::vector<std::string_view> leaving;
  for (const RayKind kind : kRayKinds) {
    names.push_back(name(kind));
    if (leaves_surfaces(kind)) leaving.push_back(name(kind));
  }
  for (const char* other : {"case", "image"}) names.push_back(other);
  const Json kinds{{"type", "string"}, {"enum", names}};
  const Json offset{{"type", "string"},
                    {"pattern", fmt::format("^({}):offset=(bound|[0-9][0-9.eE+-]*(ulp)?)$", fmt::join(leaving, "|"))},
                    {"description", "secondary rays with the offset of their origins, as diffuse:offset=1e-4"}};
  const Json file{{"type", "string"}, {"pattern", "\\.npy$"}, {"description", "a .npy file"}};
  const Json query{{"type", "string"}, {"enum", {"closest", "any"}}};
  const Json object = closed_object({{"file", file}, {"query", query}}, {"file"});
  return {{"anyOf", {kinds, offset, file, object}}};
}

Json matrix_schema() {
  const Json threads{{"anyOf", {integer(1, 4096), {{"const", "all"}}}}};
  const Json weight{{"type", "number"}, {"minimum", 0}};
  return closed_object(
      {{"scene", sweep(scene_schema(), "generators (spd:balls:4, gen:terrain:100000) or files")},
       {"structure", sweep(slot_schema("structure"), "acceleration structures, and their parameters")},
       {"first_hit", sweep(slot_schema("first_hit"), "how eye rays find their first hit; other rays take the default")},
       {"occlusion", sweep(slot_schema("occlusion"), "what is tried before a shadow ray is traced; other rays take the default")},
       {"max_depth", sweep(integer(1, 100), "greatest depth of an image's rays, the eye ray having 1; ray sets have none")},
       {"min_weight", sweep(weight, "least share of its pixel with which an image's ray is followed; 0 cuts nothing")},
       {"needs", sweep({{"enum", {"auto", "all"}}}, "auto: images run what their scene needs; all: what any scene may need, to compare")},
       {"isa", sweep(isa_schema(), "instruction sets; one that the machine lacks is recorded as skipped; best: the machine's best")},
       {"packet", sweep(integer(1, kMaxPacket), "rays per packet; 1 traces rays one by one")},
       {"rays",
        sweep(rays_schema(),
              "ray sets; secondary ones perhaps with how far their origins are lifted off their surfaces: offset=bound, in the scene's units, or in ulp of the "
              "point's largest coordinate (16ulp), and then held against rays by the bound; case: those of a hard: scene; or image: complete frames; "
              ".npy files are for closest unless they say query: any")},
       {"threads", sweep(threads, "number of threads, or all")}},
      {"scene", "structure"});
}

/// Fields of a cell and the values that they may have.
Json pattern_schema() {
  const Json scalar{{"type", {"string", "number", "boolean"}}};
  Json properties = Json::object();
  for (const std::string& key : field_keys()) properties[key] = sweep(scalar, "value or values of " + key);
  return closed_object(properties);
}

Json measure_schema() {
  const Json seconds{{"type", "number"}, {"minimum", 0}};
  return closed_object({{"warmup", described(integer(0, 1000), "passes before the timed ones")},
                        {"samples", described(integer(0, 100000), "timed passes per cell; 0 counts only")},
                        {"builds", described(integer(1, 1000), "timed builds of each structure, in rounds as the passes; default 1")},
                        {"order", described({{"enum", {"interleaved"}}}, "round-robin over the cells of a scene, in a seeded order")},
                        {"max_time_s", described(seconds, "of the whole run; the rest can be resumed")},
                        {"timeout_s", described(seconds, "of one cell: its counted, warm-up and timed passes")},
                        {"reference", described(pattern_schema(),
                                                "fields that the cell of ratio_vs_ref has; the others are as the cell's own; "
                                                "default: the first structure")}});
}

}  // namespace

nlohmann::ordered_json config_schema() {
  Json cameras = Json::array();
  for (const CameraConvention convention : kCameraConventions) cameras.push_back(name(convention));
  const Json camera = described({{"enum", cameras}}, "where samples lie, and an image's rules of surfaces; default: pixel");
  const Json image = closed_object({{"camera", camera}, {"width", integer(1, 32768)}, {"height", integer(1, 32768)}});
  const Json verify = closed_object(
      {{"oracle", described({{"type", "boolean"}}, "hold hits against the exact oracle")},
       {"cells", described({{"type", "boolean"}}, "hold the cells that rays walk through against exact ones, too; default: no")},
       {"max_tests", described({{"type", "number"}, {"minimum", 0}}, "ray-primitive tests, or cells of rays, of one verification; beyond, rays are sampled")},
       {"hit_mismatch_max", described({{"type", "number"}, {"minimum", 0}, {"maximum", 1}}, "share of the rays that may be wrong")}});
  const Json ingredient = closed_object({{"name", {{"type", "string"}}},
                                         {"with", described(pattern_schema(), "fields of cells that have it; the fastest counts")},
                                         {"without", described(pattern_schema(), "fields of cells that have it not; likewise")}},
                                        {"name", "with", "without"});
  const Json ingredients{{"type", "array"}, {"items", ingredient}, {"description", "of which the report draws what each brings"}};
  Json properties{{"$schema", {{"type", "string"}}},
                  {"schema_version", {{"const", kSchemaVersion}}},
                  {"name", {{"type", "string"}, {"pattern", "^[A-Za-z0-9_][A-Za-z0-9._-]*$"}, {"description", "letters, digits, '.', '_' and '-'"}}},
                  {"seed", described(integer(0, std::int64_t{1} << 53), "of generated rays and of the order of samples")},
                  {"matrix", described(matrix_schema(), "the product of all lists is measured")},
                  {"exclude", {{"type", "array"}, {"items", pattern_schema()}, {"description", "cells that are not measured"}}},
                  {"image", described(image, "the camera that makes the rays, and the pixels of images")},
                  {"measure", measure_schema()},
                  {"verify", verify},
                  {"report", closed_object({{"ingredients", ingredients}})}};
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "raymeter experiment"}};
  schema.update(closed_object(properties, {"name", "matrix"}));
  return schema;
}

std::string config_schema_text() { return config_schema().dump(2) + "\n"; }

}  // namespace raymeter
