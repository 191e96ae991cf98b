#include "experiments/config/expand.h"

#include <algorithm>
#include <charconv>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/config/hash.h"
#include "experiments/record/param_json.h"

namespace raymeter {

namespace {

/// The product of a structure's parameter lists, resolved.
std::vector<ParamValues> param_products(const StructureAxis& axis) {
  std::vector<ParamValues> products{{}};
  for (const auto& [key, values] : axis.params) {
    std::vector<ParamValues> longer;
    for (const ParamValues& product : products) {
      for (const ParamValue& value : values) {
        longer.push_back(product);
        longer.back().emplace_back(key, value);
      }
    }
    products = std::move(longer);
  }
  for (ParamValues& product : products) {
    try {
      product = axis.entry->resolve(product);
    } catch (const Error& error) {
      throw Error(axis.path + "." + error.what());
    }
  }
  return products;
}

std::vector<Experiment> scene_cells(const Config& config, const SceneChoice& scene) {
  std::vector<Experiment> cells;
  Experiment e;
  e.scene = scene;
  e.width = config.width;
  e.height = config.height;
  e.seed = config.seed;
  const Matrix& m = config.matrix;
  const auto each = [](const auto& values, auto& member, auto&& next) {
    for (const auto& value : values) {
      member = value;
      next();
    }
  };
  for (const StructureAxis& axis : m.structure) {
    e.structure = axis.entry;
    each(param_products(axis), e.params, [&] {
      each(m.first_hit, e.first_hit, [&] {
        each(m.occlusion, e.occlusion, [&] {
          each(m.max_depth, e.max_depth, [&] {
            each(m.min_weight, e.min_weight, [&] {
              each(m.isa, e.isa,
                   [&] { each(m.packet, e.packet, [&] { each(m.rays, e.rays, [&] { each(m.threads, e.threads, [&] { cells.push_back(e); }); }); }); });
            });
          });
        });
      });
    });
  }
  return cells;
}

/// Whether two cells differ in nothing but what `free` names.
bool differ_only_in(const Experiment& a, const Experiment& b, const Pattern& free) {
  if (!free.names("structure") && !free.names("structure.name")) {
    if (a.structure != b.structure) return false;
    for (const auto& [key, value] : a.params) {
      const std::string param = "structure." + key;
      if (!free.names(param) && field(a, param) != field(b, param)) return false;
    }
  }
  for (const char* key : {"scene", "first_hit", "occlusion", "max_depth", "min_weight", "isa", "packet", "rays", "threads"}) {
    if (!free.names(key) && field(a, key) != field(b, key)) return false;
  }
  return true;
}

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  if (first == std::errc{} && slash != end && *slash == '/') {
    const auto [rest, second] = std::from_chars(slash + 1, end, shard.count);
    if (second == std::errc{} && rest == end && shard.index >= 1 && shard.index <= shard.count) return {shard.index - 1, shard.count};
  }
  throw Error("--shard: expected I/N with I from 1 to N, got '" + text + "'");
}

double cell_count(const Config& config) noexcept {
  const Matrix& m = config.matrix;
  double count = 0;
  for (const StructureAxis& axis : m.structure) {
    double product = 1;
    for (const auto& [key, values] : axis.params) product *= static_cast<double>(values.size());
    count += product;
  }
  for (const std::size_t size : {m.scene.size(), m.first_hit.size(), m.occlusion.size(), m.max_depth.size(), m.min_weight.size(), m.isa.size(), m.packet.size(),
                                 m.rays.size(), m.threads.size()}) {
    count *= static_cast<double>(size);
  }
  return count;
}

std::vector<Experiment> expand(const Config& config, const Pattern& filter, const Shard& shard) {
  constexpr double kMaxCells = 1e6;
  if (const double count = cell_count(config); count > kMaxCells)
    throw Error(fmt::format("{}: matrix has {:g} cells, expected at most {:g}", config.path, count, kMaxCells));
  std::vector<Experiment> cells;
  std::set<std::string> seen;
  for (std::size_t s = 0; s < config.matrix.scene.size(); ++s) {
    if (static_cast<int>(s % static_cast<std::size_t>(shard.count)) != shard.index) continue;
    for (Experiment& cell : scene_cells(config, config.matrix.scene[s])) {
      const auto excludes = [&](const Pattern& pattern) { return pattern.matches(cell); };
      if (std::any_of(config.exclude.begin(), config.exclude.end(), excludes) || !filter.matches(cell, true)) continue;
      cell.id = hash_text(canonical_json(cell));
      if (seen.insert(cell.id).second) cells.push_back(std::move(cell));
    }
  }
  return cells;
}

std::string canonical_json(const Experiment& e) {
  const nlohmann::json json{{"scene", e.scene.name},
                            {"structure", e.structure->name},
                            {"params", to_json(e.params)},
                            {"first_hit", e.first_hit},
                            {"occlusion", e.occlusion},
                            {"max_depth", e.max_depth},
                            {"min_weight", e.min_weight},
                            {"isa", name(e.isa)},
                            {"packet", e.packet},
                            {"rays", e.rays.name},
                            {"seed", e.seed},
                            {"threads", threads_text(e.threads)},
                            {"width", e.width},
                            {"height", e.height}};
  return json.dump();
}

std::vector<std::optional<std::size_t>> reference_cells(const Config& config, const std::vector<Experiment>& cells) {
  Pattern reference = config.measure.reference;
  if (reference.fields.empty()) reference.fields.push_back({"structure.name", {std::string(config.matrix.structure.front().entry->name)}});
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (reference.matches(cells[i])) candidates.push_back(i);
  }
  std::vector<std::optional<std::size_t>> references(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto found = std::find_if(candidates.begin(), candidates.end(), [&](std::size_t c) { return differ_only_in(cells[i], cells[c], reference); });
    if (found != candidates.end()) references[i] = *found;
  }
  return references;
}

}  // namespace raymeter
