// Stands in for embree_technique.cpp where Embree was not found.

#include "accel/embree/embree.h"

namespace raymeter {

std::string why_not_embree(const Scene&, Isa) { return "this build is without Embree 3 (Debian: libembree-dev)"; }

std::unique_ptr<Structure> build_embree(const Scene& scene, const ParamValues&, int) { throw Error("embree: " + why_not_embree(scene, Isa::scalar)); }

}  // namespace raymeter
