#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "accel/registry.h"
#include "core/base/error.h"
#include "core/ray/generators.h"
#include "experiments/config/config.h"
#include "experiments/config/load_json.h"
#include "experiments/config/schema.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {

namespace {

using Json = nlohmann::json;

template <class T>
void take(const Json& object, const char* key, T& value) {
  if (object.contains(key)) value = object[key].get<T>();
}

/// A value as a list of one.
Json as_list(const Json& value) { return value.is_array() ? value : Json::array({value}); }

ParamValue param_value(const Json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  return value.get<std::string>();
}

/// Replaces each ${NAME} by an environment variable.
std::string substituted(const std::string& text, const Environment& environment, const std::string& path) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = text.find("${", at)) != std::string::npos;) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) throw Error(fmt::format("{}: '${{' without '}}'", path));
    const std::string name = text.substr(open + 2, close - open - 2);
    const char* const value = environment(name);
    if (value == nullptr) throw Error(fmt::format("{}: environment variable {} is not set", path, name));
    out += text.substr(at, open - at) + value;
    at = close + 1;
  }
  return out + text.substr(at);
}

/// The text of a path or of {"file": path}.
const Json& file_of(const Json& value) { return value.is_object() ? value["file"] : value; }

glm::dvec3 parse_point(const Json& value) { return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()}; }

SceneView parse_view(const Json& json, const std::string& path) {
  SceneView view;
  view.eye = parse_point(json["eye"]);
  view.look_at = parse_point(json["look_at"]);
  if (view.look_at == view.eye) throw Error(path + ".look_at: is where the eye is, expected another point");
  if (json.contains("up")) view.up = parse_point(json["up"]);
  if (json.contains("light")) view.light = parse_point(json["light"]);
  take(json, "fov", view.fov_degrees);
  return view;
}

/// Whether a scene that need not be there can be opened. What is there and is no scene is an error all the same.
bool is_absent(const std::string& spec) { return !is_generated_scene(spec) && !std::filesystem::exists(spec); }

SceneChoice parse_scene(const Json& value, const Environment& environment, const std::string& path) {
  const std::string file = file_of(value);
  SceneChoice scene{file, "", std::nullopt, ""};
  bool optional = false;
  if (value.is_object()) {
    take(value, "name", scene.name);
    take(value, "optional", optional);
    if (value.contains("view")) scene.view = parse_view(value["view"], path + ".view");
  }
  try {
    scene.spec = substituted(file, environment, path);
    if (optional && is_absent(scene.spec)) scene.absent = scene.spec + " is not there";
  } catch (const Error& error) {
    if (!optional) throw;
    scene.absent = error.what();
  }
  if (!scene.absent.empty()) return scene;
  try {
    check_scene(scene.spec);
  } catch (const Error& error) {
    throw Error(path + ": " + error.what());
  }
  return scene;
}

/// Records tell scenes by their names.
void check_scene_names(const std::vector<SceneChoice>& scenes) {
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (scenes[i].name == scenes[k].name && (scenes[i].spec != scenes[k].spec || scenes[i].view || scenes[k].view))
        throw Error(fmt::format("matrix.scene[{}]: {} is the name of another scene too, expected a \"name\" of its own", i, scenes[i].name));
    }
  }
}

RaysChoice parse_rays(const Json& value, const Environment& environment, const std::string& path) {
  const std::string name = file_of(value);
  if (name == "case" || name == "image") return {name, "", false};
  if (!name.ends_with(".npy")) {
    const std::optional<RayRecipe> recipe = ray_recipe_from_name(name);
    if (!recipe) throw Error(fmt::format("{}: {}: expected an offset such as bound, 1e-4 or 16ulp", path, name));
    return {raymeter::name(*recipe), "", false};
  }
  RaysChoice rays{name, substituted(name, environment, path), value.is_object() && value.value("query", "closest") == "any"};
  if (rays.any) rays.name += ":any";
  if (!std::ifstream(rays.file)) throw Error(fmt::format("{}: {} cannot be read", path, rays.file));
  return rays;
}

/// A technique's name, or an object with it and parameters; find(name) gives the row of the slot's table.
template <class Entry>
TechniqueAxis<Entry> parse_axis(const Json& value, const std::string& path, const Entry& (*find)(std::string_view)) {
  if (value.is_string()) return {&find(value.get<std::string>()), {}, path};
  TechniqueAxis<Entry> axis{&find(value["name"].get<std::string>()), {}, path};
  for (const auto& [key, values] : value.items()) {
    if (key == "name") continue;
    axis.params.push_back({key, {}});
    for (const Json& one : as_list(values)) axis.params.back().second.push_back(param_value(one));
  }
  return axis;
}

Pattern parse_pattern(const Json& object) {
  Pattern pattern;
  for (const auto& [key, values] : object.items()) {
    pattern.fields.push_back({key, {}});
    for (const Json& value : as_list(values)) pattern.fields.back().second.push_back(to_string(param_value(value)));
  }
  return pattern;
}

