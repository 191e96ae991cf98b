#include <algorithm>
#include <regex>

#include <fmt/format.h>

#include "accel/params.h"
#include "experiments/config/schema.h"

namespace raymeter {

namespace {

using Json = nlohmann::json;

std::string plain(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// What the schema, which has no alternatives, wants, in a few words.
std::string expected(const Json& schema) {
  if (schema.contains("const")) return plain(schema["const"]);
  if (schema.contains("enum")) {
    std::string words;
    for (const Json& value : schema["enum"]) words += (words.empty() ? "" : ", ") + plain(value);
    return (schema["enum"].size() > 1 ? "one of " : "") + words;
  }
  if (schema.contains("pattern")) return plain(schema["description"]);
  if (schema["type"].is_array()) return "a text, a number, true or false";
  const std::string type = schema["type"];
  if (type == "object") return "an object";
  if (type == "array") return "a list";
  if (type == "boolean") return "true or false";
  if (type == "string") return "a text";
  const std::string number = type == "integer" ? "a whole number" : "a number";
  if (schema.contains("maximum")) return fmt::format("{} from {} to {}", number, schema["minimum"].dump(), schema["maximum"].dump());
  return schema.contains("minimum") ? fmt::format("{} from {}", number, schema["minimum"].dump()) : number;
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "boolean") return value.is_boolean();
  if (type == "string") return value.is_string();
  if (type == "integer") return value.is_number_integer();
  return value.is_number();
}

/// Whether the schema allows a value that is neither object nor list.
bool allows_scalar(const Json& value, const Json& schema) {
  if (schema.contains("const")) return value == schema["const"];
  if (schema.contains("enum")) return std::find(schema["enum"].begin(), schema["enum"].end(), value) != schema["enum"].end();
  if (schema["type"].is_array()) return std::any_of(schema["type"].begin(), schema["type"].end(), [&](const Json& type) { return has_type(value, type); });
  if (!has_type(value, schema["type"])) return false;
  if (value.is_number() && schema.contains("minimum") && value < schema["minimum"]) return false;
  if (value.is_number() && schema.contains("maximum") && value > schema["maximum"]) return false;
  if (schema.contains("minLength") && value.get<std::string>().size() < schema["minLength"].get<std::size_t>()) return false;
  return !schema.contains("pattern") || std::regex_search(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>()));
}

std::string hint(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest_word(word, std::vector<std::string_view>(known.begin(), known.end()));
  return near.empty() ? fmt::format("expected one of {}", fmt::join(known, ", ")) : "did you mean " + near + "?";
}

/// What a schema's anyOf, nested or not, allows one of; the schema itself where it has none.
void add_alternatives(const Json& schema, std::vector<const Json*>& out) {
  if (!schema.contains("anyOf")) return out.push_back(&schema);
  for (const Json& alternative : schema["anyOf"]) add_alternatives(alternative, out);
}

std::string mismatch(const Json& value, const std::vector<const Json*>& alternatives, const std::string& path) {
  std::string wanted;
  std::vector<std::string> words;
  for (const Json* schema : alternatives) {
    if (schema->contains("items") && alternatives.size() > 1) continue;  // "or a list of these" goes without saying
    const std::string one = expected(*schema);
    if (wanted.find(one) == std::string::npos) wanted += (wanted.empty() ? "" : " or ") + one;
    for (const Json& word : schema->value("enum", Json::array())) words.push_back(plain(word));
  }
  const std::string near = value.is_string() ? nearest_word(value.get<std::string>(), std::vector<std::string_view>(words.begin(), words.end())) : "";
  return fmt::format("{}: expected {}, got {}{}", path.empty() ? "config" : path, wanted, value.dump(), near.empty() ? "" : "; did you mean " + near + "?");
}

std::string explain_object(const Json& value, const Json& schema, const std::string& path) {
  const auto member = [&](const std::string& key) { return path.empty() ? key : path + "." + key; };
  const Json& properties = schema["properties"];
  for (const auto& [key, item] : value.items()) {
    if (!properties.contains(key)) {
      std::vector<std::string> known;
      for (const auto& [name, unused] : properties.items()) known.push_back(name);
      return fmt::format("{}: unknown key; {}", member(key), hint(key, known));
    }
    const std::string found = explain(item, properties[key], member(key));
    if (!found.empty()) return found;
  }
  for (const Json& key : schema.value("required", Json::array())) {
    if (!value.contains(key.get<std::string>())) return fmt::format("{}: is missing", member(key));
  }
  return {};
}

std::string explain_array(const Json& value, const Json& schema, const std::string& path) {
  if (value.size() < schema.value("minItems", std::size_t{0})) return fmt::format("{}: expected at least one value", path);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string found = explain(value[i], schema["items"], fmt::format("{}[{}]", path, i));
    if (!found.empty()) return found;
  }
  return {};
}

}  // namespace

std::string explain(const Json& value, const Json& schema, const std::string& path) {
  std::vector<const Json*> alternatives;
  add_alternatives(schema, alternatives);
  std::vector<std::string> names;  // that tell the objects apart
  for (const Json* alternative : alternatives) {
    const bool object = alternative->contains("properties");
    const bool list = alternative->contains("items");
    if (value.is_array() && list) return explain_array(value, *alternative, path);
    if (value.is_object() && object) {
      const Json name = (*alternative)["properties"].value("name", Json());
      if (!name.contains("const") || value.value("name", Json()) == name["const"]) return explain_object(value, *alternative, path);
      names.push_back(plain(name["const"]));
    }
    if (!value.is_structured() && !object && !list && allows_scalar(value, *alternative)) return {};
  }
  if (names.empty()) return mismatch(value, alternatives, path);
  if (!value.contains("name")) return path + ".name: is missing";
  return fmt::format("{}.name: unknown technique '{}'; {}", path, plain(value["name"]), hint(plain(value["name"]), names));
}

}  // namespace raymeter
