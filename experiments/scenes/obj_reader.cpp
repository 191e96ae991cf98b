#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "experiments/in_quotes.h"
#include "experiments/scenes/default_view.h"
#include "experiments/scenes/face.h"
#include "experiments/scenes/obj_materials.h"
#include "experiments/scenes/scene_readers.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

/// Statements of the format that say nothing about polygons.
constexpr std::array<std::string_view, 31> kSkipped{
    "vp",  "p",   "l",  "s",     "cstype",   "deg",      "bmat", "step",   "curv",   "curv2",      "surf",      "parm",  "trim",  "hole", "scrv", "sp",
    "end", "con", "mg", "bevel", "c_interp", "d_interp", "lod",  "maplib", "usemap", "shadow_obj", "trace_obj", "ctech", "stech", "call", "csh"};

/// Wavefront, Object Files (.obj), Advanced Visualizer appendix B1.
class ObjReader {
public:
  explicit ObjReader(const SourceFile& file) noexcept : file_(file), text_(file, '#') {}

  Scene read() {
    while (!text_.at_end()) {
      read_statement(text_.next("a statement"));
      text_.rest_of_line();
    }
    scene_.end_object();
    complete_view(scene_, false);
    return std::move(scene_);
  }

private:
  void read_statement(std::string_view word) {
    if (word == "v") {
      vertices_.push_back(read_triple("a vertex coordinate"));
    } else if (word == "vn") {
      normals_.push_back(read_triple("a component of a vertex normal"));
    } else if (word == "vt") {
      ++texture_vertex_count_;
    } else if (word == "f" || word == "fo") {
      read_face();
    } else if (word == "o" || word == "g") {
      scene_.begin_object(std::string(text_.rest_of_line()));
    } else if (word == "usemtl") {
      const auto found = materials_.find(text_.rest_of_line());
      scene_.set_material(found == materials_.end() ? Material{} : found->second);
    } else if (word == "mtllib") {
      read_materials(text_.rest_of_line());
    } else if (std::find(kSkipped.begin(), kSkipped.end(), word) == kSkipped.end()) {
      throw text_.error(fmt::format("unknown statement {}; expected one of v vn vt f o g usemtl mtllib or another of the format", in_quotes(word)));
    }
  }

  glm::vec3 read_triple(std::string_view expected) {
    float value[3];
    for (float& component : value) {
      if (text_.at_line_end()) throw text_.error(fmt::format("the line ends; expected {}", expected));
      component = static_cast<float>(text_.number(expected));
    }
    return {value[0], value[1], value[2]};
  }

  /// Corners as VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL.
  void read_face() {
    corners_.clear();
    corner_normals_.clear();
    while (!text_.at_line_end()) {
      const std::string_view corner = text_.next("a corner");
      std::string_view part[3] = {};
      std::string_view rest = corner;
      for (std::string_view& index : part) {
        const std::size_t slash = std::min(rest.find('/'), rest.size());
        index = rest.substr(0, slash);
        rest.remove_prefix(std::min(slash + 1, rest.size()));
      }
      if (part[0].empty() || !rest.empty()) throw text_.error(fmt::format("{} is no corner of a face; expected VERTEX/TEXTURE/NORMAL", in_quotes(corner)));
      corners_.emplace_back(vertices_[read_index(part[0], "vertex", vertices_.size())]);
      if (!part[1].empty()) (void)read_index(part[1], "texture vertex", texture_vertex_count_);
      if (!part[2].empty()) corner_normals_.emplace_back(normals_[read_index(part[2], "normal", normals_.size())]);
    }
    if (corners_.size() < 3) throw text_.error(fmt::format("a face has {} vertices; expected at least 3", corners_.size()));
    if (corner_normals_.size() != corners_.size()) corner_normals_.clear();
    add_face(scene_, corners_, corner_normals_);
  }

  /// From 1, or backwards from -1, among the `count` so far.
  std::size_t read_index(std::string_view token, std::string_view what, std::size_t count) {
    std::int64_t index = 0;
    const auto [end, failure] = std::from_chars(token.data(), token.data() + token.size(), index);
    if (failure != std::errc() || end != token.data() + token.size()) throw text_.error(fmt::format("{} is no index of a {}", in_quotes(token), what));
    const auto size = static_cast<std::int64_t>(count);
    if (index == 0 || index > size || index < -size) {
      throw text_.error(fmt::format("{} index {} is out of range; {} are defined so far, counted from 1", what, index, count));
    }
    return static_cast<std::size_t>(index > 0 ? index - 1 : size + index);
  }

  /// One name with spaces, or several. Libraries that are not there are no error: geometry is often passed on without them.
  void read_materials(std::string_view names) {
    if (!file_.folder) return;
    const auto merge = [&](std::string_view name) {
      const std::filesystem::path path = *file_.folder / name;
      if (!std::filesystem::is_regular_file(path)) return false;
      for (const auto& [key, material] : read_mtl(read_source_file(path.string()))) materials_[key] = material;
      return true;
    };
    if (merge(names)) return;
    const SourceFile list{file_.name, std::string(names), std::nullopt};
    for (TextReader words(list); !words.at_end();) merge(words.next("a name"));
  }

  const SourceFile& file_;
  TextReader text_;
  Scene scene_;
  ObjMaterials materials_;
  // As float, like the scene: half the memory.
  std::vector<glm::vec3> vertices_;
  std::vector<glm::vec3> normals_;
  std::size_t texture_vertex_count_ = 0;
  std::vector<glm::dvec3> corners_;
  std::vector<glm::dvec3> corner_normals_;
};

}  // namespace

Scene read_obj(const SourceFile& file) { return ObjReader(file).read(); }

}  // namespace raymeter
