#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/scenes/json_view.h"
#include "experiments/scenes/source_file.h"

namespace raymeter {

/// The elements of an accessor, checked to lie within their buffer.
struct GltfElements {
  const char* first = nullptr;
  std::size_t stride = 0;  ///< bytes
  std::int64_t count = 0;
  std::int64_t component_type = 0;  ///< glTF's number of it: 5121 unsigned byte, 5123 unsigned short, 5125 unsigned int, 5126 float
  std::string_view type;            ///< "SCALAR", "VEC3" ...
};

/// A glTF 2.0 file, text or binary, with its buffers: within the file, as data URIs, or files beside it.
class GltfDocument {
public:
  /// Throws Error where the file is damaged or needs an extension that changes geometry. `file` must outlive the document.
  explicit GltfDocument(const SourceFile& file);

  [[nodiscard]] JsonView root() const noexcept { return {file_, json_}; }
  /// Throws Error for sparse accessors, which are not supported, and those that leave their buffer.
  [[nodiscard]] GltfElements elements(std::int64_t accessor) const;

private:
  void parse(std::string_view json);
  void split_binary();
  void load_buffers();
  [[nodiscard]] std::string_view load_buffer(const JsonView& buffer, bool first);

  const SourceFile& file_;
  nlohmann::json json_;
  std::string_view binary_chunk_;
  bool has_binary_chunk_ = false;
  std::deque<std::string> owned_;  ///< what `buffers_` refers to, unless it is the file's own chunk
  std::vector<std::string_view> buffers_;
};

}  // namespace raymeter
