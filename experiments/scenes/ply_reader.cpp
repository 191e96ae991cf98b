#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "experiments/in_quotes.h"
#include "experiments/scenes/default_view.h"
#include "experiments/scenes/face.h"
#include "experiments/scenes/ply_header.h"
#include "experiments/scenes/scene_readers.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

/// The data of an ASCII file, number by number.
class PlyText {
public:
  PlyText(const SourceFile& file, const PlyHeader& header) noexcept : text_(file, '\0', header.data_offset, header.data_line) {}

  double number(PlyType) { return text_.number("a number"); }
  std::int64_t integer(PlyType) {
    return text_.integer("an index or a list's length", std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::uint32_t>::max());
  }
  [[nodiscard]] Error error(std::string_view what) const { return text_.error(what); }

private:
  TextReader text_;
};

/// The data of a binary file, number by number.
class PlyBinary {
public:
  PlyBinary(const SourceFile& file, const PlyHeader& header) noexcept
      : file_(file), position_(header.data_offset), swap_((header.format == PlyFormat::binary_big_endian) != (std::endian::native == std::endian::big)) {}

  double number(PlyType type) {
    if (type == PlyType::float32) return double{load<float>()};
    if (type == PlyType::float64) return load<double>();
    return static_cast<double>(integer(type));
  }
  std::int64_t integer(PlyType type) {
    switch (type) {
      case PlyType::int8: return load<std::int8_t>();
      case PlyType::uint8: return load<std::uint8_t>();
      case PlyType::int16: return load<std::int16_t>();
      case PlyType::uint16: return load<std::uint16_t>();
      case PlyType::int32: return load<std::int32_t>();
      default: return load<std::uint32_t>();
    }
  }
  [[nodiscard]] Error error(std::string_view what) const { return file_.error(fmt::format("byte {}: {}", position_, what)); }

private:
  template <class T>
  T load() {
    if (file_.bytes.size() - position_ < sizeof(T)) throw error("the file ends within its data");
    char bytes[sizeof(T)];
    std::memcpy(bytes, file_.bytes.data() + position_, sizeof(T));
    if (swap_) std::reverse(bytes, bytes + sizeof(T));
    position_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  const SourceFile& file_;
  std::size_t position_;
  bool swap_;
};

/// G. Turk, The PLY Polygon File Format, 1994. `Values` is PlyText or PlyBinary.
template <class Values>
class PlyReader {
public:
  PlyReader(const SourceFile& file, const PlyHeader& header) : header_(header), values_(file, header) {}

  Scene read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        skip(element);
    }
    complete_view(scene_, false);
    return std::move(scene_);
  }

private:
  static constexpr std::size_t kNone = 6;

  void skip(const PlyProperty& property) {
    const std::int64_t count = property.count_type ? list_length(property) : 1;
    for (std::int64_t k = 0; k < count; ++k) (void)values_.number(property.type);
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;  // the count says nothing about the file's size
    for (std::int64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) skip(property);
    }
  }

  std::int64_t list_length(const PlyProperty& property) {
    const std::int64_t length = values_.integer(*property.count_type);
    if (length < 0) throw values_.error(fmt::format("list {} has the negative length {}", in_quotes(property.name), length));
    return length;
  }

  void read_vertices(const PlyElement& element) {
    if (!vertices_.empty()) throw values_.error("a second element 'vertex'; expected one");
    constexpr std::string_view kNames[kNone] = {"x", "y", "z", "nx", "ny", "nz"};
    std::vector<std::size_t> slots;
    bool has[kNone + 1] = {};
    for (const PlyProperty& property : element.properties) {
      slots.push_back(property.count_type ? kNone : static_cast<std::size_t>(std::find(kNames, kNames + kNone, property.name) - kNames));
      has[slots.back()] = true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (element.count > 0 && !has[k])
        throw values_.error(fmt::format("element 'vertex' has no property {}; expected numbers x, y and z", in_quotes(kNames[k])));
    }
    const bool has_normals = has[3] && has[4] && has[5];
    vertices_.reserve(static_cast<std::size_t>(element.count));
    if (has_normals) normals_.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t row = 0; row < element.count; ++row) {
      float value[kNone] = {};
      for (std::size_t k = 0; k < slots.size(); ++k) {
        if (slots[k] == kNone)
          skip(element.properties[k]);
        else
          value[slots[k]] = static_cast<float>(values_.number(element.properties[k].type));
      }
      vertices_.push_back({value[0], value[1], value[2]});
      if (has_normals) normals_.push_back({value[3], value[4], value[5]});
    }
  }

  void read_faces(const PlyElement& element) {
    if (element.count > 0 && std::count_if(element.properties.begin(), element.properties.end(), is_face_outline) != 1) {
      throw values_.error("element 'face' needs one property 'vertex_indices', a list of integers");
    }
    if (element.count > 0 && vertices_.empty()) throw values_.error("element 'face' comes without vertices; expected element 'vertex' before it");
    for (std::int64_t row = 0; row < element.count; ++row) {
      if (row == 1 && corners_.size() == 3) scene_.reserve(PrimKind::triangle, static_cast<std::size_t>(element.count));  // it is a mesh of triangles
      for (const PlyProperty& property : element.properties) {
        if (is_face_outline(property))
          read_face(property);
        else
          skip(property);
      }
    }
  }

  void read_face(const PlyProperty& property) {
    const std::int64_t count = list_length(property);
    if (count < 3) throw values_.error(fmt::format("a face has {} vertices; expected at least 3", count));
    corners_.clear();
    corner_normals_.clear();
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t index = values_.integer(property.type);
      if (index < 0 || index >= static_cast<std::int64_t>(vertices_.size())) {
        throw values_.error(fmt::format("vertex index {} is out of range; expected 0 to {}", index, vertices_.size() - 1));
      }
      corners_.emplace_back(vertices_[static_cast<std::size_t>(index)]);
      if (!normals_.empty()) corner_normals_.emplace_back(normals_[static_cast<std::size_t>(index)]);
    }
    add_face(scene_, corners_, corner_normals_);
  }

  const PlyHeader& header_;
  Values values_;
  Scene scene_;
  // As float, like the scene: half the memory.
  std::vector<glm::vec3> vertices_;
  std::vector<glm::vec3> normals_;
  std::vector<glm::dvec3> corners_;
  std::vector<glm::dvec3> corner_normals_;
};

}  // namespace

Scene read_ply(const SourceFile& file) {
  const PlyHeader header = read_ply_header(file);
  return header.format == PlyFormat::ascii ? PlyReader<PlyText>(file, header).read() : PlyReader<PlyBinary>(file, header).read();
}

}  // namespace raymeter
