#include <array>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "experiments/in_quotes.h"
#include "experiments/scenes/default_view.h"
#include "experiments/scenes/nff_defaults.h"
#include "experiments/scenes/scene_readers.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

/// E. Haines, Neutral File Format, 1987. Entities are read by token, since files differ in where they break lines.
class NffReader {
public:
  explicit NffReader(const SourceFile& file) noexcept : text_(file, '#') {}

  Scene read() {
    while (!text_.at_end()) read_entity();
    // Lights without a colour share one unit of intensity, as is usual for NFF.
    for (const std::size_t light : uncolored_lights_) scene_.lights[light].color = default_light_color(scene_.lights.size());
    complete_view(scene_, has_camera_);
    return std::move(scene_);
  }

private:
  /// Of a primitive: may be NaN or infinite, then the scene drops the primitive.
  glm::dvec3 point(std::string_view expected) {
    const double x = text_.number(expected);
    const double y = text_.number(expected);
    return {x, y, text_.number(expected)};
  }

  /// Of the view, a light or a material.
  glm::dvec3 finite_triple(std::string_view expected) {
    const double x = text_.finite_number(expected);
    const double y = text_.finite_number(expected);
    return {x, y, text_.finite_number(expected)};
  }

  void read_entity() {
    const std::string_view entity = text_.next("an entity");
    if (entity == "v") return read_view();
    if (entity == "b") {
      scene_.background = finite_triple("a background colour component");
    } else if (entity == "l") {
      read_light();
    } else if (entity == "f") {
      read_material();
    } else if (entity == "s") {
      const glm::dvec3 center = point("a coordinate of the sphere's centre");
      scene_.add_sphere(center, text_.number("the sphere's radius"));
    } else if (entity == "c") {
      read_cone();
    } else if (entity == "p" || entity == "pp") {
      read_polygon(entity == "pp");
    } else {
      throw text_.error(fmt::format("unknown entity {}; expected one of v b l f s c p pp #", in_quotes(entity)));
    }
  }

  void read_view() {
    Camera& camera = scene_.camera;
    text_.keyword("from");
    camera.eye = finite_triple("a coordinate of 'from'");
    text_.keyword("at");
    camera.look_at = finite_triple("a coordinate of 'at'");
    if (camera.look_at == camera.eye) throw text_.error("'at' is where 'from' is; expected another point");
    text_.keyword("up");
    camera.up = finite_triple("a coordinate of 'up'");
    text_.keyword("angle");
    camera.fov_degrees = text_.finite_number("the angle of view");
    if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180)) throw text_.error("the angle of view must lie between 0 and 180 degrees");
    text_.keyword("hither");
    camera.hither = text_.finite_number("the hither distance");
    text_.keyword("resolution");
    constexpr int kMaxResolution = 1 << 16;
    camera.width = static_cast<int>(text_.integer("the image's width", 1, kMaxResolution));
    camera.height = static_cast<int>(text_.integer("the image's height", 1, kMaxResolution));
    has_camera_ = true;
  }

  void read_light() {
    Light light;
    light.position = finite_triple("a coordinate of the light");
    if (parse_number(text_.peek()))
      light.color = finite_triple("a colour component of the light");
    else
      uncolored_lights_.push_back(scene_.lights.size());
    scene_.lights.push_back(light);
  }

  void read_material() {
    Material material;
    material.color = finite_triple("a colour component of the material");
    material.diffuse = text_.finite_number("Kd of the material");
    material.specular = text_.finite_number("Ks of the material");
    material.shine = text_.finite_number("the Phong power of the material");
    material.transmittance = text_.finite_number("the transmittance of the material");
    material.ior = text_.finite_number("the index of refraction of the material");
    scene_.set_material(material);
  }

  void read_cone() {
    const glm::dvec3 base = point("a coordinate of the cone's base");
    const double base_radius = text_.number("the cone's base radius");
    const glm::dvec3 apex = point("a coordinate of the cone's apex");
    scene_.add_cone(base, base_radius, apex, text_.number("the cone's apex radius"));
  }

  void read_polygon(bool with_normals) {
    const std::int64_t count = text_.integer("the number of vertices", 3, std::numeric_limits<std::int32_t>::max());
    vertices_.clear();
    normals_.clear();
    // One by one: a number of vertices that the file does not hold must not decide how much memory is taken.
    for (std::int64_t k = 0; k < count; ++k) {
      vertices_.push_back(point("a vertex coordinate"));
      if (with_normals) normals_.push_back(point("a vertex normal's component"));
    }
    if (count > 3)
      scene_.add_polygon(vertices_);
    else if (with_normals)
      scene_.add_triangle(std::array{vertices_[0], vertices_[1], vertices_[2]}, {normals_[0], normals_[1], normals_[2]});
    else
      scene_.add_triangle(vertices_[0], vertices_[1], vertices_[2]);
  }

  TextReader text_;
  Scene scene_;
  bool has_camera_ = false;
  std::vector<std::size_t> uncolored_lights_;
  std::vector<glm::dvec3> vertices_;
  std::vector<glm::dvec3> normals_;
};

}  // namespace

Scene read_nff(const SourceFile& file) { return NffReader(file).read(); }

}  // namespace raymeter
