#include "experiments/npy.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "experiments/in_quotes.h"

namespace raymeter {

namespace {

constexpr std::string_view kMagic("\x93NUMPY", 6);
constexpr std::size_t kRayColumns = 8;

/// The header's dictionary: a Python literal with three keys.
struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

class HeaderParser {
public:
  HeaderParser(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  Header parse() {
    Header header;
    int seen = 0;
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      if (key != "descr" && key != "fortran_order" && key != "shape") fail("expected a known key");
      expect(':');
      if (key == "descr")
        header.descr = dtype();
      else if (key == "fortran_order")
        header.fortran_order = boolean();
      else
        header.shape = tuple();
      seen |= key == "descr" ? 1 : key == "shape" ? 2 : 4;
      if (!accept(',') && !at('}')) fail("expected ',' or '}'");
    }
    if (seen != 7) fail("expected the keys descr, fortran_order and shape");
    return header;
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}: broken .npy header: {} at byte {}", name_, what, next_)); }
  void skip_space() {
    while (next_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[next_])) != 0) ++next_;
  }
  bool at(char c) {
    skip_space();
    return next_ < text_.size() && text_[next_] == c;
  }
  bool accept(char c) {
    if (!at(c)) return false;
    ++next_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("expected '") + c + "'");
  }
  std::string quoted() {
    const char quote = at('"') ? '"' : '\'';
    expect(quote);
    const std::size_t end = text_.find(quote, next_);
    if (end == std::string_view::npos) fail("open string");
    const std::string value(text_.substr(next_, end - next_));
    next_ = end + 1;
    return value;
  }
  /// A name, or the text of a structured type's list, which only a message shows.
  std::string dtype() {
    if (!at('[')) return quoted();
    const std::size_t first = next_;
    int depth = 0;
    do {
      if (next_ >= text_.size()) fail("open list");
      if (text_[next_] == '[') ++depth;
      if (text_[next_] == ']') --depth;
      ++next_;
    } while (depth > 0);
    return std::string(text_.substr(first, next_ - first));
  }
  bool boolean() {
    skip_space();
    for (const auto& [word, value] : {std::pair{std::string_view("True"), true}, {std::string_view("False"), false}}) {
      if (!text_.substr(next_).starts_with(word)) continue;
      next_ += word.size();
      return value;
    }
    fail("expected True or False");
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!accept(')')) {
      skip_space();
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text_.data() + next_, text_.data() + text_.size(), value);
      if (error != std::errc{}) fail("expected a whole number");
      next_ = static_cast<std::size_t>(end - text_.data());
      values.push_back(value);
      accept('L');  // Python 2 wrote long integers so
      if (!accept(',') && !at(')')) fail("expected ',' or ')'");
    }
    return values;
  }

  std::string_view text_;
  std::string_view name_;
  std::size_t next_ = 0;
};

std::string shape_text(const std::vector<std::uint64_t>& shape) { return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : ""); }

/// Splits the file into its header and its data.
std::pair<Header, std::string_view> split(std::string_view bytes, std::string_view name) {
  if (!bytes.starts_with(kMagic)) throw Error(fmt::format("{}: not a .npy file: expected it to begin with \\x93NUMPY", name));
  const auto byte = [&](std::size_t i) noexcept { return std::size_t{static_cast<unsigned char>(bytes[i])}; };
  if (bytes.size() < 12) throw Error(fmt::format("{}: truncated in its .npy header", name));
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) throw Error(fmt::format("{}: .npy version {}, expected 1, 2 or 3", name, version));
  const std::size_t first = version == 1 ? 10 : 12;
  const std::size_t length = version == 1 ? byte(8) | byte(9) << 8 : byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24;
  if (bytes.size() - first < length) throw Error(fmt::format("{}: truncated in its .npy header", name));
  return {HeaderParser(bytes.substr(first, length), name).parse(), bytes.substr(first + length)};
}

std::string file_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (file) bytes << file.rdbuf();  // an empty file only sets failbit
  if (!file || bytes.bad()) throw Error(path + ": cannot be read, expected a .npy file with rays");
  return std::move(bytes).str();
}

void write_header(AtomicFile& file, std::string_view descr, std::size_t count) {
  std::string dictionary = fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': ({},), }}", descr, count);
  dictionary.append(63 - (10 + dictionary.size()) % 64, ' ');  // the data begin at a multiple of 64 bytes
  dictionary += '\n';
  std::string prefix(kMagic);
  prefix += {'\x01', '\x00', static_cast<char>(dictionary.size() & 0xff), static_cast<char>(dictionary.size() >> 8)};
  file.write(prefix + dictionary);
}

/// Writes elements in blocks, each made by element(i).
template <class Element, class Make>
void write_elements(AtomicFile& file, std::size_t count, Make&& element) {
  std::vector<Element> block;
  for (std::size_t first = 0; first < count; first += block.size()) {
    block.resize(std::min<std::size_t>(1 << 16, count - first));
    for (std::size_t i = 0; i < block.size(); ++i) block[i] = element(first + i);
    file.write(block.data(), block.size() * sizeof(Element));
  }
}

}  // namespace

RayBatch parse_rays_npy(std::string_view bytes, std::string_view name) {
  const auto [header, data] = split(bytes, name);
  if (header.descr != "<f4") throw Error(fmt::format("{}: dtype {}, expected float32 ('<f4')", name, in_quotes(header.descr)));
  if (header.shape.size() != 2 || header.shape[1] != kRayColumns) {
    throw Error(fmt::format("{}: shape {}, expected (N, 8): ox oy oz tmin dx dy dz tmax", name, in_quotes(shape_text(header.shape))));
  }
  if (header.fortran_order) throw Error(fmt::format("{}: Fortran order, expected C order", name));
  const std::uint64_t count = header.shape[0];
  constexpr std::size_t kRayBytes = kRayColumns * sizeof(float);
  if (count > data.size() / kRayBytes)
    throw Error(fmt::format("{}: truncated: {} bytes of data, expected {} rays of {} bytes", name, data.size(), count, kRayBytes));
  if (data.size() != count * kRayBytes) throw Error(fmt::format("{}: {} bytes after the last ray, expected none", name, data.size() - count * kRayBytes));
  RayBatch rays;
  rays.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Ray ray;
    static_assert(sizeof(Ray) == kRayBytes && offsetof(Ray, t_min) == 12 && offsetof(Ray, dir) == 16);  // as in the file
    std::memcpy(&ray, data.data() + i * kRayBytes, kRayBytes);
    rays.set(i, ray);
  }
  return rays;
}

RayBatch read_rays_npy(const std::string& path) { return parse_rays_npy(file_bytes(path), path); }

void write_hits_npy(AtomicFile& file, const HitBatch& hits) {
  struct Element {
    float t;
    std::int32_t prim;
    float u, v;
  };
  write_header(file, "[('t', '<f4'), ('prim', '<i4'), ('u', '<f4'), ('v', '<f4')]", hits.size());
  write_elements<Element>(file, hits.size(), [&](std::size_t i) { return Element{hits.t[i], hits.prim[i], hits.u[i], hits.v[i]}; });
}

void write_blocked_npy(AtomicFile& file, const Column<std::int32_t>& blocker) {
  write_header(file, "'|u1'", blocker.size());
  write_elements<std::uint8_t>(file, blocker.size(), [&](std::size_t i) { return static_cast<std::uint8_t>(blocker[i] >= 0 ? 1 : 0); });
}

}  // namespace raymeter
