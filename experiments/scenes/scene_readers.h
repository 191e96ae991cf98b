#pragma once

#include <span>
#include <string_view>

#include "core/scene/scene.h"
#include "experiments/scenes/source_file.h"

namespace raymeter {

/// A kind of scene file. Readers throw Error, naming the line, byte or element, for whatever their format does not allow, and give default views.
struct SceneFormat {
  std::string_view extension;  ///< with the dot, in lower case
  std::string_view summary;
  Scene (*read)(const SourceFile& file);
};

[[nodiscard]] std::span<const SceneFormat> scene_formats() noexcept;

/// glTF 2.0, text or binary: triangles, strips and fans of the shown scene (of all nodes where there is none), base colours, the first perspective camera.
/// Every node with a mesh is a composite object; its triangles are stored in world space. Lines, points, skins, morph targets and textures are skipped.
[[nodiscard]] Scene read_gltf(const SourceFile& file);
/// Neutral File Format. Triangles (`p` and `pp` of 3 vertices) become triangles, larger ones polygons, whose vertex normals are not kept.
[[nodiscard]] Scene read_nff(const SourceFile& file);
/// Wavefront OBJ: polygons, made primitives by add_face, with normals and the materials of libraries that lie beside the file. Each `o` or `g` begins a
/// composite object; faces before the first stand alone. Lines, points and free-form surfaces are skipped.
[[nodiscard]] Scene read_obj(const SourceFile& file);
/// PLY, ASCII or binary of both byte orders: elements `vertex` (x y z, nx ny nz) and `face`, made primitives by add_face; everything else is skipped.
[[nodiscard]] Scene read_ply(const SourceFile& file);
/// STL, ASCII or binary. The solids of an ASCII file are composite objects.
[[nodiscard]] Scene read_stl(const SourceFile& file);

}  // namespace raymeter
