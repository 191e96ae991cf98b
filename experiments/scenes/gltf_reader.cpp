#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "experiments/scenes/default_view.h"
#include "experiments/scenes/gltf_document.h"
#include "experiments/scenes/scene_readers.h"

namespace raymeter {

namespace {

constexpr std::int64_t kFloat = 5126;
/// Nodes may place one mesh many times, so that the file's size does not limit the scene's.
constexpr std::int64_t kMaxPrims = std::int64_t{1} << 27;

enum class Topology : std::uint8_t { triangles = 4, strip = 5, fan = 6 };

/// What a primitive of a mesh is made from.
struct MeshArrays {
  GltfElements position;
  std::optional<GltfElements> normal;
  std::optional<GltfElements> index;
};

glm::dvec3 vector_at(const GltfElements& elements, std::int64_t i) noexcept {
  float value[3];
  std::memcpy(value, elements.first + static_cast<std::size_t>(i) * elements.stride, sizeof value);
  return {value[0], value[1], value[2]};
}

std::int64_t index_at(const GltfElements& elements, std::int64_t i) noexcept {
  const char* const bytes = elements.first + static_cast<std::size_t>(i) * elements.stride;
  std::uint32_t index = 0;  // the low bytes come first
  std::memcpy(&index, bytes, elements.component_type == 5121 ? 1 : elements.component_type == 5123 ? 2 : 4);
  return index;
}

/// The three corners of triangle i, as positions in the list of indices, in the order that glTF 2.0 section 3.7.2.1 gives.
std::array<std::int64_t, 3> corners(Topology topology, std::int64_t i) noexcept {
  if (topology == Topology::triangles) return {3 * i, 3 * i + 1, 3 * i + 2};
  if (topology == Topology::fan) return {i + 1, i + 2, 0};
  return {i, i + 1 + i % 2, i + 2 - i % 2};
}

template <int N>
std::array<double, N> numbers(const JsonView& array) {
  if (array.size() != N) throw array.error(fmt::format("expected {} numbers", N));
  std::array<double, N> values;
  for (int i = 0; i < N; ++i) values[static_cast<std::size_t>(i)] = array.at(i).number();
  return values;
}

glm::dmat4 local_transform(const JsonView& node) {
  if (const auto matrix = node.find("matrix")) {
    const std::array<double, 16> m = numbers<16>(*matrix);
    return {m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], m[12], m[13], m[14], m[15]};
  }
  glm::dmat4 transform(1.0);
  if (const auto translation = node.find("translation")) {
    const auto t = numbers<3>(*translation);
    transform = glm::translate(transform, {t[0], t[1], t[2]});
  }
  if (const auto rotation = node.find("rotation")) {
    const auto q = numbers<4>(*rotation);
    transform *= glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  }
  if (const auto scale = node.find("scale")) {
    const auto s = numbers<3>(*scale);
    transform = glm::scale(transform, {s[0], s[1], s[2]});
  }
  return transform;
}

bool is_finite(const glm::dmat4& matrix) noexcept {
  for (glm::length_t column = 0; column < 4; ++column) {
    for (glm::length_t row = 0; row < 4; ++row) {
      if (!std::isfinite(matrix[column][row])) return false;
    }
  }
  return true;
}

/// Nodes that are no node's child, the last first.
std::vector<std::int64_t> roots_of(const JsonView& nodes) {
  std::vector<bool> is_child(static_cast<std::size_t>(nodes.size()));
  for (std::int64_t i = 0; i < nodes.size(); ++i) {
    const auto children = nodes.at(i).find("children");
    for (std::int64_t k = 0; children && k < children->size(); ++k) is_child[static_cast<std::size_t>(children->at(k).integer(0, nodes.size() - 1))] = true;
  }
  std::vector<std::int64_t> roots;
  for (std::int64_t i = nodes.size() - 1; i >= 0; --i) {
    if (!is_child[static_cast<std::size_t>(i)]) roots.push_back(i);
  }
  return roots;
}

/// Khronos, glTF 2.0 specification.
class GltfReader {
public:
  explicit GltfReader(const SourceFile& file) : document_(file) {}

