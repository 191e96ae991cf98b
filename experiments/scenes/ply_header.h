#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/scenes/source_file.h"

namespace raymeter {

enum class PlyFormat : std::uint8_t { ascii, binary_little_endian, binary_big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] std::size_t byte_size(PlyType type) noexcept;
[[nodiscard]] bool is_integer(PlyType type) noexcept;

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list; always an integer
};

/// Whether a property of element "face" lists the indices of its vertices.
[[nodiscard]] bool is_face_outline(const PlyProperty& property) noexcept;

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// What a PLY file says of itself before its data.
struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t data_offset = 0;  ///< in bytes
  int data_line = 1;
};

/// Throws Error naming the line. An element's count is one that the file's size allows.
[[nodiscard]] PlyHeader read_ply_header(const SourceFile& file);

}  // namespace raymeter
