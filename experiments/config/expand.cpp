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

/// The product of a technique's parameter lists, resolved.
template <class Entry>
std::vector<ParamValues> param_products(const TechniqueAxis<Entry>& axis) {
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
  try {
    for (ParamValues& product : products) product = axis.entry->resolve(product);
    const std::vector<ParamInfo> infos = axis.entry->params();
    for (const auto& [key, values] : axis.params) {
      for (const ParamValue& value : values) check_used(infos, key, value, products);
    }
  } catch (const Error& error) {
    throw Error(axis.path + "." + error.what());
  }
  return products;
}

/// Everything that a slot is to hold.
template <class Entry>
std::vector<Chosen<Entry>> choices(const std::vector<TechniqueAxis<Entry>>& axes) {
  std::vector<Chosen<Entry>> all;
  for (const TechniqueAxis<Entry>& axis : axes) {
    for (ParamValues& params : param_products(axis)) all.push_back({axis.entry, std::move(params)});
  }
  return all;
}

template <class Entry>
Chosen<Entry> default_of(std::span<const Entry> rows) {
  return {&rows.front(), rows.front().resolve({})};
}

/// A slot that the cell's rays do not come by holds its default, so that a record never names a technique that had no part in it. Likewise depths where rays
/// have none: cells that differ in nothing else are one.
void settle(Experiment& e) {
  if (!e.rays.image()) {
    e.max_depth = Experiment{}.max_depth;
    e.min_weight = Experiment{}.min_weight;
    e.general = Experiment{}.general;
  }
  if (!takes_first_hit(e.rays)) e.first_hit = default_of(first_hits());
  if (!takes_occlusion(e.rays)) e.occlusion = default_of(occlusions());
}

/// Throws Error where an axis names a technique, not its slot's default, that none of the matrix's rays come by.
template <class Entry>
void check_use(const std::vector<TechniqueAxis<Entry>>& axes, std::span<const Entry> rows, const std::vector<RaysChoice>& rays,
               bool (*takes)(const RaysChoice&) noexcept, std::string_view expected) {
  if (std::ranges::any_of(rays, takes)) return;
  for (const TechniqueAxis<Entry>& axis : axes) {
    if (axis.entry != &rows.front()) throw Error(fmt::format("{}: {} has no part in matrix.rays, expected {} there", axis.path, axis.entry->name, expected));
  }
}

/// Throws Error where walks through cells are to be held against the truth and nothing that the matrix names walks.
void check_walks(const Config& config) {
  if (!config.verify.cells) return;
  const Matrix& m = config.matrix;
  if (std::ranges::all_of(m.rays, &RaysChoice::image))
    throw Error("verify.cells: walks are those of ray sets, expected another than \"image\" among matrix.rays");
  const auto walks = [](const TechniqueAxis<StructureEntry>& axis) {
    return axis.entry->walks_cells != nullptr && std::ranges::any_of(param_products(axis), axis.entry->walks_cells);
  };
  if (std::ranges::none_of(m.structure, walks))
    throw Error("verify.cells: no structure walks through cells, expected grid with traversal=lanes among matrix.structure");
}

std::vector<Experiment> scene_cells(const Config& config, const SceneChoice& scene) {
  std::vector<Experiment> cells;
  Experiment e;
  e.scene = scene;
  e.camera = config.camera;
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
  const std::vector<Chosen<FirstHitEntry>> first_hit = choices(m.first_hit);
  const std::vector<Chosen<OcclusionEntry>> occlusion = choices(m.occlusion);
  for (const TechniqueAxis<StructureEntry>& axis : m.structure) {
    e.structure = axis.entry;
    each(param_products(axis), e.params, [&] {
      each(first_hit, e.first_hit, [&] {
        each(occlusion, e.occlusion, [&] {
          each(m.max_depth, e.max_depth, [&] {
            each(m.min_weight, e.min_weight, [&] {
              each(m.general, e.general, [&] {
                each(m.isa, e.isa,
                     [&] { each(m.packet, e.packet, [&] { each(m.rays, e.rays, [&] { each(m.threads, e.threads, [&] { cells.push_back(e); }); }); }); });
              });
            });
          });
        });
      });
    });
  }
  std::ranges::for_each(cells, settle);
  return cells;
}