  Scene read() {
    if (const auto nodes = document_.root().find("nodes")) read_nodes(*nodes);
    complete_view(scene_, has_camera_);
    return std::move(scene_);
  }

private:
  struct Visit {
    std::int64_t node;
    glm::dmat4 parent;
  };

  /// Depth first, in the file's order, with a stack of its own: a file may nest nodes deeper than the program's stack is.
  void read_nodes(const JsonView& nodes) {
    std::vector<Visit> stack;
    const auto push = [&](const JsonView& indices, const glm::dmat4& parent) {
      for (std::int64_t i = indices.size() - 1; i >= 0; --i) stack.push_back({indices.at(i).integer(0, nodes.size() - 1), parent});
    };
    if (const auto scenes = document_.root().find("scenes")) {
      const JsonView shown = scenes->at(document_.root().integer_or("scene", 0, 0, scenes->size()));
      if (const auto roots = shown.find("nodes")) push(*roots, glm::dmat4(1.0));
    } else {
      for (const std::int64_t root : roots_of(nodes)) stack.push_back({root, glm::dmat4(1.0)});
    }
    std::vector<bool> seen(static_cast<std::size_t>(nodes.size()));
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const JsonView node = nodes.at(visit.node);
      if (seen[static_cast<std::size_t>(visit.node)]) throw node.error("is reached twice; expected nodes to form trees");
      seen[static_cast<std::size_t>(visit.node)] = true;
      const glm::dmat4 to_world = visit.parent * local_transform(node);
      if (!is_finite(to_world)) throw node.error("its transform is not finite");
      if (const auto mesh = node.find("mesh")) read_mesh(node, mesh->integer(0, kMaxPrims), to_world);
      if (const auto camera = node.find("camera")) {
        read_camera(camera->integer(0, kMaxPrims), to_world);
        if (scene_.camera.look_at == scene_.camera.eye) throw camera->error("its node's transform leaves it no direction");
      }
      if (const auto children = node.find("children")) push(*children, to_world);
    }
  }

  /// The first perspective camera; its vertical angle serves for both axes.
  void read_camera(std::int64_t index, const glm::dmat4& to_world) {
    const auto perspective = document_.root().at("cameras").at(index).find("perspective");
    if (!perspective || has_camera_) return;
    has_camera_ = true;
    Camera& camera = scene_.camera;
    camera.eye = glm::dvec3(to_world[3]);
    camera.look_at = camera.eye - glm::dvec3(to_world[2]);
    camera.up = glm::dvec3(to_world[1]);
    const double angle = perspective->at("yfov").number();
    if (!(angle > 0 && angle < std::numbers::pi)) throw perspective->at("yfov").error("expected an angle between 0 and pi");
    camera.fov_degrees = angle * 180 / std::numbers::pi;
    camera.hither = perspective->at("znear").number();
  }

  void read_mesh(const JsonView& node, std::int64_t index, const glm::dmat4& to_world) {
    const JsonView mesh = document_.root().at("meshes").at(index);
    const auto name = node.find("name") ? node.find("name") : mesh.find("name");
    scene_.begin_object(name ? std::string(name->text()) : fmt::format("mesh {}", index), to_world);
    const JsonView primitives = mesh.at("primitives");
    for (std::int64_t i = 0; i < primitives.size(); ++i) read_primitive(primitives.at(i), to_world);
    scene_.end_object();
  }