/// Calls parse(element, path) for each element of a list, or for the value that stands for a list of one.
template <class T, class Parse>
void parse_list(const Json& object, const std::string& key, const std::string& prefix, std::vector<T>& out, Parse&& parse) {
  if (!object.contains(key)) return;
  const bool list = object[key].is_array();
  const Json values = as_list(object[key]);
  out.clear();
  for (std::size_t i = 0; i < values.size(); ++i) out.push_back(parse(values[i], list ? fmt::format("{}{}[{}]", prefix, key, i) : prefix + key));
}

/// Depths are of images: a config that names some and has no image means something that it does not say.
void check_depths(const Matrix& m) {
  if (std::any_of(m.rays.begin(), m.rays.end(), [](const RaysChoice& rays) { return rays.image(); })) return;
  const Matrix ray_sets;
  if (m.max_depth != ray_sets.max_depth) throw Error("matrix.max_depth: ray sets have no depth, expected \"image\" among matrix.rays");
  if (m.general != ray_sets.general) throw Error("matrix.needs: ray sets need no shading, expected \"image\" among matrix.rays");
  if (m.min_weight != ray_sets.min_weight) throw Error("matrix.min_weight: ray sets have no weights, expected \"image\" among matrix.rays");
}

/// Their rays are of hard cases: other scenes have none.
void check_cases(const Matrix& m) {
  if (std::ranges::none_of(m.rays, [](const RaysChoice& rays) { return rays.name == "case"; })) return;
  for (const SceneChoice& scene : m.scene) {
    if (!scene.spec.starts_with("hard:")) throw Error(fmt::format("matrix.rays: {} has no rays of a case, expected scenes hard:NAME", scene.name));
  }
}

Matrix parse_matrix(const Json& json, const Environment& environment) {
  Matrix m;
  const auto list = [&](const char* key, auto& out, auto&& parse) { parse_list(json, key, "matrix.", out, parse); };
  const auto whole = [](const Json& value, const std::string&) { return value.get<int>(); };
  list("scene", m.scene, [&](const Json& value, const std::string& path) { return parse_scene(value, environment, path); });
  check_scene_names(m.scene);
  list("structure", m.structure, [](const Json& value, const std::string& path) { return parse_axis(value, path, structure_entry); });
  list("first_hit", m.first_hit, [](const Json& value, const std::string& path) { return parse_axis(value, path, first_hit_entry); });
  list("occlusion", m.occlusion, [](const Json& value, const std::string& path) { return parse_axis(value, path, occlusion_entry); });
  list("max_depth", m.max_depth, whole);
  list("min_weight", m.min_weight, [](const Json& value, const std::string&) { return value.get<double>(); });
  list("needs", m.general, [](const Json& value, const std::string&) { return value.get<std::string>() == "all"; });
  list("isa", m.isa, [](const Json& value, const std::string&) { return isa_from_name(value.get<std::string>()).value_or(best_isa()); });
  list("packet", m.packet, whole);
  list("rays", m.rays, [&](const Json& value, const std::string& path) { return parse_rays(value, environment, path); });
  list("threads", m.threads, [](const Json& value, const std::string&) { return value.is_string() ? 0 : value.get<int>(); });
  check_depths(m);
  check_cases(m);
  return m;
}

Config parse_document(const Json& json, const Environment& environment) {
  Config config;
  config.text = json.dump();
  take(json, "name", config.name);
  take(json, "seed", config.seed);
  config.matrix = parse_matrix(json["matrix"], environment);
  parse_list(json, "exclude", "", config.exclude, [](const Json& value, const std::string&) { return parse_pattern(value); });
  const Json image = json.value("image", Json::object());
  if (image.contains("camera")) config.camera = camera_convention_from_name(image["camera"].get<std::string>()).value();
  take(image, "width", config.width);
  take(image, "height", config.height);
  const Json measure = json.value("measure", Json::object());
  take(measure, "warmup", config.measure.warmup);
  take(measure, "samples", config.measure.samples);
  take(measure, "builds", config.measure.builds);
  take(measure, "max_time_s", config.measure.max_time_s);
  take(measure, "timeout_s", config.measure.timeout_s);
  config.measure.reference = parse_pattern(measure.value("reference", Json::object()));
  const Json verify = json.value("verify", Json::object());
  take(verify, "oracle", config.verify.oracle);
  take(verify, "cells", config.verify.cells);
  take(verify, "max_tests", config.verify.max_tests);
  take(verify, "hit_mismatch_max", config.verify.hit_mismatch_max);
  return config;
}

}  // namespace

Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& settings, const Environment& environment) {
  try {
    Json document = load_json(text);
    for (const std::string& setting : settings) apply_setting(document, setting);
    check_schema(document);
    Config config = parse_document(document, environment);
    config.path = name;
    return config;
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

Config load_config(const std::string& path, const std::vector<std::string>& settings, const Environment& environment) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || text.bad() || std::filesystem::is_directory(path)) throw Error(path + ": cannot be read, expected a config in JSON");
  return parse_config(text.str(), path, settings, environment);
}

}  // namespace raymeter
