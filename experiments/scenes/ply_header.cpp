#include "experiments/scenes/ply_header.h"

#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "experiments/in_quotes.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

/// Both spellings in use: the original one and the one with sizes.
constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{
    {"char", PlyType::int8},
    {"int8", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},
    {"short", PlyType::int16},
    {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"uint16", PlyType::uint16},
    {"int", PlyType::int32},
    {"int32", PlyType::int32},
    {"uint", PlyType::uint32},
    {"uint32", PlyType::uint32},
    {"float", PlyType::float32},
    {"float32", PlyType::float32},
    {"double", PlyType::float64},
    {"float64", PlyType::float64},
}};

PlyType read_type(TextReader& text, std::string_view expected) {
  const std::string_view token = text.next(expected);
  for (const auto& [name, type] : kTypes) {
    if (token == name) return type;
  }
  throw text.error(fmt::format("unknown type {}; expected {}: char uchar short ushort int uint float or double", in_quotes(token), expected));
}

PlyFormat read_format(TextReader& text) {
  const std::string_view token = text.next("the format");
  text.keyword("1.0");
  if (token == "ascii") return PlyFormat::ascii;
  if (token == "binary_little_endian") return PlyFormat::binary_little_endian;
  if (token == "binary_big_endian") return PlyFormat::binary_big_endian;
  throw text.error(fmt::format("unknown format {}; expected ascii, binary_little_endian or binary_big_endian", in_quotes(token)));
}

PlyProperty read_property(TextReader& text) {
  PlyProperty property;
  if (text.peek() == "list") {
    text.keyword("list");
    property.count_type = read_type(text, "the type of the list's length");
    if (!is_integer(*property.count_type)) throw text.error("the length of a list must have an integer type");
  }
  property.type = read_type(text, "the property's type");
  property.name = text.next("the property's name");
  return property;
}

/// Least number of bytes that an element's entry takes: faces have 3 vertices, other lists may be empty, and a number in a text takes a digit and a separator.
std::size_t least_size(const PlyElement& element, PlyFormat format) noexcept {
  const auto size = [&](PlyType type) { return format == PlyFormat::ascii ? std::size_t{2} : byte_size(type); };
  std::size_t sum = 0;
  for (const PlyProperty& property : element.properties) {
    sum += size(property.count_type.value_or(property.type));
    if (element.name == "face" && is_face_outline(property)) sum += 3 * size(property.type);
  }
  return sum;
}

void check_counts(const SourceFile& file, const PlyHeader& header) {
  // The last number of a text needs no separator.
  const std::size_t left = file.bytes.size() - header.data_offset + (header.format == PlyFormat::ascii ? 1 : 0);
  for (const PlyElement& element : header.elements) {
    const std::size_t least = least_size(element, header.format);
    if (least > 0 && static_cast<std::size_t>(element.count) > left / least) {
      throw file.error(fmt::format("element {} has {} entries of at least {} bytes, but only {} bytes follow the header", in_quotes(element.name),
                                   element.count, least, file.bytes.size() - header.data_offset));
    }
  }
}

}  // namespace

std::size_t byte_size(PlyType type) noexcept {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) noexcept { return type < PlyType::float32; }

bool is_face_outline(const PlyProperty& property) noexcept {
  return property.count_type && is_integer(property.type) && (property.name == "vertex_indices" || property.name == "vertex_index");
}

PlyHeader read_ply_header(const SourceFile& file) {
  TextReader text(file);
  text.keyword("ply");
  PlyHeader header;
  text.keyword("format");
  header.format = read_format(text);
  for (;;) {
    const std::string_view word = text.next("'end_header'");
    if (word == "end_header") break;
    if (word == "comment" || word == "obj_info") {
      text.rest_of_line();
    } else if (word == "element") {
      PlyElement& element = header.elements.emplace_back();
      element.name = text.next("the element's name");
      element.count = text.integer("the number of entries", 0, std::numeric_limits<std::int32_t>::max());
    } else if (word == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(text));
    } else {
      throw text.error(fmt::format("unknown {}; expected element, property (of an element), comment, obj_info or end_header", in_quotes(word)));
    }
  }
  // The data begins behind the line's end: "\n", or "\r\n".
  header.data_offset = text.offset();
  for (const char end : {'\r', '\n'}) {
    if (header.data_offset < file.bytes.size() && file.bytes[header.data_offset] == end) ++header.data_offset;
  }
  header.data_line = text.line() + 1;
  check_counts(file, header);
  return header;
}

}  // namespace raymeter
