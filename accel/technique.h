#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/params.h"
#include "core/scene/scene.h"
#include "core/simd/isa.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// Static quality of a built structure; what does not apply is empty. Cells of grids count as leaves.
struct BuildStats {
  std::int64_t interior_nodes = 0;
  std::int64_t leaves = 0;
  std::int64_t empty_leaves = 0;
  std::int64_t references = 0;  ///< primitive references over all leaves
  std::optional<std::int64_t> max_depth;
  std::optional<double> sah_cost;  ///< what a random line that meets the root is expected to cost, C_t = C_i = 1, C_t for a node of two children
  std::optional<double> epo;       ///< end-point overlap
  // Of hierarchies, in the order of the criteria of a good one. sah_cost and these are of the nodes' volumes in use, epo and sibling_distance of their boxes.
  std::optional<double> sibling_distance;  ///< mean distance of children's centres from their common centre, relative to the scene's diagonal
  std::optional<double> node_volume;       ///< mean volume of a node, relative to the root's
  std::optional<double> total_volume;      ///< of all nodes, relative to the root's
  std::optional<double> cost_depth;        ///< mean depth of the SAH cost
  std::optional<double> cost_depth_p90;    ///< depth down to which nine tenths of it lie
  std::optional<double> epo_se;            ///< standard error of epo: 0 where nothing had to be sampled
  std::optional<double> volume_area;       ///< surface area of all bounding volumes together: of nodes, or of what a list puts one around
  std::optional<double> void_area;         ///< lists: the volumes' mean projected areas less those of the primitives in them
  std::size_t mem_bytes = 0;               ///< of the structure alone, without the scene
  [[nodiscard]] std::int64_t nodes() const noexcept { return interior_nodes + leaves; }
};

/// How a built structure is to be queried.
struct QueryOptions {
  Isa isa = Isa::scalar;
  int packet = 1;      ///< rays per packet, 1..kMaxPacket
  ParamValues params;  ///< the technique's; they may differ from the build's in what needs no new one: ParamUse::query, ParamInfo::same_build
};

/// A built acceleration structure. Keeps what it needs of the scene by reference: the scene must outlive it.
class Structure {
public:
  virtual ~Structure() = default;
  [[nodiscard]] virtual const BuildStats& stats() const noexcept = 0;
  /// The intersector refers to the structure.
  [[nodiscard]] virtual std::unique_ptr<Intersector> intersector(const QueryOptions& options) const = 0;
};

/// A row of the table of techniques: everything that `list`, `describe`, the schema, the runner and the conformance tests know of one.
struct StructureEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view source;  ///< who, when, where
  std::vector<ParamInfo> (*params)();
  /// All parameters that mean something beside each other, with their values; or Error.
  ParamValues (*resolve)(const ParamValues& values);
  /// Builds on at most `threads` threads (0: all). The result does not depend on their number.
  std::unique_ptr<Structure> (*build)(const Scene& scene, const ParamValues& values, int threads);
  /// Adds to a build's figures those that take as long as another build, or longer, to find; null where there are none.
  void (*add_quality)(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats) = nullptr;
  /// From outside: answers by its own conventions, counts nothing.
  bool peer = false;
  /// Why it cannot serve a scene on an instruction set, or is not in this build at all; empty where it can. Null: it always can.
  std::string (*why_not)(const Scene& scene, Isa isa) = nullptr;
  /// Whether a setting's intersectors are CellWalks too (core/trace/cell_walk.h). Null: never.
  bool (*walks_cells)(const ParamValues& values) = nullptr;
};

/// What a technique's Params give the table.
template <class Params>
[[nodiscard]] ParamValues resolve_params(const ParamValues& values) {
  return resolved(bind<Params>(values));
}

}  // namespace raymeter
