#pragma once

#include "core/scene/scene.h"

namespace raymeter {

// What a file without camera or lights gets. Most mesh files, and glTF by definition, have y up and their front towards +z, so that is assumed for all.

/// The camera looks at the centre of the bounding box from the direction (0.5, 0.4, 1), up +y, 45 degrees, as far away as shows the box's bounding sphere.
void add_default_camera(Scene& scene);

/// One white light at the upper left behind the viewer: from the centre of the bounding box in direction (-1, 2, 2), three sphere diameters away.
void add_default_light(Scene& scene);

}  // namespace raymeter
