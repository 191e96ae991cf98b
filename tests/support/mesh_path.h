#pragma once

#include <cstdlib>
#include <string>

namespace raymeter::test {

/// Where a mesh that is no part of the project may be: in the folder that RAYMETER_MESHES names, as for configs, else in ../shared/meshes from the project's
/// root, in which tests run. Whether it is there is for the test to ask.
[[nodiscard]] inline std::string mesh_path(const std::string& name) {
  const char* const folder = std::getenv("RAYMETER_MESHES");
  return (folder != nullptr ? std::string(folder) : std::string("../shared/meshes")) + "/" + name + ".ply.xz";
}

}  // namespace raymeter::test
