#pragma once

#include <optional>
#include <vector>

#include "experiments/config/config.h"

namespace raymeter {

/// One of several runs that share a matrix, by scene: scene i belongs to shard i mod count.
struct Shard {
  int index = 0;  ///< from 0
  int count = 1;
};
/// Reads "I/N", I from 1; throws Error.
[[nodiscard]] Shard parse_shard(const std::string& text);

/// Cells of a config before anything is excluded.
[[nodiscard]] double cell_count(const Config& config) noexcept;

/// The cells of a config: the product of its lists without what it excludes, then those of `filter` and `shard`. Every cell once, scene by scene.
/// Throws Error, which names the config, where the product has more than a million cells, parameters do not go together, or nothing takes what is asked for.
[[nodiscard]] std::vector<Experiment> expand(const Config& config, const Pattern& filter = {}, const Shard& shard = {});

/// The canonical JSON of a cell, for records: its parameters as they are used, defaults included.
[[nodiscard]] std::string canonical_json(const Experiment& experiment);
/// A cell's id: a hash of that JSON without the parameters that are at their defaults, so that one that is new changes no cell that does without it.
[[nodiscard]] std::string cell_identity(const Experiment& experiment);

/// For each cell the index of the one that its time is held against, if there is one.
[[nodiscard]] std::vector<std::optional<std::size_t>> reference_cells(const Config& config, const std::vector<Experiment>& cells);

}  // namespace raymeter
