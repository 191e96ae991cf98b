#pragma once

#include <map>
#include <string>

#include "core/scene/scene.h"
#include "experiments/scenes/source_file.h"

namespace raymeter {

/// Materials by name.
using ObjMaterials = std::map<std::string, Material, std::less<>>;

/// A Wavefront material library (.mtl): Kd becomes colour and diffuse weight, the largest component of Ks the specular weight, Ns the cosine power,
/// 1 - d or Tr the transmittance, Ni the index of refraction; everything else is skipped. Throws Error naming the line.
[[nodiscard]] ObjMaterials read_mtl(const SourceFile& file);

}  // namespace raymeter
