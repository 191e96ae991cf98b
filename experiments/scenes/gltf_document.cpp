#include "experiments/scenes/gltf_document.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include <fmt/format.h>

namespace raymeter {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF's buffers are read as they lie in memory");

constexpr std::string_view kMagic = "glTF";
constexpr std::size_t kHeaderSize = 12;
constexpr std::size_t kChunkHeaderSize = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
constexpr std::int64_t kMaxInteger = std::int64_t{1} << 53;  // JSON's whole numbers

std::uint32_t word_at(std::string_view bytes, std::size_t offset) noexcept {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

std::string decode_base64(const JsonView& uri, std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw uri.error("the data URI is no valid base64");
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFF;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += static_cast<char>(bits >> bit_count & 0xFF);
  }
  return bytes;
}

/// With %20 and the like replaced.
std::string decode_uri(std::string_view uri) {
  const auto value = [](char c) noexcept {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && value(uri[i + 1]) >= 0 && value(uri[i + 2]) >= 0) {
      path += static_cast<char>(value(uri[i + 1]) * 16 + value(uri[i + 2]));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

std::size_t component_size(const JsonView& accessor, std::int64_t component_type) {
  switch (component_type) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: throw accessor.error(fmt::format("unknown componentType {}", component_type));
  }
}

std::size_t component_count(const JsonView& accessor, std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kTypes{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [name, count] : kTypes) {
    if (name == type) return count;
  }
  throw accessor.error("unknown type; expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
}

/// Extensions that a reader of geometry and base colours may leave out.
bool is_optional_here(std::string_view extension) noexcept {
  for (const std::string_view prefix : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"}) {
    if (extension.starts_with(prefix)) return true;
  }
  return false;
}

}  // namespace

GltfDocument::GltfDocument(const SourceFile& file) : file_(file) {
  if (std::string_view(file.bytes).starts_with(kMagic))
    split_binary();
  else
    parse(file.bytes);
  if (!root().at("asset").at("version").text().starts_with("2.")) throw root().at("asset").at("version").error("expected glTF version 2");
  if (const std::optional<JsonView> required = root().find("extensionsRequired")) {
    for (std::int64_t i = 0; i < required->size(); ++i) {
      const JsonView name = required->at(i);
      if (!is_optional_here(name.text())) throw name.error("this extension is not supported");
    }
  }
  load_buffers();
}

void GltfDocument::parse(std::string_view json) {
  try {
    json_ = nlohmann::json::parse(json);
  } catch (const nlohmann::json::parse_error& error) {
    throw file_.error(fmt::format("is no valid JSON at byte {} of its text; expected glTF", error.byte));
  } catch (const nlohmann::json::exception&) {
    throw file_.error("is no valid JSON: a number is out of range; expected glTF");
  }
}

void GltfDocument::split_binary() {
  const std::string_view bytes = file_.bytes;
  if (bytes.size() < kHeaderSize + kChunkHeaderSize) throw file_.error(fmt::format("binary glTF ends after {} bytes, within its headers", bytes.size()));
  if (word_at(bytes, 4) != 2) throw file_.error(fmt::format("binary glTF version {}; expected 2", word_at(bytes, 4)));
  if (word_at(bytes, 8) != bytes.size()) throw file_.error(fmt::format("binary glTF states {} bytes, but the file has {}", word_at(bytes, 8), bytes.size()));
  for (std::size_t offset = kHeaderSize; offset < bytes.size();) {
    const std::size_t left = bytes.size() - offset;
    if (left < kChunkHeaderSize || word_at(bytes, offset) > left - kChunkHeaderSize)
      throw file_.error(fmt::format("byte {}: binary glTF ends within a chunk", offset));
    const std::string_view chunk = bytes.substr(offset + kChunkHeaderSize, word_at(bytes, offset));
    const std::uint32_t kind = word_at(bytes, offset + 4);
    const bool first = offset == kHeaderSize;
    if (first != (kind == kJsonChunk)) throw file_.error(fmt::format("byte {}: expected one chunk of JSON, before all others", offset));
    if (first) parse(chunk);
    if (kind == kBinaryChunk && !has_binary_chunk_) {
      has_binary_chunk_ = true;
      binary_chunk_ = chunk;
    }
    offset += kChunkHeaderSize + chunk.size();
  }
}

void GltfDocument::load_buffers() {
  const std::optional<JsonView> buffers = root().find("buffers");
  for (std::int64_t i = 0; buffers && i < buffers->size(); ++i) {
    const JsonView buffer = buffers->at(i);
    const std::string_view bytes = load_buffer(buffer, i == 0);
    const auto length = static_cast<std::size_t>(buffer.at("byteLength").integer(1, kMaxInteger));
    if (bytes.size() < length) throw buffer.error(fmt::format("has {} bytes; expected {}", bytes.size(), length));
    buffers_.push_back(bytes.substr(0, length));
  }
}

std::string_view GltfDocument::load_buffer(const JsonView& buffer, bool first) {
  const std::optional<JsonView> uri = buffer.find("uri");
  if (!uri) {
    if (!first || !has_binary_chunk_) throw buffer.error("has no uri, and no binary chunk belongs to it");
    return binary_chunk_;
  }
  const std::string_view text = uri->text();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(";base64,");
    if (comma == std::string_view::npos) throw uri->error("expected a data URI in base64");
    return owned_.emplace_back(decode_base64(*uri, text.substr(comma + std::string_view(";base64,").size())));
  }
  if (!file_.folder) throw uri->error("refers to another file, which is not read here");
  return owned_.emplace_back(read_source_file((*file_.folder / decode_uri(text)).string()).bytes);
}

GltfElements GltfDocument::elements(std::int64_t index) const {
  const JsonView accessor = root().at("accessors").at(index);
  if (accessor.find("sparse")) throw accessor.error("sparse accessors are not supported");
  if (!accessor.find("bufferView")) throw accessor.error("accessors without a bufferView are not supported");
  const JsonView view = root().at("bufferViews").at(accessor.at("bufferView").integer(0, kMaxInteger));
  const std::int64_t buffer_index = view.at("buffer").integer(0, static_cast<std::int64_t>(buffers_.size()) - 1);
  const std::string_view buffer = buffers_[static_cast<std::size_t>(buffer_index)];
  const auto view_offset = static_cast<std::size_t>(view.integer_or("byteOffset", 0, 0, kMaxInteger));
  const auto view_length = static_cast<std::size_t>(view.at("byteLength").integer(1, kMaxInteger));
  if (view_offset > buffer.size() || view_length > buffer.size() - view_offset) {
    throw view.error(fmt::format("bytes {} to {} lie outside the buffer of {} bytes", view_offset, view_offset + view_length, buffer.size()));
  }
  GltfElements elements;
  elements.type = accessor.at("type").text();
  elements.component_type = accessor.at("componentType").integer(0, std::numeric_limits<std::int32_t>::max());
  const std::size_t element_size = component_size(accessor, elements.component_type) * component_count(accessor, elements.type);
  elements.count = accessor.at("count").integer(1, kMaxInteger);
  elements.stride =
      static_cast<std::size_t>(view.integer_or("byteStride", static_cast<std::int64_t>(element_size), static_cast<std::int64_t>(element_size), 252));
  const auto offset = static_cast<std::size_t>(accessor.integer_or("byteOffset", 0, 0, kMaxInteger));
  if (offset > view_length || view_length - offset < element_size ||
      static_cast<std::size_t>(elements.count - 1) > (view_length - offset - element_size) / elements.stride) {
    throw accessor.error(fmt::format("{} elements of {} bytes, {} apart, from byte {} do not fit its bufferView of {} bytes", elements.count, element_size,
                                     elements.stride, offset, view_length));
  }
  elements.first = buffer.data() + view_offset + offset;
  return elements;
}

}  // namespace raymeter
