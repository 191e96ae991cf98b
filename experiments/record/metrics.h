#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raymeter {

/// The derived tables; each is a CSV file of a results folder.
enum class Table : unsigned char { samples, builds, counters, accuracy, frames, summary, break_even };
[[nodiscard]] std::string_view name(Table table) noexcept;

/// Which direction is good; `exact` values must not change at all.
enum class Better : unsigned char { lower, higher, exact, neither };
[[nodiscard]] std::string_view name(Better better) noexcept;

/// A column of a table. Units stand in the names.
struct Metric {
  Table table;
  std::string_view name;
  Better better;
  std::string_view help;
};

/// Every column of every table, in the tables' order, without the key columns.
[[nodiscard]] std::span<const Metric> metrics() noexcept;
/// The columns that say which cell of the matrix a row is about; every table but break_even begins with them.
[[nodiscard]] std::span<const std::string_view> key_columns() noexcept;
[[nodiscard]] std::vector<std::string_view> columns(Table table);

}  // namespace raymeter
