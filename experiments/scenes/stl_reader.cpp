#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "experiments/in_quotes.h"
#include "experiments/scenes/default_view.h"
#include "experiments/scenes/scene_readers.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read as it lies in memory");

constexpr std::size_t kHeaderSize = 84;
/// Normal, three vertices, two bytes of attributes.
constexpr std::size_t kFacetSize = 50;
constexpr std::size_t kFirstVertex = 12;

/// The number of facets that a binary file states.
std::uint32_t stated_count(const SourceFile& file) noexcept {
  std::uint32_t count;
  std::memcpy(&count, file.bytes.data() + kHeaderSize - sizeof count, sizeof count);
  return count;
}

Scene read_binary(const SourceFile& file) {
  Scene scene;
  const std::uint32_t count = stated_count(file);
  scene.reserve(PrimKind::triangle, count);
  const char* facet = file.bytes.data() + kHeaderSize;
  for (std::uint32_t i = 0; i < count; ++i, facet += kFacetSize) {
    float value[9];
    std::memcpy(value, facet + kFirstVertex, sizeof value);
    scene.add_triangle({value[0], value[1], value[2]}, {value[3], value[4], value[5]}, {value[6], value[7], value[8]});
  }
  return scene;
}

glm::dvec3 read_point(TextReader& text, std::string_view expected) {
  const double x = text.number(expected);
  const double y = text.number(expected);
  return {x, y, text.number(expected)};
}

Scene read_text(const SourceFile& file) {
  Scene scene;
  TextReader text(file);
  while (!text.at_end()) {
    text.keyword("solid");
    scene.begin_object(std::string(text.rest_of_line()));
    for (;;) {
      const std::string_view word = text.next("'facet' or 'endsolid'");
      if (word == "endsolid") break;
      if (word != "facet") throw text.error(fmt::format("unknown {}; expected 'facet' or 'endsolid'", in_quotes(word)));
      text.keyword("normal");
      (void)read_point(text, "a component of the normal");
      text.keyword("outer");
      text.keyword("loop");
      glm::dvec3 vertex[3];
      for (glm::dvec3& point : vertex) {
        text.keyword("vertex");
        point = read_point(text, "a vertex coordinate");
      }
      text.keyword("endloop");
      text.keyword("endfacet");
      scene.add_triangle(vertex[0], vertex[1], vertex[2]);
    }
    text.rest_of_line();
    scene.end_object();
  }
  return scene;
}

}  // namespace

Scene read_stl(const SourceFile& file) {
  // Binary files may begin with "solid" too, so the size decides.
  const std::size_t size = file.bytes.size();
  const bool has_header = size >= kHeaderSize;
  const bool is_binary = has_header && size == kHeaderSize + std::size_t{stated_count(file)} * kFacetSize;
  if (!is_binary && TextReader(file).peek() != "solid") {
    throw file.error(has_header ? fmt::format("a binary STL file of {} facets has {} bytes, not {}", stated_count(file),
                                              kHeaderSize + std::size_t{stated_count(file)} * kFacetSize, size)
                                : fmt::format("has {} bytes; expected a text that begins with 'solid' or a binary header of {} bytes", size, kHeaderSize));
  }
  Scene scene = is_binary ? read_binary(file) : read_text(file);
  complete_view(scene, false);
  return scene;
}

}  // namespace raymeter