/// Whether two cells differ in nothing but what `free` names.
bool differ_only_in(const Experiment& a, const Experiment& b, const Pattern& free) {
  for (const SlotField& slot : slot_fields(a)) {
    if (free.names(slot.slot) || free.names(fmt::format("{}.name", slot.slot))) continue;
    if (field(a, std::string(slot.slot)) != field(b, std::string(slot.slot))) return false;
    for (const auto& [key, value] : slot.params) {
      const std::string param = fmt::format("{}.{}", slot.slot, key);
      const std::optional<std::string> other = field(b, param);  // a parameter that does nothing in one of them is no difference
      if (!free.names(param) && other && field(a, param) != other) return false;
    }
  }
  for (const char* key : {"scene", "max_depth", "min_weight", "needs", "isa", "packet", "rays", "threads"}) {
    if (!free.names(key) && field(a, key) != field(b, key)) return false;
  }
  return true;
}

nlohmann::json view_json(const SceneView& view) {
  const auto point = [](const glm::dvec3& p) { return nlohmann::json{p.x, p.y, p.z}; };
  nlohmann::json json{{"eye", point(view.eye)}, {"look_at", point(view.look_at)}, {"up", point(view.up)}, {"fov", view.fov_degrees}};
  if (view.light) json["light"] = point(*view.light);
  return json;
}

void leave_out_defaults(ParamValues& params, const std::vector<ParamInfo>& infos) {
  for (const ParamInfo& info : infos) std::erase(params, std::pair(std::string(info.key), info.default_value));
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
  const auto choice_count = [](const auto& axes) {
    double count = 0;
    for (const auto& axis : axes) {
      double product = 1;
      for (const auto& [key, values] : axis.params) product *= static_cast<double>(values.size());
      count += product;
    }
    return count;
  };
  double count = choice_count(m.structure) * choice_count(m.first_hit) * choice_count(m.occlusion);
  for (const std::size_t size :
       {m.scene.size(), m.max_depth.size(), m.min_weight.size(), m.general.size(), m.isa.size(), m.packet.size(), m.rays.size(), m.threads.size()}) {
    count *= static_cast<double>(size);
  }
  return count;
}

std::vector<Experiment> expand(const Config& config, const Pattern& filter, const Shard& shard) try {
  constexpr double kMaxCells = 1e6;
  if (const double count = cell_count(config); count > kMaxCells) throw Error(fmt::format("matrix has {:g} cells, expected at most {:g}", count, kMaxCells));
  const Matrix& m = config.matrix;
  check_use(m.first_hit, first_hits(), m.rays, takes_first_hit, "primary or image");
  check_use(m.occlusion, occlusions(), m.rays, takes_occlusion, "shadow or image");
  check_walks(config);
  std::vector<Experiment> cells;
  std::set<std::string> seen;
  for (std::size_t s = 0; s < config.matrix.scene.size(); ++s) {
    if (static_cast<int>(s % static_cast<std::size_t>(shard.count)) != shard.index) continue;
    for (Experiment& cell : scene_cells(config, config.matrix.scene[s])) {
      const auto excludes = [&](const Pattern& pattern) { return pattern.matches(cell); };
      if (std::any_of(config.exclude.begin(), config.exclude.end(), excludes) || !filter.matches(cell, true)) continue;
      cell.id = cell_identity(cell);
      if (seen.insert(cell.id).second) cells.push_back(std::move(cell));
    }
  }
  return cells;
} catch (const Error& error) {
  throw Error(config.path + ": " + error.what());
}

std::string canonical_json(const Experiment& e) {
  nlohmann::json json{{"scene", e.scene.name},
                      {"structure", e.structure->name},
                      {"params", to_json(e.params)},
                      {"first_hit", technique_text(e.first_hit)},
                      {"occlusion", technique_text(e.occlusion)},
                      {"max_depth", e.max_depth},
                      {"min_weight", e.min_weight},
                      {"isa", name(e.isa)},
                      {"packet", e.packet},
                      {"rays", e.rays.name},
                      {"seed", e.seed},
                      {"threads", threads_text(e.threads)},
                      {"width", e.width},
                      {"height", e.height}};
  if (e.scene.view) json["view"] = view_json(*e.scene.view);
  if (e.general) json["needs"] = "all";
  if (e.camera != CameraConvention::pixel) json["camera"] = name(e.camera);
  return json.dump();
}

std::string cell_identity(const Experiment& e) {
  Experiment chosen = e;
  leave_out_defaults(chosen.params, e.structure->params());
  leave_out_defaults(chosen.first_hit.params, e.first_hit.entry->params());
  leave_out_defaults(chosen.occlusion.params, e.occlusion.entry->params());
  return hash_text(canonical_json(chosen));
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