  void read_primitive(const JsonView& primitive, const glm::dmat4& to_world) {
    const std::int64_t mode = primitive.integer_or("mode", 4, 0, 6);
    if (mode < static_cast<std::int64_t>(Topology::triangles)) return;  // points and lines
    read_material(primitive);
    const MeshArrays arrays = mesh_arrays(primitive);
    const std::int64_t count = arrays.index ? arrays.index->count : arrays.position.count;
    if (mode == 4 && count % 3 != 0) throw primitive.error(fmt::format("triangles of {} vertices; expected a multiple of 3", count));
    const std::int64_t triangles = mode == 4 ? count / 3 : std::max<std::int64_t>(count - 2, 0);
    if (scene_.prim_id_count() + triangles > kMaxPrims) throw primitive.error(fmt::format("the scene has more than {} triangles", kMaxPrims));
    const glm::dmat3 normal_to_world = glm::inverseTranspose(glm::dmat3(to_world));
    const bool mirrored = glm::determinant(glm::dmat3(to_world)) < 0;
    for (std::int64_t i = 0; i < triangles; ++i) {
      std::array<std::int64_t, 3> corner = corners(static_cast<Topology>(mode), i);
      if (mirrored) std::swap(corner[1], corner[2]);  // the outside stays outside
      std::array<glm::dvec3, 3> vertex, normal;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t at = arrays.index ? index_at(*arrays.index, corner[k]) : corner[k];
        if (at >= arrays.position.count) {
          throw primitive.error(fmt::format("indices[{}] is {}; expected less than the {} vertices", corner[k], at, arrays.position.count));
        }
        vertex[k] = glm::dvec3(to_world * glm::dvec4(vector_at(arrays.position, at), 1));
        if (arrays.normal) normal[k] = normal_to_world * vector_at(*arrays.normal, at);
      }
      if (arrays.normal)
        scene_.add_triangle(vertex, normal);
      else
        scene_.add_triangle(vertex[0], vertex[1], vertex[2]);
    }
  }

  [[nodiscard]] MeshArrays mesh_arrays(const JsonView& primitive) const {
    const JsonView attributes = primitive.at("attributes");
    MeshArrays arrays{vectors(attributes.at("POSITION")), std::nullopt, std::nullopt};
    if (const auto normal = attributes.find("NORMAL")) {
      arrays.normal = vectors(*normal);
      if (arrays.normal->count != arrays.position.count) throw normal->error("expected as many normals as positions");
    }
    if (const auto indices = primitive.find("indices")) {
      arrays.index = document_.elements(indices->integer(0, kMaxPrims));
      const std::int64_t type = arrays.index->component_type;
      if (arrays.index->type != "SCALAR" || (type != 5121 && type != 5123 && type != 5125)) throw indices->error("expected an accessor of unsigned integers");
    }
    return arrays;
  }

  [[nodiscard]] GltfElements vectors(const JsonView& attribute) const {
    const GltfElements elements = document_.elements(attribute.integer(0, kMaxPrims));
    if (elements.type != "VEC3" || elements.component_type != kFloat) throw attribute.error("expected an accessor of VEC3 of floats");
    return elements;
  }

  /// The base colour; its opacity counts where the material says that it blends.
  void read_material(const JsonView& primitive) {
    Material material;
    if (const auto index = primitive.find("material")) {
      const JsonView source = document_.root().at("materials").at(index->integer(0, kMaxPrims));
      const auto surface = source.find("pbrMetallicRoughness");
      if (const auto factor = surface ? surface->find("baseColorFactor") : std::nullopt) {
        const std::array<double, 4> color = numbers<4>(*factor);
        material.color = {color[0], color[1], color[2]};
        const auto alpha_mode = source.find("alphaMode");
        if (alpha_mode && alpha_mode->text() == "BLEND") material.transmittance = std::clamp(1 - color[3], 0.0, 1.0);
      }
    }
    scene_.set_material(material);
  }

  GltfDocument document_;
  Scene scene_;
  bool has_camera_ = false;
};

}  // namespace

Scene read_gltf(const SourceFile& file) { return GltfReader(file).read(); }

}  // namespace raymeter
