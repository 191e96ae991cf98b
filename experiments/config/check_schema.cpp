#include <fmt/format.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "core/base/error.h"
#include "experiments/config/schema.h"

namespace raymeter {

void check_schema(const nlohmann::json& document) {
  const nlohmann::json rules = config_schema();
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(rules), schema);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), &results)) return;
  // valijson decides; of alternatives it only knows that none fits, so the words are our own where we find the place.
  const std::string found = explain(document, rules, "");
  if (!found.empty()) throw Error(found);
  valijson::ValidationResults::Error error;
  std::string place = "config";
  if (results.popError(error)) {
    place.clear();
    for (const std::string& part : error.context) place += part;
  }
  throw Error(fmt::format("{}: {}", place, error.description));
}

}  // namespace raymeter
