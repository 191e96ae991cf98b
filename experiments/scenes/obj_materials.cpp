#include "experiments/scenes/obj_materials.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "experiments/in_quotes.h"
#include "experiments/scenes/text_reader.h"

namespace raymeter {

namespace {

glm::dvec3 read_color(TextReader& text) {
  const double red = text.finite_number("a colour component");
  // One component stands for all three.
  if (text.at_line_end()) return glm::dvec3(red);
  const double green = text.finite_number("a colour component");
  return {red, green, text.finite_number("a colour component")};
}

double largest(const glm::dvec3& color) noexcept { return std::max({color.r, color.g, color.b}); }

}  // namespace

ObjMaterials read_mtl(const SourceFile& file) {
  ObjMaterials materials;
  Material* material = nullptr;
  TextReader text(file, '#');
  while (!text.at_end()) {
    const std::string_view word = text.next("a statement");
    if (word == "newmtl") {
      material = &materials[std::string(text.rest_of_line())];
    } else if (word == "Kd" || word == "Ks" || word == "Ns" || word == "d" || word == "Tr" || word == "Ni") {
      if (!material) throw text.error(fmt::format("{} comes before any material; expected 'newmtl'", in_quotes(word)));
      if (word == "Kd") {
        const glm::dvec3 color = read_color(text);
        material->diffuse = largest(color);
        material->color = material->diffuse > 0 ? color / material->diffuse : glm::dvec3(1.0);
      } else if (word == "Ks") {
        material->specular = largest(read_color(text));
      } else if (word == "Ns") {
        material->shine = text.finite_number("the Phong power");
      } else if (word == "Ni") {
        material->ior = text.finite_number("the index of refraction");
      } else {
        const double value = text.finite_number("a number from 0 to 1");
        material->transmittance = std::clamp(word == "Tr" ? value : 1 - value, 0.0, 1.0);
      }
    }
    text.rest_of_line();
  }
  return materials;
}

}  // namespace raymeter
